#pragma once

#include <hshfit/brdf/directions.h>

#include <algorithm>

namespace hshfit::brdfs {

/// A linearly transformed cosine, Heitz, Dupuy, Hill & Neubelt 2016, 10.1145/2897824.2925895, in
/// the plane of incidence xz, wo on the side of +x. With the inverse of its matrix, up to a factor,
///            | a  0  b |
///     W   =  | 0  1  0 |,   W w the direction w taken back to the cosine,
///            | c  0  d |
/// its density is  D(w) = max(0, (W w)_z) |det W| / (pi |W w|^4)  per sr. D integrates to 1 over
/// the sphere; what of it lies below the horizon is lost. a, c, b, d are in this order x, y, z, w
/// of the first published picture: Minv = mat3(vec3(x, 0, y), vec3(0, 1, 0), vec3(z, 0, w)).
template <class Number = double>
struct LtcMatrix {
    Number a{1}, c{0}, b{0}, d{1};

    Number determinant() const { return a * d - b * c; }  ///< positive for every fit

    Number density(const Direction& w) const {
        const Number x = a * w.x + b * w.z, z = c * w.x + d * w.z;
        const Number square = x * x + w.y * w.y + z * z;
        if (!(z > 0.0)) return Number(0);
        return determinant() * z / (pi * square * square);
    }
};
using Ltc = LtcMatrix<double>;

/// The direction that W takes to `cosine`, a unit vector, and d omega of the one over d omega of
/// the other: D(w) stretch = cos / pi. For sampling and for quadrature that follows the lobe.
struct LtcDirection {
    Direction w;
    double stretch;
};
LtcDirection fromCosine(const Ltc& ltc, const Direction& cosine);

/// The lobe turned by `angle` radians about y, from +z towards +x.
Ltc turned(const Ltc& ltc, double angle);

/// Share of a sphere's irradiance that is left of it above the horizon, what the published shaders
/// look up for spherical lights and for polygons taken as such: the sphere's centre at the height
/// `cosine` (from -1 to 1) over the surface, and of form factor `form` (sin^2 of its apparent
/// radius, 0 to 1) when it is overhead. The integral of cos/pi over the part of the cap above the
/// horizon over `form`, of which a sphere that is all above has `cosine`.
double sphereAboveHorizon(double cosine, double form);

}  // namespace hshfit::brdfs
