#include <hshfit/material_library/material_look.h>

#include <hshfit/brdf/vectors.h>
#include <hshfit/pictures/sphere_albedo.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

namespace hshfit::material_library {
namespace {

constexpr int elevations = 18;                   ///< of the albedo under a dome
constexpr int samples = 2;                       ///< along an edge of a pixel
constexpr double glossElevation = pi / 4;        ///< of light that shows gloss
constexpr double glossAngle = 10 * pi / 180;     ///< about the mirror direction
constexpr int glossRings = 32, glossTurns = 24;  ///< of directions in that cone
constexpr double leastChroma = 0.5;              ///< below which a colour has no hue

double luminanceOf(const LinearRgb& rgb) {
    return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
}

/// A grey material has its one channel for every colour.
LinearRgb coloursOf(const std::vector<double>& values) {
    LinearRgb rgb;
    for (std::size_t c = 0; c < 3; ++c) rgb[c] = std::max(values[values.size() == 1 ? 0 : c], 0.0);
    return rgb;
}

/// The mean of the albedos over outgoing directions, by their cosine: midpoints of elevations.
LinearRgb domeAlbedo(const AlbedoTable& table, std::size_t channels) {
    LinearRgb sum{};
    double weights = 0;
    std::vector<double> values(channels);
    for (int k = 0; k < elevations; ++k) {
        const double theta = (k + 0.5) * pi / 2 / elevations;
        const double weight = std::sin(theta) * std::cos(theta);
        table.at(directionFromAngles(theta, 0), values);
        const LinearRgb rgb = coloursOf(values);
        for (std::size_t c = 0; c < 3; ++c) sum[c] += weight * rgb[c];
        weights += weight;
    }
    for (double& value : sum) value /= weights;
    return sum;
}

/// f cos integrated over the cone of glossAngle about the mirror direction of wo, luminance: rings
/// at angles that grow with the square of their number, since lobes are narrow.
double mirroredLight(const Brdf& brdf, const Direction& wo) {
    const Direction mirror = mirrored(wo);
    const Direction across{0, 1, 0}, up = cross(mirror, across);
    double sum = 0;
    for (int ring = 0; ring < glossRings; ++ring) {
        const double t = (ring + 0.5) / glossRings, angle = glossAngle * t * t;
        const double width = glossAngle * 2 * t / glossRings;
        const double weight = std::sin(angle) * width * 2 * pi / glossTurns;
        for (int turn = 0; turn < glossTurns; ++turn) {
            const double phi = (turn + 0.5) * 2 * pi / glossTurns;
            const Direction wi = std::cos(angle) * mirror +
                                 std::sin(angle) * std::cos(phi) * across +
                                 std::sin(angle) * std::sin(phi) * up;
            sum += weight * wi.z * luminanceOf(coloursOf(evaluate(brdf, wi, wo)));
        }
    }
    return sum;
}

}  // namespace

MaterialLook lookOf(const Brdf& brdf, int pixels) {
    const std::size_t channels = brdf.channels().count();
    assert(channels == 1 || channels == 3);
    const AlbedoTable table(brdf, AlbedoTable::Detail::coarse);
    MaterialLook look{.albedo = domeAlbedo(table, channels)};
    look.luminance = luminanceOf(look.albedo);
    const Lab lab = labOf(look.albedo);
    look.chroma = std::hypot(lab.a, lab.b);
    if (look.chroma >= leastChroma) {
        const double hue = degrees(std::atan2(lab.b, lab.a));
        look.hue = hue < 0 ? hue + 360 : hue;
    }
    const Direction wo = directionFromAngles(glossElevation, 0);
    std::vector<double> reflected(channels);
    table.at(wo, reflected);
    const double all = luminanceOf(coloursOf(reflected));
    if (all > 0) look.gloss = std::min(mirroredLight(brdf, wo) / all, 1.0);
    look.picture = renderSphere(brdf, table, {.size = pixels, .samples = samples});
    return look;
}

}  // namespace hshfit::material_library
