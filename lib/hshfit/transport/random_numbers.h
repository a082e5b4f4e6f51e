#pragma once

#include <cmath>
#include <cstdint>

namespace hshfit::inline transport {

/// SplitMix64 (Steele, Lea and Flood 2014, "Fast splittable pseudorandom number generators"): a
/// sequence for each start, of which neighbours are independent, at the cost of a few operations.
class RandomNumbers {
public:
    /// The sequence of one item of a run.
    RandomNumbers(std::uint64_t seed, std::uint64_t item)
        : state_(mixed(seed + golden * (mixed(item) | 1))) {}

    /// Uniform in [0, 1), 53 bits.
    double next() {
        state_ += golden;
        return std::ldexp(static_cast<double>(mixed(state_) >> 11), -53);
    }

private:
    static constexpr std::uint64_t golden = 0x9e3779b97f4a7c15;

    static std::uint64_t mixed(std::uint64_t z) {
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
        z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
        return z ^ (z >> 31);
    }
    std::uint64_t state_;
};

}  // namespace hshfit::inline transport
