#pragma once

#include <brdfs/fit/fit_samples.h>
#include <brdfs/fit/instrument/instrument.h>

#include <cstddef>
#include <vector>

namespace hshfit::brdfs {

/// The levels of the quadratures over source and detector of one sample (patchNodes).
struct PatchLevels {
    std::size_t source = 1, detector = 1;
};

/// The samples with sums in place of f: averages over both apertures,
///     sum of f(wi, wo) cos(theta_i) cos(theta_o) d(wi) d(wo) over that without f,
/// so that a constant f keeps its value. `levels`: one for each sample. Without apertures as they
/// are. Throws NumericError for more nodes than memory is meant for.
FitSamples averaged(const FitSamples& samples, const Instrument& instrument,
                    const std::vector<PatchLevels>& levels);

/// The levels that averages of f need: both quadratures are refined until the next level changes
/// the average by less than the tolerance, relative to it or to 1e-6 of the largest average. Where
/// lobes are within reach of an aperture, nodes are no further apart than these are wide from the
/// start. `levels` are the least, one for each sample.
struct PatchSearch {
    std::vector<PatchLevels> levels;
    double change = 0;       ///< the largest relative change that the next level makes
    std::size_t sample = 0;  ///< where
    bool exhausted = false;  ///< more nodes are needed there than are allowed
};
PatchSearch searchLevels(const Brdf& brdf, const FitSamples& samples, const Instrument& instrument,
                         std::vector<PatchLevels> levels);

}  // namespace hshfit::brdfs
