#pragma once

#include <array>

namespace hshfit::inline brdf {

/// CIE 1931 2-degree colour-matching functions and the relative power of illuminant D65.
struct CieRow {
    double x, y, z, d65;
};

constexpr double cieFirst = 380, cieStep = 5;  ///< nm

/// 380 to 780 nm by 5 nm. Colour matching: CIE 15:2004 table T.4. D65 after note 5 to table T.1:
/// S0 + M1 S1 + M2 S2 every 10 nm with M1 = -0.295 and M2 = -0.689, linear between.
extern const std::array<CieRow, 81> cie1931;

}  // namespace hshfit::inline brdf
