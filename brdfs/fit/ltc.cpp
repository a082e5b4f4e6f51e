#include <brdfs/fit/ltc.h>

#include <hshfit/quadrature/quadrature.h>

#include <cmath>

namespace hshfit::brdfs {

LtcDirection fromCosine(const Ltc& ltc, const Direction& cosine) {
    const double determinant = ltc.determinant();
    const double x = (ltc.d * cosine.x - ltc.b * cosine.z) / determinant;
    const double z = (ltc.a * cosine.z - ltc.c * cosine.x) / determinant;
    const double length = std::sqrt(x * x + cosine.y * cosine.y + z * z);
    return {{x / length, cosine.y / length, z / length},
            1 / (determinant * length * length * length)};
}

Ltc turned(const Ltc& ltc, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    return {.a = ltc.a * c + ltc.b * s,
            .c = ltc.c * c + ltc.d * s,
            .b = ltc.b * c - ltc.a * s,
            .d = ltc.d * c - ltc.c * s};
}

namespace {

/// The integral over phi of max(0, level + swing cos phi), swing >= 0.
double positivePart(double level, double swing) {
    if (level >= swing) return 2 * pi * level;
    if (level <= -swing) return 0;
    const double edge = std::acos(-level / swing);
    return 2 * (level * edge + swing * std::sin(edge));
}

}  // namespace

double sphereAboveHorizon(double cosine, double form) {
    const double tilt = std::acos(std::clamp(cosine, -1.0, 1.0));
    const double radius = std::asin(std::sqrt(std::clamp(form, 0.0, 1.0)));
    const double touches = std::abs(pi / 2 - tilt);  // the ring that first meets the horizon
    if (radius <= touches) return std::max(cosine, 0.0);
    constexpr int nodes = 32;
    const GaussRule& rule = gaussLegendre(nodes);
    double sum = 0;
    const auto addRings = [&](double from, double to) {
        for (int k = 0; k < nodes; ++k) {
            const double angle = (from + to) / 2 + (to - from) / 2 * rule.nodes[k];
            sum += (to - from) / 2 * rule.weights[k] * std::sin(angle) *
                   positivePart(std::cos(tilt) * std::cos(angle), std::sin(tilt) * std::sin(angle));
        }
    };
    addRings(0, touches);
    addRings(touches, radius);
    return sum / (pi * form);
}

}  // namespace hshfit::brdfs
