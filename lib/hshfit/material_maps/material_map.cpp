#include <hshfit/material_maps/material_map.h>

#include <hshfit/error.h>
#include <hshfit/material_maps/reduction.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace hshfit::inline material_maps {
MaterialMap::MaterialMap(const std::string& sidecar)
    : MaterialMap(readMapSidecar(sidecar), sidecar) {}

MaterialMap::MaterialMap(MapSidecar sidecar, std::string file)
    : file_(std::move(file)),
      sidecar_(std::move(sidecar)),
      texture_(sidecar_.texture, sidecar_.levels, sidecar_.layers(), sidecar_.number, file_) {}

std::size_t MaterialMap::material(std::size_t level, std::size_t column, std::size_t row) const {
    const std::vector<double> numbers = texture_.numbers(level, column, row);
    const auto index = static_cast<std::size_t>(std::lround(numbers[0] * 255) +
                                                std::lround(numbers[1] * 255) * 256);
    const std::size_t count = sidecar_.materials();
    if (index < count) return index;
    throw InputError(fmt::format("{}: texel ({}, {}) of level {} has material {}; there are {}",
                                 texture_.path(), column, row, level, index, count));
}

Coefficients MaterialMap::coefficients(std::size_t level, std::size_t column,
                                       std::size_t row) const {
    const TexelLayout& layout = sidecar_.layout;
    std::vector<float> texel(layout.floats());
    if (sidecar_.hasMaterials()) {
        const LowRank lowRank(layout, sidecar_.shapes);
        const std::size_t first = material(level, column, row) * lowRank.weightsOfTexel();
        lowRank.restore(sidecar_.centres.data() + first, texel.data());
    } else {
        const std::vector<double> numbers = texture_.numbers(level, column, row);
        const std::vector<float> floats(numbers.begin(), numbers.end());
        if (sidecar_.form == "outgoing")
            std::copy_n(floats.begin(), texel.size(), texel.begin());
        else
            LowRank(layout, sidecar_.shapes).restore(floats.data(), texel.data());
    }
    Coefficients out = texelCoefficients(sidecar_, texel);
    out.source = fmt::format("{}:x={},y={},level={}", file_, column, row, level);
    return out;
}

Coefficients texelCoefficients(const MapSidecar& map, std::span<const float> texel) {
    const TexelLayout& layout = map.layout;
    Coefficients out;
    out.basis = map.basis;
    out.order = map.order;
    out.quantity = map.quantity;
    out.channels = map.channels;
    out.outgoing = layout.outgoing;
    out.isotropic = map.isotropic;
    out.bilateral = map.bilateral;
    out.generator = map.generator;
    out.values.assign(layout.outgoing.size() * layout.channels * out.slots(), 0.0);
    double energy = 0;
    for (std::size_t o = 0; o < layout.outgoing.size(); ++o) {
        for (std::size_t c = 0; c < layout.channels; ++c) {
            for (std::size_t s = 0; s < layout.slots.size(); ++s) {
                const auto value =
                    static_cast<double>(texel[o * layout.stride() + c * layout.slots.size() + s]);
                out.at(o, c)[layout.slots[s]] = value;
                energy += layout.weights()[o] * value * value;
            }
        }
    }
    out.energy.value = energy;
    return out;
}

}  // namespace hshfit::inline material_maps
