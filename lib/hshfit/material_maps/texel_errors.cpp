#include <hshfit/material_maps/texel_errors.h>

#include <hshfit/each_in_parallel.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline material_maps {

double relativeDistance(const TexelLayout& layout, std::span<const double> a,
                        std::span<const double> b) {
    double off = 0, whole = 0;
    for (std::size_t k = 0; k < a.size(); ++k) {
        const double weight = layout.weights()[k / layout.stride()];
        off += weight * (a[k] - b[k]) * (a[k] - b[k]);
        whole += weight * b[k] * b[k];
    }
    return whole > 0 ? std::sqrt(off / whole) : std::sqrt(off);
}

std::vector<double> storedTexel(const MaterialMap& map, std::size_t level, std::size_t column,
                                std::size_t row) {
    const TexelLayout& layout = map.sidecar().layout;
    const Coefficients c = map.coefficients(level, column, row);
    std::vector<double> out(layout.floats(), 0.0);
    for (std::size_t o = 0; o < layout.outgoing.size(); ++o)
        for (std::size_t channel = 0; channel < layout.channels; ++channel)
            for (std::size_t s = 0; s < layout.slots.size(); ++s)
                out[o * layout.stride() + channel * layout.slots.size() + s] =
                    c.at(o, channel)[layout.slots[s]];
    return out;
}

TexelErrors errorsOf(const TexelEncoder& encoder, std::span<const float> linear) {
    const std::size_t n = encoder.linear(), count = linear.size() / n;
    std::vector<float> errors(count);
    eachInParallel(count, [&](std::size_t t) {
        std::vector<std::byte> bytes(encoder.layers() * 16);
        encoder.encode(0, linear.subspan(t * n, n), {bytes.data(), 16, &errors[t]});
    });
    return errorsOf(errors);
}

std::size_t leastRank(std::span<const TexelErrors> errors, double most) {
    const auto good =
        std::ranges::find_if(errors, [&](const TexelErrors& e) { return e.maximum <= most; });
    return std::min<std::size_t>(static_cast<std::size_t>(good - errors.begin()) + 1,
                                 errors.size());
}

}  // namespace hshfit::inline material_maps
