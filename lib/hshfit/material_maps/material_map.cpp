#include <hshfit/material_maps/material_map.h>

#include <hshfit/error.h>
#include <hshfit/material_maps/reduction.h>

#include <fmt/format.h>

#include <cmath>

namespace hshfit::inline material_maps {
MaterialMap::MaterialMap(const std::string& sidecar)
    : file_(sidecar),
      sidecar_(readMapSidecar(sidecar)),
      texture_(sidecar_.texture, sidecar_.levels, sidecar_.layers(), sidecar_.number, sidecar) {}

Coefficients MaterialMap::coefficients(std::size_t level, std::size_t column,
                                       std::size_t row) const {
    const std::vector<double> numbers = texture_.numbers(level, column, row);
    const TexelLayout& layout = sidecar_.layout;
    std::vector<float> texel(layout.floats());
    if (sidecar_.form == "outgoing") {
        for (std::size_t k = 0; k < texel.size(); ++k) texel[k] = static_cast<float>(numbers[k]);
    } else {
        const LowRank lowRank(layout, sidecar_.shapes);
        std::vector<float> weights(numbers.begin(), numbers.end());
        if (sidecar_.form == "clusters") {
            const auto cluster = static_cast<std::size_t>(std::lround(numbers[0] * 255) +
                                                          std::lround(numbers[1] * 255) * 256);
            const std::size_t count = lowRank.weightsOfTexel();
            if ((cluster + 1) * count > sidecar_.centres.size()) {
                throw InputError(fmt::format(
                    "{}: texel ({}, {}) of level {} has material {}; there are {}", texture_.path(),
                    column, row, level, cluster, sidecar_.centres.size() / count));
            }
            const float* centre = sidecar_.centres.data() + cluster * count;
            weights.assign(centre, centre + count);
        }
        lowRank.restore(weights.data(), texel.data());
    }
    Coefficients out;
    out.basis = sidecar_.basis;
    out.order = sidecar_.order;
    out.quantity = sidecar_.quantity;
    out.channels = sidecar_.channels;
    out.outgoing = layout.outgoing;
    out.isotropic = sidecar_.isotropic;
    out.bilateral = sidecar_.bilateral;
    out.source = fmt::format("{}:x={},y={},level={}", file_, column, row, level);
    out.generator = sidecar_.generator;
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
