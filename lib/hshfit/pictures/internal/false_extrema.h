#pragma once

#include <cstddef>
#include <span>

namespace hshfit::inline pictures {

/// A dip along a line, and the index of its lowest point.
struct LineDip {
    double depth = 0;  ///< 0: none
    std::size_t at = 0;
};

/// The deepest dip of `g` along a line that the source `f` does not have:
///     max over a < k < c of min(min(g_a, g_c) - g_k - 2 near_k, min(d_a, d_c) - d_k),  d = g - f.
/// The first is the depth below the shoulders of the form itself, less twice the deepest dip that
/// the source has within 5 degrees of that place; the second is the same dip in the difference of
/// both, so that a dip of the source that merely is somewhat deeper is none, nor is a steep skirt.
/// Values are logarithms, so that depths are ratios; `angles` in degrees, ascending. A false peak
/// is a false dip of the negative values. All three have the same size.
LineDip falseDip(std::span<const double> f, std::span<const double> g,
                 std::span<const double> angles);

/// The share by which a value lies below one whose logarithm is larger by `depth`: 1 - exp(-depth).
double relativeDepth(double depth);

}  // namespace hshfit::inline pictures
