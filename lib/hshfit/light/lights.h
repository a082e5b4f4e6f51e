#pragma once

#include <hshfit/brdf/directions.h>

#include <array>
#include <cstddef>
#include <string>
#include <variant>
#include <vector>

namespace hshfit::inline light {

/// Linear Rec. 709.
using Rgb = std::array<double, 3>;

/// A round light of uniform radiance, `radius` radians from its centre to its rim.
struct DiscLight {
    Direction towards;
    double radius = 0;
    Rgb radiance{};
};

/// A flat panel of uniform radiance that faces the surface: `width` (along azimuth) and `height`
/// (along elevation) are the angles, in radians, under which its axes are seen; then turned about
/// its centre by `turn`.
struct PanelLight {
    Direction towards;
    double width = 0, height = 0, turn = 0;
    Rgb radiance{};
};

/// The half space above the world's horizon, and a uniform ground below it.
/// uniform   L = zenith
/// overcast  L = zenith (1 + 2 cos theta) / 3   (Moon & Spencer 1942; CIE standard overcast sky)
struct SkyLight {
    enum class Model { uniform, overcast };
    Model model = Model::uniform;
    Rgb zenith{}, ground{};
};

/// A latitude-longitude picture: row 0 around the zenith; azimuth pi at the left edge, 0 in the
/// middle, -pi at the right edge, plus `turn`. Radiance is constant within a pixel.
struct PictureLight {
    std::string file;
    std::size_t width = 0, height = 0;
    std::vector<float> rgb;  ///< [row][column][R, G, B], scaled
    double turn = 0;
};

using Light = std::variant<DiscLight, PanelLight, SkyLight, PictureLight>;

}  // namespace hshfit::inline light
