#include <hshfit/material_maps/texel_layout.h>

namespace hshfit::inline material_maps {

TexelLayout texelLayout(const Basis& basis, const OutgoingSet& outgoing, std::size_t channels,
                        bool mirrorSymmetric) {
    TexelLayout layout{.outgoing = outgoing, .channels = channels};
    const bool halved = mirrorSymmetric && outgoing.map == OutgoingSet::Map::elevations;
    for (int l = 0; l < basis.order(); ++l) {
        for (int m = halved ? 0 : -l; m <= l; ++m) {
            if (basis.has(l, m)) layout.slots.push_back(slotOf(l, m));
        }
    }
    return layout;
}

}  // namespace hshfit::inline material_maps
