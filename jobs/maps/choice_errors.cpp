#include "choice_errors.h"

#include <hshfit/coefficients/reconstruction.h>
#include <hshfit/material_maps/material_map.h>

#include <utility>

namespace hshfit::jobs {

ChoiceErrors::ChoiceErrors(ParameterMaps& maps, TexelSource& texels, MapSidecar head,
                           std::size_t most, Processes& processes)
    : head_(std::move(head)),
      checks_(maps, head_.levels, spreadPlaces(head_.levels, 0, most), processes) {
    for (const TexelPlace& place : checks_.places()) {
        texels_.emplace_back(texels.layout().floats());
        texels.band(place.row, place.row + 1)
            ->texels(place.row, place.column, 1, texels_.back().data());
    }
}

TexelPairErrors ChoiceErrors::ofCoefficients(
    const std::function<void(std::vector<float>&)>& change) const {
    return checks_.errorsOf([&](std::size_t k) {
        std::vector<float> texel = texels_[k];
        change(texel);
        return std::make_unique<Reconstruction>(texelCoefficients(head_, texel));
    });
}

TexelPairErrors ChoiceErrors::ofTexels() const {
    return ofCoefficients([](std::vector<float>&) {});
}

TexelPairErrors ChoiceErrors::of(const LowRank& lowRank) const {
    return ofCoefficients([&](std::vector<float>& texel) {
        std::vector<float> weights(lowRank.weightsOfTexel());
        lowRank.reduce(texel.data(), weights.data());
        lowRank.restore(weights.data(), texel.data());
    });
}

TexelPairErrors ChoiceErrors::of(const ClusterEncoder& clusters) const {
    return ofCoefficients([&](std::vector<float>& texel) {
        std::vector<float> linear(clusters.linear());
        clusters.reduce(texel.data(), linear.data());
        clusters.lowRank().restore(clusters.centre(0, linear.data()), texel.data());
    });
}

TexelPairErrors ChoiceErrors::of(
    const std::function<std::unique_ptr<Brdf>(const TexelPlace&)>& at) const {
    return checks_.errorsOf([&](std::size_t k) { return at(checks_.places()[k]); });
}

}  // namespace hshfit::jobs
