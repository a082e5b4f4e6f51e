#include <hshfit/representation/halfway/halfway_axes.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline representation::inline halfway {
namespace {

constexpr double leastSquare = 1e-280;

double stretchOf(double roughness) {
    return std::sqrt(1 / (roughness * roughness) - 1);
}

/// l of a direction.
double maskingOf(const HalfwayAxes::Constants& k, const Direction& w) {
    return std::sqrt(w.z * w.z + k.lxx * w.x * w.x + k.lxy * w.x * w.y + k.lyy * w.y * w.y);
}

}  // namespace

HalfwayAxes::HalfwayAxes(const HalfwayLobe& lobe) {
    const double c = std::cos(lobe.turn), s = std::sin(lobe.turn);
    const double along = stretchOf(lobe.along), across = stretchOf(lobe.across);
    const double least = std::min(lobe.along, lobe.across);
    const double aa = lobe.along * lobe.along, bb = lobe.across * lobe.across;
    constants_ = {.xx = along * c,
                  .xy = along * s,
                  .yx = -across * s,
                  .yy = across * c,
                  .perLog = 1 / (-2 * std::log(least)),
                  .amplitude = 1 / (2 * pi * lobe.along * lobe.across),
                  .shelf = lobe.shelf,
                  .masked = lobe.masked,
                  .lxx = aa * c * c + bb * s * s,
                  .lxy = 2 * (aa - bb) * c * s,
                  .lyy = aa * s * s + bb * c * c};
}

HalfwayPoint HalfwayAxes::at(const Constants& k, const Direction& wi, const Direction& wo) {
    double tail;
    HalfwayPoint p = unplaced(k, wi, wo, tail);
    // Polynomials of x ask for its absolute error alone: log1p takes thrice the time.
    p.place(std::cbrt(wi.z), std::cbrt(wo.z), std::log(tail) * k.perLog);
    return p;
}

HalfwayPoint HalfwayAxes::unplaced(const Constants& k, const Direction& wi, const Direction& wo,
                                   double& tail) {
    const double hx = wi.x + wo.x, hy = wi.y + wo.y, hz = wi.z + wo.z;
    const double across = hx * hx + hy * hy;
    // wi = -wo at the horizon has no half vector.
    const double square = std::max(across + hz * hz, leastSquare);
    const double gx = k.xx * hx + k.xy * hy, gy = k.yx * hx + k.yy * hy;
    const double stretched = gx * gx + gy * gy, radius = std::sqrt(stretched);
    tail = 1 + stretched / square;
    HalfwayPoint p;
    p.v = std::min(1.0, std::sqrt(square) / 2);
    p.kappa = (wo.z - wi.z) / (2 * std::sqrt(across / square) + 1e-9);
    p.handed = wi.x * wo.y - wi.y * wo.x;
    p.cosine = radius > 0 ? gx / radius : 1;
    p.sine = radius > 0 ? gy / radius : 0;
    const double facing = k.masked ? wo.z * maskingOf(k, wi) + wi.z * maskingOf(k, wo)
                                   : wi.z * wo.z + (wi.z + wo.z) / 2;
    p.weight = k.amplitude / (tail * tail * (facing + k.shelf));
    return p;
}

}  // namespace hshfit::inline representation::inline halfway
