#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace hshfit::tradeoff {

/// Indices of the points that no other beats: none costs less or the same with less error, or the
/// same error at less cost. By rising cost; of equal points the first. Points whose cost or error
/// is not a finite number are passed over.
std::vector<std::size_t> paretoFront(std::span<const double> costs, std::span<const double> errors);

/// Where the front bends most: the point farthest below the straight line between its ends, both
/// axes logarithmic and scaled to the front's extent (Satopaa et al. 2011, "Finding a 'kneedle' in
/// a haystack", without smoothing). Where no point is below the line, the last one: each cost up to
/// there lowers the error by more than the one before. None of an empty front.
/// Costs are above 0; an error of 0 counts as a thousandth of the least above it.
std::optional<std::size_t> kneeOf(std::span<const std::size_t> front, std::span<const double> costs,
                                  std::span<const double> errors);

}  // namespace hshfit::tradeoff
