#pragma once

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>

namespace hshfit {

/// The product of sizes that a file states. Nothing where the sizes, multiplied from the first to
/// the last, exceed 64 bits on the way, even if a 0 follows. Without sizes it is 1.
constexpr std::optional<std::uint64_t> checkedProduct(std::span<const std::uint64_t> sizes) {
    std::uint64_t product = 1;
    for (const std::uint64_t size : sizes)
        if (__builtin_mul_overflow(product, size, &product)) return std::nullopt;
    return product;
}
constexpr std::optional<std::uint64_t> checkedProduct(std::initializer_list<std::uint64_t> sizes) {
    return checkedProduct(std::span(sizes.begin(), sizes.size()));
}

}  // namespace hshfit
