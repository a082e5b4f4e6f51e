#pragma once

#include <brdfs/fit/fit_options.h>
#include <brdfs/fit/fit_result.h>

#include <span>
#include <vector>

namespace hshfit::brdfs {

/// The fit of FitOptions::instrument. A search without the instrument's fitted numbers gives the
/// start, and is repeated on readings from which what was found of them is taken away. Quadratures
/// are refined for the material that was found until they keep the tolerance for it, with a new
/// search each time.
/// Throws UsageError as checkInstrument, for a loss that is not l2 or cosine, and for shapes for
/// each channel; NumericError where a quadrature does not reach its tolerance.
FitResult fitWithInstrument(const FitSamples& samples, const FitOptions& options);

/// Throws UsageError for samples and options that no fit with terms of the instrument takes.
void checkReadings(const FitSamples& samples, const FitOptions& options);

/// predictedValues() of such a fit.
std::vector<double> readingsOf(const FitResult& result, const FitSamples& samples);

/// Readings by its instrument of the fitted material at pairs of directions, in a scan of scale 1
/// and zeros of 0: [channel * pairs + pair], 1/sr. Throws as fitWithInstrument.
std::vector<double> readingsAt(const FitResult& result, const Channels& channels, bool isotropic,
                               std::span<const DirectionPair> pairs);

}  // namespace hshfit::brdfs
