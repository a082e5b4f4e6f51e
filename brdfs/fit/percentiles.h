#pragma once

#include <brdfs/fit/fit_samples.h>
#include <brdfs/fit/uncertainty.h>

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace hshfit::brdfs {

/// The value below which a share of sorted values lies, between the two nearest.
double percentile(const std::vector<double>& sorted, double share);

/// Standard deviation and percentiles of draws, at least two.
ParameterUncertainty::Bootstrap summarised(std::vector<double> draws);

/// The decades that values above 0 span: log10 of the ratio of the 95 % and the 5 % percentile of
/// f cos(theta_i). 0 where fewer than two are above 0.
double decadesOf(const FitSamples& samples);

/// Sums of squares over values of more decades than that are decided by the largest values alone.
inline constexpr double mostDecades = 2;

/// The factors by which a model is off, max(f / measured, measured / f), over the values above 0.
struct SampleFactors {
    double median = 1, nineOfTen = 1;  ///< percentiles; infinite where the model is not above 0
    std::size_t count = 0;             ///< of the values
};
/// `values` of the model, [channel * size + sample]. None where no value is above 0.
std::optional<SampleFactors> factorsOf(std::span<const double> values, const FitSamples& samples);

}  // namespace hshfit::brdfs
