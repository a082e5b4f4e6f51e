#pragma once

#include "pair_checks.h"

#include <hshfit/material_maps/cluster_encoder.h>
#include <hshfit/material_maps/map_sidecar.h>

#include <functional>
#include <vector>

namespace hshfit::jobs {

/// Errors of forms at a few texels of level 0, spread over it, against the BRDFs of the model.
class ChoiceErrors {
public:
    /// `head` is the map's, of any form; at most `most` texels.
    ChoiceErrors(ParameterMaps& maps, TexelSource& texels, MapSidecar head, std::size_t most,
                 Processes& processes);

    TexelPairErrors ofTexels() const;  ///< all coefficients
    TexelPairErrors of(const LowRank& lowRank) const;
    TexelPairErrors of(const ClusterEncoder& clusters) const;
    /// The errors of any other form: `at` opens the texel at a place.
    TexelPairErrors of(const std::function<std::unique_ptr<Brdf>(const TexelPlace&)>& at) const;

private:
    /// `change` makes of a texel's coefficients the coefficients of the form.
    TexelPairErrors ofCoefficients(const std::function<void(std::vector<float>&)>& change) const;

    MapSidecar head_;
    PairChecks checks_;
    std::vector<std::vector<float>> texels_;  ///< at checks_.places()
};

}  // namespace hshfit::jobs
