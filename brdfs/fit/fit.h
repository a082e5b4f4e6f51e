#pragma once

#include <brdfs/fit/fit_options.h>
#include <brdfs/fit/fit_result.h>
#include <brdfs/fit/fit_samples.h>

#include <vector>

namespace hshfit::brdfs {

/// The parameters with the least loss, from several starts.
///
/// Starts are a Halton sequence with a random shift in the box of the FitRanges (catalog.h); the
/// best of four times `starts` are searched from on at most 4096 of the samples, the best three
/// minima on all. Linear parameters are eliminated where the loss is linear in f. Standard errors
/// come from the sandwich estimator (White 1980, 10.2307/1912934): they hold for weights and
/// noise of any kind, but take the residuals of samples for independent, and the model for true.
/// AIC and BIC are for Gaussian residuals of g with the given weights.
///
/// Samples with stated uncertainties are weighted by 1/sigma^2 (the loss has to be l2): the loss is
/// the root of the weighted mean square of f - measured, and AIC and BIC are chi-square plus their
/// terms, because the variance is known. With scans, errors and correlations are by scan.
///
/// With laws over the wavelength, or a metal in the model, it is fitDispersed (dispersion.h).
///
/// Throws UsageError for the model, for stated uncertainties with another loss, and for a study of
/// uncertainties with a robust kernel; NumericError if there are fewer values than parameters.
FitResult fit(const FitSamples& samples, const FitOptions& options);

/// Expected readings of samples by a fit: f, or f as its instrument shows it, with the scales
/// of scans that fit these samples best. [channel * size + k]
std::vector<double> predictedValues(const FitResult& result, const FitSamples& samples);

}  // namespace hshfit::brdfs
