#pragma once

#include <brdfs/catalog/tables.h>
#include <brdfs/fit/fit.h>

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::brdfs {

/// A specification of a fit with the optional parts of its model that are named: parameters of
/// the other parts are stated with their defaults, unless they are stated already, and a part with
/// a statement of its own (ModelPart::with) is added by that. Throws UsageError for a model without
/// parts, a sum, and unknown names.
std::string withParts(std::string_view spec, const std::vector<std::string>& parts);

/// The row of the model of a specification that is no sum, if it has parts; else null.
const Model* modelWithParts(std::string_view spec);

/// The names of all parts that data with such channels may have: a thin film needs R, G and B.
std::vector<std::string> partsFor(const Model& model, const Channels& channels);

/// One step of a search for parts.
struct PartTrial {
    std::vector<std::string> parts;  ///< in the model
    double loss = 0;                 ///< FitResult::loss
    /// ModelRank::heldOut. None where it was not measured: of pixels, and where the loss itself
    /// falls by less than `leastGain`, or a part that lowers it more was taken.
    std::optional<double> heldOut = {};
    bool taken = false;        ///< the search went on from here
    std::string failure = {};  ///< why there is no fit
};

/// A parameter that is not worth fitting.
struct HeldParameter {
    std::string name;
    double value = 0;  ///< the default of the standard
    double loss = 0;   ///< with it and those before it
};

struct PartSearch {
    std::vector<std::string> parts;        ///< found worth it
    std::vector<PartTrial> trials;         ///< the first has no parts
    std::vector<HeldParameter> held = {};  ///< of these parts and the base
    std::string stated = {};               ///< of a film: the share of the facets, "key=value"
    /// With a film, FitOptions::from for the fit that follows; its other minima are many.
    std::vector<double> from = {};
};

/// withParts for what a search has found, with the parameters that it holds.
std::string withParts(std::string_view spec, const PartSearch& search);

struct PartOptions {
    /// A part is worth it if it lowers the held-out loss by this share. Folds of the same data
    /// differ by less. A parameter of a part is fitted if it lowers the loss by as much.
    double leastGain = 0.02;
    /// For pixels: a loss that nobody sees, a twentieth of a unit of L*, is no reason for a part.
    double unseen = 5e-4;
    /// For pixels, a thin film is tried where the hue of f is off by as much, as the loss maps RGB
    /// (root mean square): other parts have no colours that change with the directions. For other
    /// samples no film is tried, because their noise differs between channels.
    double leastHue = 0.01;
    /// Samples that the search draws; the fit that follows takes all. For pixels the search takes
    /// FitSamples::fewer instead.
    std::size_t samples = 4096;
    std::function<void(std::size_t, std::size_t)> progress = {};
};

/// Adds the part that lowers the loss most among those that lower the held-out loss
/// (compare_models.h), or of pixels the loss itself, by `leastGain`, again and again. Of measured
/// samples, held-out losses have to differ by more than their spread over rings explains. Each fit
/// starts at the one without the part, a film's at as many thicknesses as `fit` has starts. Parts
/// whose parameters are all held or stated are not tried. Then each parameter but the base's
/// colours is held at its default unless it lowers the loss by `leastGain`: the data do not decide
/// it.
PartSearch chooseParts(const FitSamples& samples, const FitOptions& fit,
                       const PartOptions& options = {});

/// An indented line for each trial and for each parameter that is held.
std::string textOf(const PartSearch& search);

}  // namespace hshfit::brdfs
