#pragma once

#include <brdfs/fit/fit_result.h>
#include <brdfs/fit/sample_cuts.h>
#include <hshfit/pages/print_figure.h>

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace hshfit::brdfs {

/// A part of a model under its name.
struct NamedBrdf {
    std::string name;
    std::shared_ptr<const Brdf> brdf;
};

/// Samples beside a BRDF that is to describe them.
struct PlottedModel {
    const FitSamples& samples;
    const Brdf& brdf;
    std::string name;                   ///< in legends: "fit"
    std::vector<NamedBrdf> terms = {};  ///< drawn where there is one channel
    /// standardisedResiduals (residual_rows.h); empty: no figure of residuals.
    std::vector<double> residuals = {};
    /// Half width of the band about f at pairs of directions, [channel * pairs + pair], 1/sr;
    /// none: no band.
    std::function<std::vector<double>(std::span<const DirectionPair>)> band = {};
    std::string bandName = {};
    /// The readings of an instrument of the model at pairs of directions, likewise: drawn in place
    /// of its f, which is then a second, thin curve; none: f itself.
    std::function<std::vector<double>(std::span<const DirectionPair>)> readings = {};
};

/// The terms of a fit to grey data, or to one wavelength; none otherwise, and of a single model.
std::vector<NamedBrdf> termsOf(const FitResult& result);

/// The figures of samples for print:
///     cuts, polar     f at the measured directions, with bars of one sigma where stated, over the
///                     model's curve, or what its instrument reads; a panel for each cut; none
///                     without a cut
///     residuals       against theta_i, theta_o and the angle between wo and the mirror direction
///                     of wi, and against normal quantiles; at most 3000 values of each channel
/// Channels as drawnChannels chooses them. Curves are refined until straight lines are within half
/// a percent of f.
std::vector<PrintFigure> sampleFigures(const PlottedModel& model, const SampleCuts& cuts,
                                       const FigureStyle& style);

/// Parameters of a spectral fit over the wavelength, with their errors: a panel for each parameter
/// that has a value for each. None for other fits.
std::optional<PrintFigure> spectrumFigure(const FitResult& result, const Channels& channels);

}  // namespace hshfit::brdfs
