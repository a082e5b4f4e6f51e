#pragma once

#include <brdfs/fit/fit.h>

#include <span>
#include <string>
#include <vector>

namespace hshfit::brdfs {

/// One model among several that were fitted to the same samples.
struct ModelRank {
    std::string model;
    FitResult fit;
    /// As FitResult::loss, of directions that the fit did not see: five fits, each to four fifths.
    double heldOut = 0;
    /// The data do not tell it from the first model: at the held-out directions, its squared
    /// residuals differ from the squared residuals of the model with the least held-out error by no
    /// more than their spread over scans (or rings) explains (Student's t, 5 %). Only for samples
    /// with stated uncertainties or scans.
    bool tied = false;
    bool simplest = false;  ///< first as the tied model with the fewest parameters
    std::string failure;    ///< why there is no fit; then last
};

/// Fits every model and ranks them by `heldOut`; of models that are tied with the first, the one
/// with the fewest parameters comes first. Held out are outgoing directions: rings of three
/// degrees in elevation (and, for anisotropic data, sectors of thirty in azimuth) are dealt to five
/// folds, so that no held-out value stands between neighbours of its own ring. Data with fewer than
/// five rings are cut into five runs of their samples instead. Of samples with five scans or more,
/// whole scans are held out.
std::vector<ModelRank> compareModels(const FitSamples& samples, std::span<const std::string> models,
                                     FitOptions options);

/// ModelRank::heldOut, and the sums of squared residuals in each ring (or scan).
struct HeldOutError {
    double loss = 0;
    std::vector<double> squares;
};
/// Of one fit to all samples, by which the others start.
HeldOutError heldOutError(const FitSamples& samples, const FitResult& whole,
                          const FitOptions& options);
/// Whether squared residuals at the same samples differ by more than their spread over rings
/// explains (Student's t, 5 %). Of fewer than two rings there is no spread: they do.
bool differ(const HeldOutError& a, const HeldOutError& b);

/// The values of the shapes of a fit in which channels share them, in the order of
/// FitOptions::from; empty for others, and without shapes.
std::vector<double> shapesOf(const FitResult& fit, const FitOptions& options,
                             const FitSamples& samples);

}  // namespace hshfit::brdfs
