#pragma once

#include <hshfit/light/lights.h>
#include <hshfit/lighting/elevation_table.h>

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace hshfit::lighting {

/// Linearly transformed cosines of one BRDF by elevation and, with a tangent, azimuth of wo, for
/// polygons of light (Heitz, Dupuy, Hill & Neubelt 2016, 10.1145/2897824.2925895):
///     radiance of a polygon = L (even(wo) F(polygon) + rest(wo) F(W polygon) / share)
/// F is the form factor of the part above the horizon; polygons are cut at the surface's horizon
/// before they are transformed, and `share`, the part of the lobe above it, makes the albedo exact.
/// W = | a 0 b | e 1 f | c g d | in the frame of n and wo, wo on the side of +x.
/// A row is three texels: R, G, B of `even` and a; R, G, B of `rest` / share and b; c, d, 0, 0
/// where lobes are their own mirror image (lobesInPlane: e, f and g are 0), else four: c, d, e, f;
/// g, 0, 0, 0.
struct CosineTable {
    ElevationTable table = {};
};

/// One row's lobe. Any invertible matrix has this form, up to a factor and a turn about +z that
/// leaves the cosine as it is.
struct TransformedCosine {
    double a = 1, b = 0, c = 0, d = 1, e = 0, f = 0, g = 0;
    /// The share of the lobe that is above the horizon, (1 + a / sqrt(a^2 + (e g - c)^2 + (a g)^2))
    /// / 2: the cosine's integral over a lune. The determinant is positive.
    double share() const;
};

/// A table from rows, [azimuth][row] as in ElevationTable: `even` and `rest` as in LobeSummary.
struct CosineRow {
    Rgb even{}, rest{};
    TransformedCosine lobe = {};
};
CosineTable cosineTable(std::span<const CosineRow> rows, AzimuthNodes azimuths = {},
                        bool inPlane = true);

/// A quadrilateral of uniform radiance that lights from both sides; corners relative to the
/// surface, at any distance.
struct AreaLight {
    std::array<Direction, 4> corners;
    Rgb radiance{};
};

/// Lights as quadrilaterals. Panels are exact; discs and light from one direction are squares of
/// the same solid angle (at least half a degree across) and flux. Skies and pictures are cut into
/// `count` rectangles on the faces of a cube, which tile the sphere: those are cut in which
/// radiance varies most, weighted with their solid angle, each with its mean radiance.
std::vector<AreaLight> areaLights(std::span<const Light> lights, std::size_t count);

/// F = 1 / pi times the integral of cos(theta) over the part of a quadrilateral above z = 0.
double formFactor(const std::array<Direction, 4>& corners);

/// Radiance of a surface in the world under the sum of the lights; `tangent` as in HarmonicShading.
Rgb radiance(const CosineTable& table, std::span<const AreaLight> lights, const Direction& normal,
             const Direction& viewer, const Direction& tangent = {0, 0, 0});

}  // namespace hshfit::lighting
