#pragma once

#include <hshfit/material_maps/texel_kernel.h>
#include <hshfit/material_maps/texel_source.h>

#include <cstddef>
#include <memory>
#include <vector>

namespace hshfit::inline material_maps {

/// Parameters of the texels of a map, as TexelKernel takes them.
class ParameterRows {
public:
    virtual ~ParameterRows() = default;
    virtual std::size_t width() const = 0;
    virtual std::size_t height() const = 0;
    /// Row by row, from `top` to `bottom`. Throws InputError. By one thread at a time.
    virtual std::vector<TexelBlock> read(std::size_t top, std::size_t bottom) = 0;
};

/// A map of materials that are weighted sums of lobes with parameters from texel to texel.
class LobeTexels final : public TexelSource {
public:
    /// All references have to outlive this.
    LobeTexels(ParameterRows& rows, const LobeGrid& table, const TexelLayout& layout,
               bool placesByChannel);

    std::size_t width() const override { return rows_.width(); }
    std::size_t height() const override { return rows_.height(); }
    const TexelLayout& layout() const override { return layout_; }
    std::unique_ptr<TexelBand> band(std::size_t top, std::size_t bottom) override;

private:
    ParameterRows& rows_;
    const TexelLayout& layout_;
    TexelKernel kernel_;
};

}  // namespace hshfit::inline material_maps
