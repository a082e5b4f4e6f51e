#pragma once

#include "texel_brdfs.h"

#include <hshfit/accuracy/pair_errors.h>
#include <hshfit/material_maps/processes.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

namespace hshfit::jobs {

/// Errors of texels in a form against the BRDFs that they stand for, over the stratified pairs of
/// `compare` (spreadPairs, a quarter of its incoming directions): with what the basis leaves out.
struct TexelPairErrors {
    std::size_t texels = 0;
    /// Mean |ln(1 + f c) - ln(1 + g c)|, c = cos(theta_i), over texels; the standard error that the
    /// pairs leave in it; the worst texel.
    double meanLog = 0, uncertainty = 0, worstLog = 0;
    TexelPlace worstAt = {};
    double mirror = 0;   ///< meanLog over pairs within 5 degrees of the mirror direction
    double largest = 0;  ///< |g - f| c at one pair, and where
    DirectionPair pair = {};
    TexelPlace largestAt = {};
    double albedo = 0, albedoUncertainty = 0;  ///< largest difference of a directional albedo
    TexelPlace albedoAt = {};
};

/// The BRDFs of some texels at these pairs, shared out among processes.
class PairChecks {
public:
    PairChecks(ParameterMaps& maps, const std::vector<LevelSize>& levels,
               std::vector<TexelPlace> places, Processes& processes);
    ~PairChecks();

    const std::vector<TexelPlace>& places() const { return places_; }
    /// `at(k)` opens the form of texel k of `places()`; from several threads at once. All processes
    /// have the result.
    TexelPairErrors errorsOf(const std::function<std::unique_ptr<Brdf>(std::size_t)>& at) const;

private:
    std::vector<TexelPlace> places_;
    Processes& processes_;
    ItemRange mine_;
    std::vector<std::unique_ptr<PairReference>> references_;  ///< of `mine_`
};

}  // namespace hshfit::jobs
