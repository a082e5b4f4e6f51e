#pragma once

#include "parameter_maps.h"

#include <hshfit/material_maps/texel_source.h>

#include <cstddef>
#include <memory>

namespace hshfit::jobs {

/// f of each texel's BRDF at material_library::fitPairs(), [channel][pair], evaluated by the model
/// itself.
class PairTexels final : public TexelSource {
public:
    /// The number of channels of all texels.
    PairTexels(ParameterMaps& maps, std::size_t channels);

    std::size_t width() const override { return maps_.width(); }
    std::size_t height() const override { return maps_.height(); }
    const TexelLayout& layout() const override { return layout_; }
    std::unique_ptr<TexelBand> band(std::size_t top, std::size_t bottom) override;

private:
    class Band;
    ParameterMaps& maps_;
    TexelLayout layout_;
};

}  // namespace hshfit::jobs
