#include <hshfit/pictures/ciede2000.h>

#include <hshfit/brdf/directions.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline pictures {
namespace {

/// C^7 / (C^7 + 25^7).
double sevenths(double chroma) {
    constexpr double seventhOf25 = 6103515625;
    const double seventh = std::pow(chroma, 7);
    return seventh / (seventh + seventhOf25);
}

/// Degrees in [0, 360); 0 for grey.
double hue(double a, double b) {
    if (a == 0 && b == 0) return 0;
    const double angle = degrees(std::atan2(b, a));
    return angle < 0 ? angle + 360 : angle;
}

/// Equations 10 and 14: the difference of hues and their mean, the shorter way round. Where one
/// of the colours is grey, its hue does not count.
struct Hues {
    double difference, mean;
};
Hues huesOf(double first, double second, bool grey) {
    if (grey) return {0, first + second};
    const double apart = second - first, sum = first + second;
    if (std::abs(apart) <= 180) return {apart, sum / 2};
    return {apart > 180 ? apart - 360 : apart + 360, sum < 360 ? sum / 2 + 180 : sum / 2 - 180};
}

double square(double x) {
    return x * x;
}

}  // namespace

double ciede2000(const Lab& x, const Lab& y) {
    const double g =
        (1 - std::sqrt(sevenths((std::hypot(x.a, x.b) + std::hypot(y.a, y.b)) / 2))) / 2;
    const double ax = (1 + g) * x.a, ay = (1 + g) * y.a;
    const double cx = std::hypot(ax, x.b), cy = std::hypot(ay, y.b);
    const auto [apart, h] = huesOf(hue(ax, x.b), hue(ay, y.b), cx * cy == 0);
    const double lightness = y.lightness - x.lightness, chroma = cy - cx;
    const double hueDistance = 2 * std::sqrt(cx * cy) * std::sin(radians(apart / 2));
    const double t = 1 - 0.17 * std::cos(radians(h - 30)) + 0.24 * std::cos(radians(2 * h)) +
                     0.32 * std::cos(radians(3 * h + 6)) - 0.20 * std::cos(radians(4 * h - 63));
    const double meanChroma = (cx + cy) / 2;
    const double fromMiddle = square((x.lightness + y.lightness) / 2 - 50);
    const double perLightness = 1 + 0.015 * fromMiddle / std::sqrt(20 + fromMiddle);
    const double perChroma = 1 + 0.045 * meanChroma, perHue = 1 + 0.015 * meanChroma * t;
    const double turn = 30 * std::exp(-square((h - 275) / 25));
    const double rotation = -std::sin(radians(2 * turn)) * 2 * std::sqrt(sevenths(meanChroma));
    const double l = lightness / perLightness, c = chroma / perChroma, e = hueDistance / perHue;
    return std::sqrt(std::max(0.0, l * l + c * c + e * e + rotation * c * e));
}

}  // namespace hshfit::inline pictures
