#include <brdfs/fit/fit.h>

#include <brdfs/catalog/tables.h>
#include <brdfs/fit/correlated_spread.h>
#include <brdfs/fit/dispersion.h>
#include <brdfs/fit/instrument/instrument_fit.h>
#include <brdfs/fit/material_fit.h>
#include <brdfs/fit/parametric_sum.h>
#include <brdfs/fit/whitening.h>
#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>

namespace hshfit::brdfs {
namespace {

void checkCorrelatedScans(const FitSamples& samples, const FitOptions& options) {
    if (samples.scans.empty())
        throw UsageError(
            "a correlation over angles is that of samples of one scan: say which samples belong to "
            "one (column, incidence, or the number of samples in each)");
    if (!options.instrument.any() && options.dispersion.empty() && !namesMetals(options.model))
        return;  // Whitening has a limit of its own
    std::vector<std::size_t> counts(*std::ranges::max_element(samples.scans) + 1);
    for (const std::size_t scan : samples.scans) ++counts[scan];
    const auto longest = std::ranges::max_element(counts);
    if (*longest > mostCorrelated)
        throw UsageError(fmt::format(
            "scan {} has {} samples; a correlation over angles takes scans of up to {}: take fewer "
            "samples, or leave out the correlation",
            longest - counts.begin() + 1, *longest, mostCorrelated));
}

void checkStatements(const FitSamples& samples, const FitOptions& options) {
    if (!samples.sigmas.empty() && options.loss != Loss::Kind::l2)
        throw UsageError(
            "stated uncertainties are those of f, and weight its squared residuals; the loss has "
            "to be l2");
    const bool studied = options.uncertainty.report || !samples.sigmas.empty() ||
                         !samples.scans.empty() || !options.contributions.empty();
    if (samples.correlation.ofAngles()) checkCorrelatedScans(samples, options);
    if (samples.correlation.ofWavelengths() &&
        (samples.channels.kind != Channels::Kind::spectral ||
         (options.perChannel && samples.channels.count() > 1)))
        throw UsageError(
            fmt::format("{}a correlation over wavelengths is for data with wavelengths that are "
                        "fitted together; leave out shapes for each channel",
                        samples.correlation.blocks ? samples.correlation.blocks->path + ": " : ""));
    checkCorrelations(samples);
    if (studied && options.robust != Robust::none)
        throw UsageError(
            "uncertainties are those of a sum of squares; leave out the robust kernel");
}

void checkChannelwise(const FitSamples& samples, const FitOptions& options, bool dispersed) {
    if (!isChannelwise(options.model)) return;
    if (samples.channels.kind != Channels::Kind::rgb)
        throw UsageError(fmt::format(
            "'{}': a thin film has functions of R, G and B, and these data are {}", options.model,
            samples.channels.kind == Channels::Kind::grey ? "grey" : "spectral; see them as RGB"));
    if (dispersed || options.instrument.any() || options.perChannel)
        throw UsageError(fmt::format(
            "'{}': a thin film is fitted to R, G and B together, without laws over the wavelength "
            "and terms of the instrument",
            options.model));
}

}  // namespace

FitResult fit(const FitSamples& samples, const FitOptions& options) {
    checkStatements(samples, options);
    const bool dispersed = !options.dispersion.empty() || namesMetals(options.model);
    checkChannelwise(samples, options, dispersed);
    if (!options.from.empty() && (dispersed || options.instrument.any()))
        throw UsageError(
            "values to start from are for fits without laws over the wavelength, metals and terms "
            "of the instrument");
    if (dispersed) return fitDispersed(samples, options);
    if (options.instrument.any()) return fitWithInstrument(samples, options);
    return fitMaterial(samples, options);
}

std::vector<double> predictedValues(const FitResult& result, const FitSamples& samples) {
    if (result.instrument) return readingsOf(result, samples);
    return valuesOf(*openFit(result), samples);
}

}  // namespace hshfit::brdfs
