#pragma once

#include <cstddef>

namespace hshfit::inline normal_filtering {

/// Sources of texel `at` along a side of `size` texels below it: the first and up to three shares.
struct Box {
    std::size_t first = 0, count = 1;
    double shares[3] = {1, 0, 0};
    std::size_t end() const { return first + count; }
};
inline Box boxOf(std::size_t at, std::size_t size) {
    if (size == 1) return {};
    if (size % 2 == 0) return {2 * at, 2, {0.5, 0.5, 0}};
    const double k = static_cast<double>(size / 2), n = static_cast<double>(size),
                 i = static_cast<double>(at);
    return {2 * at, 3, {(k - i) / n, k / n, (i + 1) / n}};
}

}  // namespace hshfit::inline normal_filtering
