#pragma once

#include <cstddef>

namespace hshfit::inline light {

/// A row of a latitude-longitude picture, [column][R, G, B], folded about the quadrants of
/// psi = 2 pi (column + 1/2) / width:
///     out[kind * kindStride + channel * width / 4 + column of the first quadrant],
/// kinds as in AzimuthColumns: the parts of cos(m psi) for even and odd m, of sin(m psi) for odd
/// and even m. Adds the sums of squares by channel to `squares`. `width` is a multiple of 4.
void foldPictureRow(const float* row, std::size_t width, std::size_t kindStride, double* out,
                    double* squares);

/// The sum of all values of a row: one pass over its pixels, to compare with.
double sumPictureRow(const float* row, std::size_t width);

}  // namespace hshfit::inline light
