#pragma once

#include <hshfit/irradiance/irradiance.h>

namespace hshfit::inline irradiance {

/// The order-3 zonal form of nine coefficients (Roughton, Sloan, Silvennoinen, Iwanicki & Shirley
/// 2024, "ZH3: Quadratic Zonal Harmonics"): bands 0 and 1 as they are, and of band 2 only its
/// part that is zonal about an axis shared by the channels, the direction of band 1 of their
/// luminance (Rec. 709). 15 numbers instead of 27; the axis follows from band 1.
struct ZonalForm {
    std::array<Rgb, 4> linear{};  ///< slots 0 to 3
    Rgb quadratic{};              ///< coefficient of the zonal harmonic about the axis
    Direction axis;               ///< +z where band 1 is 0
};

/// The least-squares zonal part: quadratic = sum over m of c_{2,m} Y_{2,m}(axis) sqrt(4 pi / 5).
ZonalForm zonalForm(const NineRgb& coefficients);
NineRgb nineOf(const ZonalForm& form);

}  // namespace hshfit::inline irradiance
