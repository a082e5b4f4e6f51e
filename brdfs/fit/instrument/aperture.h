#pragma once

#include <hshfit/brdf/brdf.h>

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::brdfs {

/// The directions that a detector takes in, or that a source shines from, about its nominal
/// direction n:
///     cone       directions within the half angle of n
///     rectangle  directions through a flat rectangle that n meets at right angles in its middle;
///                its sides are seen under half angles along the polar angle and across it
/// At the normal, which has no azimuth, the first side lies along x.
struct Aperture {
    enum class Shape { point, cone, rectangle };
    Shape shape = Shape::point;
    double half = 0, across = 0;  ///< half angles, radians
    std::string text;             ///< as it was stated

    bool finite() const { return shape != Shape::point; }
};

/// "cone:HALF" or "rectangle:HALFxHALF", degrees above 0 and below 90; empty: a point. Throws
/// UsageError.
Aperture parseAperture(std::string_view text);

/// Directions of a quadrature over an aperture, with weights cos(theta) d(omega).
struct PatchNodes {
    std::vector<Direction> directions;
    std::vector<double> weights;
};

/// 4 level^2 nodes over the part of the aperture above the horizon; of a point one, of weight 1. On
/// a cone that the horizon does not cut, rings of equal azimuths about n at Gauss-Legendre nodes of
/// 1 - cos of the angle to n, exact for polynomials of degree 4 level - 1 in the plane across n;
/// else products of Gauss-Legendre rules that end where the horizon cuts, so that smooth functions
/// converge exponentially.
PatchNodes patchNodes(const Aperture& aperture, const Direction& nominal, std::size_t level);

}  // namespace hshfit::brdfs
