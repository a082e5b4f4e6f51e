#pragma once

#include <array>

namespace hshfit::inline pictures {

/// Linear Rec. 709: R, G and B.
using LinearRgb = std::array<double, 3>;

/// CIE XYZ relative to white, R = G = B = 1 (IEC 61966-2-1, with the digits of the primaries),
/// and back.
std::array<double, 3> relativeXyz(const LinearRgb& rgb);
LinearRgb rgbOfRelativeXyz(std::array<double, 3> xyz);

/// A colour of CIE L*a*b* (CIE 15:2004, section 8.2.1).
struct Lab {
    double lightness = 0, a = 0, b = 0;
};

/// L*a*b* with the white R = G = B = 1: black has lightness 0, white 100.
Lab labOf(const LinearRgb& rgb);

}  // namespace hshfit::inline pictures
