#pragma once

#include <array>
#include <optional>

namespace hshfit::inline light {

using ColourMatrix = std::array<std::array<double, 3>, 3>;

/// From R, G, B of the given primaries (x and y of red, green, blue, white) to linear Rec. 709:
/// through CIE XYZ, the white adapted to D65 by Bradford's matrix, so that R = G = B stays so. The
/// unit matrix for Rec. 709 itself, and for the primaries that Radiance takes without a statement,
/// Rec. 709 with equal energy as white (0.64 0.33 0.29 0.6 0.15 0.06 0.3333 0.3333), which other
/// programs read as Rec. 709. None where the primaries span no colours.
std::optional<ColourMatrix> toRec709(const std::array<double, 8>& primaries);

/// Whether it is the unit matrix.
bool isUnit(const ColourMatrix& matrix);

}  // namespace hshfit::inline light
