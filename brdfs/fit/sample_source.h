#pragma once

#include <brdfs/fit/fit_samples.h>
#include <brdfs/measured/scattered/samples.h>

#include <cstddef>
#include <string>
#include <vector>

namespace hshfit::brdfs {

/// The measurements that samples of a fit were taken from.
struct SampleSource {
    const Samples* samples = nullptr;        ///< null: a table or a function
    const std::vector<std::size_t>& places;  ///< in `samples`, of each sample of the fit
    bool converted = false;                  ///< values went through other channels
    std::string name;                        ///< for messages
};

/// Sets `rows` of the fit's samples.
void numberRows(const SampleSource& source, FitSamples& samples);

/// Sets `scans`. Throws UsageError for a column that neither the companion file of `sigma` nor the
/// data have and for runs of what is not measured, InputError for an unreadable file.
void stateScans(const ScanStatement& scans, const SigmaStatement& sigma, const SampleSource& source,
                FitSamples& samples);

/// Sets `sigmas`. Throws UsageError for a column that the data do not have and for statements about
/// single values of a table, of a function or of converted values; InputError for an unreadable
/// file and for uncertainties outside 1e-30 to 1e30.
void stateSigmas(const SigmaStatement& sigma, const SampleSource& source, FitSamples& samples);

}  // namespace hshfit::brdfs
