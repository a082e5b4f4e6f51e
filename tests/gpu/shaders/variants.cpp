#include "variants.h"

#include "../asymmetric.h"

#include <cmath>

namespace hshfit::shaders {
namespace {

using gpu::Number;
using gpu::pack;
using gpu::Packing;
using samples::asymmetric;

/// Coefficients that are random in the slots and channels, but over the map as smooth as a BRDF's:
/// single precision places a lookup 3e-6 of a texel off (shader_proof_test.cpp), which white noise
/// would show.
Coefficients smooth(const std::string& basis, int order, const OutgoingSet& outgoing,
                    const Channels& channels, std::uint64_t seed, bool condonShortley = false) {
    Coefficients c = asymmetric(basis, order, outgoing, channels, seed, condonShortley);
    const Coefficients waves =
        asymmetric(basis, order, OutgoingSet::elevations(3), channels, seed, condonShortley);
    for (std::size_t p = 0; p < outgoing.size(); ++p) {
        const Direction& d = outgoing.directions[p];
        for (std::size_t i = 0; i < channels.count(); ++i) {
            for (std::size_t j = 0; j < c.slots(); ++j) {
                const double a = waves.at(0, i)[j], b = waves.at(1, i)[j], e = waves.at(2, i)[j];
                const double l = std::floor(std::sqrt(static_cast<double>(j)));
                c.at(p, i)[j] = a * std::cos((1 + l) * (3 * b * d.x + 3 * e * d.y + b - e));
            }
        }
    }
    return c;
}

Coefficients withoutSines(Coefficients c) {
    c.bilateral = true;
    for (std::size_t p = 0; p < c.outgoing.size(); ++p)
        for (std::size_t i = 0; i < c.channels.count(); ++i)
            for (int l = 0; l < c.order; ++l)
                for (int m = 1; m <= l; ++m) c.at(p, i)[slotOf(l, -m)] = 0;
    return c;
}

Coefficients ofCosine(Coefficients c) {
    c.quantity = Quantity::brdfCosine;
    return c;
}

}  // namespace

std::vector<Variant> variants() {
    const OutgoingSet map = OutgoingSet::parabolic(32, 24), rings = OutgoingSet::elevations(16),
                      one = OutgoingSet::direction(0.6, -1.1);
    const Channels rgb = Channels::rgb(), grey = Channels::grey(),
                   spectrum = Channels::spectral({420, 480, 550, 610, 690});
    const Coefficients hsh7 = smooth("hsh", 7, map, rgb, 1);
    return {
        {"hsh 3", pack(smooth("hsh", 3, map, rgb, 2), {})},
        {"hsh 7", pack(hsh7, {})},
        {"hsh 10", pack(smooth("hsh", 10, map, rgb, 3), {}), 7},
        {"hsh 7, white noise", pack(asymmetric("hsh", 7, map, rgb, 16), {}), 5, true},
        {"hsh 7, float32", pack(hsh7, {.number = Number::float32})},
        {"hsh 7, f cos", pack(ofCosine(hsh7), {})},
        {"hsh 7, rgb packing", pack(hsh7, {.packing = Packing::rgb})},
        {"hsh 7, luminance and 4 bands of chroma",
         pack(hsh7, {.luminanceChroma = true, .chromaOrder = 4})},
        {"hsh 5, rgb packing of luminance and chroma",
         pack(smooth("hsh", 5, map, rgb, 4), {.packing = Packing::rgb, .luminanceChroma = true})},
        {"hsh 7, unorm16", pack(hsh7, {.number = Number::unorm16})},
        {"hsh 7, unorm8", pack(hsh7, {.number = Number::unorm8})},
        {"hsh 7, unorm8, one direction",
         pack(smooth("hsh", 7, one, rgb, 17), {.number = Number::unorm8})},
        {"hsh 7, elevations", pack(smooth("hsh", 7, rings, rgb, 5), {})},
        {"hsh 7, elevations, cosines only",
         pack(withoutSines(smooth("hsh", 7, rings, grey, 6)), {})},
        {"hsh 4, basis textures",
         pack(smooth("hsh", 4, map, rgb, 7), {.number = Number::float32, .basisSize = 40})},
        {"hsh 4, elevations, basis textures, rgb packing",
         pack(smooth("hsh", 4, rings, rgb, 8), {.packing = Packing::rgb, .basisSize = 32})},
        {"sh 7, Condon-Shortley", pack(smooth("sh", 7, map, rgb, 9, true), {})},
        {"esh 7, one direction", pack(smooth("esh", 7, one, rgb, 10), {})},
        {"lsosh 7, elevations, spectral", pack(smooth("lsosh", 7, rings, spectrum, 11), {}), 3},
        {"zernike 10", pack(smooth("zernike", 10, map, grey, 12), {}), 2},
        {"makhotkin 7, spectral", pack(smooth("makhotkin", 7, map, spectrum, 13), {}), 3},
        {"makhotkin-flux 7", pack(smooth("makhotkin-flux", 7, map, rgb, 14), {})},
        {"h-basis 3, Condon-Shortley", pack(smooth("h-basis", 3, map, grey, 15, true), {})},
    };
}

}  // namespace hshfit::shaders
