#include <hshfit/material_maps/lobe_texels.h>

namespace hshfit::inline material_maps {
namespace {

class Band final : public TexelBand {
public:
    Band(const TexelKernel& kernel, std::size_t top, std::vector<TexelBlock> rows)
        : kernel_(kernel), top_(top), rows_(std::move(rows)) {}

    void texels(std::size_t row, std::size_t column, std::size_t count, float* out) const override {
        kernel_.run(rows_[row - top_], column, count, out);
    }

private:
    const TexelKernel& kernel_;
    std::size_t top_;
    std::vector<TexelBlock> rows_;
};

}  // namespace

LobeTexels::LobeTexels(ParameterRows& rows, const LobeGrid& table, const TexelLayout& layout,
                       bool placesByChannel)
    : rows_(rows), layout_(layout), kernel_(table, layout, placesByChannel) {}

std::unique_ptr<TexelBand> LobeTexels::band(std::size_t top, std::size_t bottom) {
    return std::make_unique<Band>(kernel_, top, rows_.read(top, bottom));
}

}  // namespace hshfit::inline material_maps
