#pragma once

#include <hshfit/brdf/directions.h>

#include <vector>

namespace hshfit::inline brdf {

class Brdf;

/// A curve on the hemisphere of wi at which f is not smooth, such as the border of a lobe that is
/// cut off at 0: the directions with
///     x wi.x + y wi.y + constant + linear wi.z + square wi.z^2 = 0,    low <= wi.z <= high.
/// With square = 0 it is a circle. A ring of constant elevation cuts it twice at most.
struct KinkCurve {
    double x = 0, y = 0, constant = 0, linear = 0, square = 0;
    double low = 0, high = 1;
    /// f is analytic up to the curve on both sides; if not, it has a power of the distance that is
    /// no whole number.
    bool smoothSides = true;
};

/// The directions at this cosine from `axis`.
inline KinkCurve circleAbout(const Direction& axis, double cosine, bool smoothSides = true) {
    return {.x = axis.x,
            .y = axis.y,
            .constant = -cosine,
            .linear = axis.z,
            .smoothSides = smoothSides};
}

/// A BRDF that can say along which curves it has kinks, apart from the rings of Brdf::kinks:
/// quadrature puts the ends of azimuth intervals there.
class HasKinkCurves {
public:
    virtual std::vector<KinkCurve> kinkCurves(const Direction& wo) const = 0;

protected:
    ~HasKinkCurves() = default;
};

/// The kink curves of a BRDF; none where it does not have HasKinkCurves.
std::vector<KinkCurve> kinkCurvesOf(const Brdf& brdf, const Direction& wo);

}  // namespace hshfit::inline brdf
