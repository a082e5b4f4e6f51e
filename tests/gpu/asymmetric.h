#pragma once

#include <hshfit/bases/catalog.h>
#include <hshfit/coefficients/coefficients.h>

#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

/// Asymmetric inputs, on which any flip, swap or missing term changes values that GPUs read.
namespace hshfit::samples {

/// Random coefficients, falling off with the band, in the slots that the basis has.
inline Coefficients asymmetric(const std::string& basis, int order, const OutgoingSet& outgoing,
                               const Channels& channels, std::uint64_t seed,
                               bool condonShortley = false) {
    Coefficients c;
    c.basis = basis;
    c.order = order;
    c.condonShortley = condonShortley;
    c.channels = channels;
    c.outgoing = outgoing;
    c.isotropic = outgoing.map == OutgoingSet::Map::elevations;
    c.source = "random";
    c.generator = "hshfit test";
    const auto functions = bases::make(basis, order, {.condonShortley = condonShortley});
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    c.values.assign(outgoing.size() * channels.count() * c.slots(), 0.0);
    for (std::size_t p = 0; p < outgoing.size(); ++p) {
        for (std::size_t channel = 0; channel < channels.count(); ++channel) {
            for (int l = 0; l < order; ++l) {
                for (int m = -l; m <= l; ++m) {
                    const double value = uniform(random) / (1 + l);
                    if (functions->has(l, m)) c.at(p, channel)[slotOf(l, m)] = value;
                }
            }
        }
    }
    return c;
}

/// Upper-hemisphere directions that single precision holds exactly, a few of them near the pole and
/// near the horizon.
inline std::vector<Direction> floatDirections(std::size_t count, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::vector<Direction> directions;
    while (directions.size() < count) {
        const std::size_t k = directions.size();
        double z = uniform(random);
        if (k % 16 == 3) z = 1e-3 * z;
        if (k % 16 == 7) z = 1 - 1e-4 * z;
        const double r = std::sqrt((1 - z) * (1 + z)), phi = 2 * pi * uniform(random);
        const auto single = [](double v) { return static_cast<double>(static_cast<float>(v)); };
        directions.push_back({single(r * std::cos(phi)), single(r * std::sin(phi)), single(z)});
    }
    directions[0] = {0, 0, 1};
    return directions;
}

}  // namespace hshfit::samples
