#include <hshfit/gpu/containers/test_triples.h>

#include <hshfit/coefficients/reconstruction.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace hshfit::gpu::inline containers {
namespace {

constexpr int spread = 64;

/// Rounded to single precision, not below the horizon.
Direction rounded(double z, double phi) {
    const double r = std::sqrt((1 - z) * (1 + z));
    return {static_cast<double>(static_cast<float>(r * std::cos(phi))),
            static_cast<double>(static_cast<float>(r * std::sin(phi))),
            static_cast<double>(static_cast<float>(z))};
}

std::vector<double> valueAt(const Reconstruction& sum, const TestTriple& triple) {
    std::vector<double> value(sum.channels().count());
    sum.evalQuantity(triple.wo, {&triple.wi.x, &triple.wi.y, &triple.wi.z, 1}, value.data());
    return value;
}

}  // namespace

std::vector<TestTriple> testPairs() {
    std::vector<TestTriple> result;
    double root = 1;  // of x^5 = x + 1
    for (int i = 0; i < 64; ++i) root = std::pow(1 + root, 0.2);
    const auto coordinate = [&](int i, int k) {
        const double u = 0.5 + i * std::pow(root, -k);
        return u - std::floor(u);
    };
    for (int i = 1; i <= spread; ++i) {
        // z uniform in (0, 1), but not so low that single precision loses the elevation
        result.push_back({rounded(std::max(coordinate(i, 1), 1e-3), 2 * pi * coordinate(i, 2)),
                          rounded(std::max(coordinate(i, 3), 1e-3), 2 * pi * coordinate(i, 4)),
                          {}});
    }
    const double pole = std::cos(1e-3), low = std::cos(radians(89.5));
    result.push_back({{0, 0, 1}, {0, 0, 1}, {}});
    result.push_back({{0, 0, 1}, rounded(0.5, 1), {}});
    result.push_back({rounded(0.5, 2), {0, 0, 1}, {}});
    result.push_back({rounded(pole, 3), rounded(pole, -1), {}});
    result.push_back({rounded(low, 0.3), rounded(0.7, -2), {}});
    result.push_back({rounded(0.7, 2.5), rounded(low, -0.4), {}});
    result.push_back({rounded(low, -2.9), rounded(low, 0.2), {}});
    result.push_back({rounded(low, pi / 2), rounded(pole, 0), {}});
    return result;
}

std::vector<TestTriple> testTriples(const Payload& payload) {
    const Reconstruction sum(unpack(payload));
    std::vector<TestTriple> triples = testPairs();
    for (TestTriple& triple : triples) {
        if (payload.head.outgoing.map == OutgoingSet::Map::direction) {
            const Direction& d = payload.head.outgoing.directions[0];
            triple.wo = {static_cast<double>(static_cast<float>(d.x)),
                         static_cast<double>(static_cast<float>(d.y)),
                         static_cast<double>(static_cast<float>(d.z))};
        }
        triple.value = valueAt(sum, triple);
    }
    return triples;
}

double largestDifference(const Payload& payload, std::span<const TestTriple> triples) {
    const Reconstruction sum(unpack(payload));
    double difference = 0, largest = 0;
    for (const TestTriple& triple : triples) {
        const std::vector<double> value = valueAt(sum, triple);
        for (std::size_t i = 0; i < value.size(); ++i) {
            difference = std::max(difference, std::abs(value[i] - triple.value[i]));
            largest = std::max(largest, std::abs(value[i]));
        }
    }
    return largest > 0 ? difference / largest : difference;
}

}  // namespace hshfit::gpu::inline containers
