#pragma once

#include <hshfit/coefficients/coefficients.h>

#include <temporary_folder.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

/// Coefficients with every field set and random values, for tests of writing and reading.
namespace hshfit::samples {

/// Finite doubles of every magnitude that float32 holds too, zeros of both signs among them.
inline std::vector<double> randomValues(std::size_t count, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> mantissa(-1, 1);
    std::uniform_int_distribution<int> exponent(-100, 100);
    std::vector<double> values(count);
    for (double& value : values) value = std::ldexp(mantissa(random), exponent(random));
    for (std::size_t i = 0; i < count; i += 7) values[i] = i % 2 ? 0.0 : -0.0;
    return values;
}

inline std::vector<Channels> allChannels() {
    return {Channels::grey(), Channels::rgb(),
            Channels::spectral({360, 450.5, std::nextafter(550, 551), 780})};
}

inline std::vector<OutgoingSet> allOutgoing() {
    return {OutgoingSet::parabolic(8, 8), OutgoingSet::parabolic(5, 9), OutgoingSet::elevations(6),
            OutgoingSet::direction(radians(52), radians(0)),
            OutgoingSet::direction(radians(33.3), radians(-123.456))};
}

inline Coefficients make(const OutgoingSet& outgoing, const Channels& channels, Quantity quantity,
                         int order, std::uint64_t seed) {
    Coefficients c;
    c.basis = "hsh";
    c.order = order;
    c.condonShortley = seed % 2 == 1;
    c.quantity = quantity;
    c.channels = channels;
    c.outgoing = outgoing;
    c.isotropic = seed % 3 == 0;
    c.bilateral = seed % 3 == 1;
    c.reciprocal = seed % 3 == 2;
    c.values = randomValues(outgoing.size() * channels.count() * c.slots(), seed);
    c.energy = {1.0 / 3, 1e-17, true, ""};
    c.error = 1e-7 / 3;
    c.source = "phong:exponent=37,kd=0.1/0.2/0.3";
    c.generator = "hshfit test";
    c.tolerance = 1e-6;
    return c;
}

using Folder = test::TemporaryFolder;

inline std::string contentOf(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

inline void put(const std::string& path, const std::string& content) {
    std::ofstream(path, std::ios::binary) << content;
}

}  // namespace hshfit::samples
