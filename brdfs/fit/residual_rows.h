#pragma once

#include <brdfs/fit/fit_result.h>

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::brdfs {

/// The values of a fit as CSV, in the order of the samples, channel by channel for each:
///     row         line (or number) in the file; for tables and functions the number of the sample
///     wi_x … wo_z
///     channel     nm, R, G or B; empty for grey
///     value, sigma, model, residual    1/sr; residual = value - model; sigma empty if not stated
///     studentised, leverage, cook      ValueInfluence
///     theta_i, theta_o, aspecular      degrees; the last as aspecularAngle
///     standardised                     standardisedResiduals
///     standard_error                   of the model there, 1/sr (prediction.h)
///     bootstrap_error                  the same by fits to resampled data, where there are any
/// `loss` is the loss that the fit minimised. `write` gets the text line by line. The result has to
/// have its `uncertainty`.
void writeResidualRows(const FitSamples& samples, const FitResult& result, Loss::Kind loss,
                       const std::function<void(std::string_view)>& write);

/// root(w) (g(measured) - g(model)) over the root of the weighted sum of its squares per degree of
/// freedom; with stated uncertainties (measured - model) / sigma. [channel * size + sample].
std::vector<double> standardisedResiduals(const FitSamples& samples,
                                          const std::vector<double>& model, Loss::Kind loss,
                                          std::size_t parameters);

/// The angle between the outgoing direction of a sample and the mirror direction of its incoming
/// one, degrees.
double aspecularAngle(const FitSamples& samples, std::size_t k);

/// Channels as columns name them: nm, "R", "G", "B"; "" for grey.
std::vector<std::string> columnNames(const Channels& channels);

/// One value among the samples.
struct ValuePlace {
    std::size_t channel = 0, sample = 0;
};

/// The number of a value's row, as above.
std::size_t rowOf(const FitSamples& samples, const ValuePlace& place);

/// The values with the largest Cook's distances, largest first.
std::vector<ValuePlace> mostInfluential(const FitSamples& samples, const Uncertainty& uncertainty,
                                        std::size_t most);
/// The values whose studentised residuals exceed the bound, largest first.
std::vector<ValuePlace> outliersOf(const FitSamples& samples, const Uncertainty& uncertainty);

}  // namespace hshfit::brdfs
