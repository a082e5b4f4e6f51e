#pragma once

#include <hshfit/brdf/directions.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

namespace hshfit::brdfs {

using LobeWords = std::map<std::string, std::string>;  ///< choices of the model, by key

/// What lobes are functions of, for a pair of directions above the horizon.
struct PairGeometry {
    Direction in, out;
    double cosI, cosO;
    double across;        ///< |xy|^2 of wi + wo
    double squaredSlope;  ///< tan^2 theta_h
    double squaredZ;      ///< of wi + wo
    double dot;           ///< cosine between the half vector and either direction

    PairGeometry(const Direction& wo, double x, double y, double z)
        : in{x, y, z}, out(wo), cosI(z), cosO(wo.z) {
        const double hx = x + wo.x, hy = y + wo.y, hz = z + wo.z;
        across = hx * hx + hy * hy;
        squaredZ = hz * hz;
        squaredSlope = across / squaredZ;
        dot = std::min(1.0, 0.5 * std::sqrt(across + squaredZ));
    }
    double grooves() const {
        const double open = 1 / cosI / cosO;
        return std::min(open, 2 / std::sqrt(1 + squaredSlope) / dot / std::max(cosI, cosO));
    }
    double schlick() const { return schlickOf(dot); }
    static double schlickOf(double cosine) {
        const double rest = 1 - cosine;
        return rest * rest * rest * rest * rest;
    }
    /// 1 - cos of the angle between wi and the mirror direction of wo.
    double mirrorVersine() const {
        const double dz = in.z - out.z;
        return (across + dz * dz) / 2;
    }
    /// 1 - cos theta_h
    double tiltVersine() const {
        const double secant = std::sqrt(1 + squaredSlope);
        return squaredSlope / (secant * (1 + secant));
    }
};

/// Fresnel's reflectance of a dielectric; `inverse` is 1 / eta.
template <class T>
T fresnelOf(const T& inverse, double cosine) {
    using std::sqrt;
    const double c = std::max(cosine, 1e-9);
    const T ec = inverse * c;
    const T g = sqrt((1.0 - inverse) * (1.0 + inverse) + ec * ec);
    const T a = (g - ec) / (g + ec);
    const T b = (c * (g + ec) - inverse) / (c * (g - ec) + inverse);
    return 0.5 * a * a * (1.0 + b * b);
}

}  // namespace hshfit::brdfs
