#include <hshfit/transfer/shading.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/transfer/internal/ring_transform.h>
#include <hshfit/transfer/internal/shading_kernels.h>

namespace hshfit::inline transfer {

void shade(std::span<const float> brdf, const float* light, std::size_t vertices, float* out) {
    shadeDots({brdf.data(), 1, false, light, brdf.size(), vertices, out});
}

void shade(std::size_t slots, const float* brdf, const float* light, std::size_t vertices,
           float* out) {
    shadeDots({brdf, vertices, true, light, slots, vertices, out});
}

ShadingTable::ShadingTable(const Coefficients& coefficients)
    : order_(coefficients.order),
      channels_(coefficients.channels.count()),
      elevations_(coefficients.outgoing.size()),
      bilateral_(coefficients.bilateral) {
    requireOrthonormal(*bases::make(coefficients.basis, order_));
    if (!coefficients.isotropic || coefficients.outgoing.map != OutgoingSet::Map::elevations) {
        throw UsageError(
            "shading by elevations takes coefficients of an isotropic BRDF by elevations");
    }
    const std::size_t slots = coefficients.slots(), row = elevations_ + 1;
    table_.resize(channels_ * slots * row);
    for (std::size_t channel = 0; channel < channels_; ++channel) {
        for (std::size_t slot = 0; slot < slots; ++slot) {
            float* to = table_.data() + (channel * slots + slot) * row;
            for (std::size_t k = 0; k < elevations_; ++k) {
                to[k] = static_cast<float>(coefficients.at(k, channel)[slot]);
            }
            to[elevations_] = to[elevations_ - 1];
        }
    }
}

void ShadingTable::shade(const ShadingViews& views, const float* light, float* out) const {
    shadeTable({table_.data(), order_, bilateral_, channels_, elevations_, views, light, out});
}

}  // namespace hshfit::inline transfer
