#pragma once

// Ranges and ticks of axes.

#include <array>
#include <string>
#include <vector>

namespace hshfit::inline pages {

/// Whole decades from below the least to above the greatest, at most `decades` of them. No double
/// is outside of 10^-300 to 10^300 but a few, which would have no axis.
std::array<int, 2> decadesOf(double least, double most, int decades);

/// The least of some round numbers times a power of ten at or above `value`.
double roundedUp(double value);

/// A tick of an axis; minor ones have no label.
struct AxisTick {
    double at = 0;
    std::string label = {};
    bool minor = false;
};

/// Ticks at multiples of 1, 2, 2.5 or 5 times a power of ten, at most `most` of them. A minus sign
/// is U+2212.
std::vector<AxisTick> linearTicks(double low, double high, int most);
/// Decades with labels, every second or more where there are more than `most`; others minor, and 2
/// to 9 between them where there are few. "0.01", or "10^{−5}" far from 1, as gnuplot sets it.
std::vector<AxisTick> logTicks(int low, int high, int most);

}  // namespace hshfit::inline pages
