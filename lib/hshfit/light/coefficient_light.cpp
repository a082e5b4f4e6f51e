#include <hshfit/light/coefficient_light.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/brdf/vectors.h>
#include <hshfit/coefficient_files/light_file.h>
#include <hshfit/light/light_samples.h>
#include <hshfit/rotation/sh_rotation.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace hshfit::inline light {
namespace {

using Domain = LightCoefficients::Domain;

/// Directions evaluated at a time.
constexpr std::size_t batchSize = 256;

Direction toLocal(const CoefficientLight& light, const Direction& world) {
    return {dot(world, light.tangent), dot(world, light.bitangent), dot(world, light.normal)};
}

}  // namespace

CoefficientLight coefficientLight(LightCoefficients coefficients, const std::string& file) {
    CoefficientLight light;
    light.file = file;
    light.basis = bases::make(coefficients.basis, coefficients.order,
                              {.condonShortley = coefficients.condonShortley});
    Orientation orientation;
    if (coefficients.domain == Domain::hemisphere)
        orientation = {.theta = coefficients.normalTheta, .phi = coefficients.normalPhi};
    const Frame frame(orientation);
    light.tangent = frame.tangent;
    light.bitangent = frame.bitangent;
    light.normal = frame.normal;
    light.coefficients = std::make_shared<const LightCoefficients>(std::move(coefficients));
    return light;
}

CoefficientLight readCoefficientLight(const std::string& path) {
    return coefficientLight(readLight(path), path);
}

bool covers(const CoefficientLight& light, const Direction& world) {
    return light.coefficients->domain == Domain::sphere || dot(world, light.normal) > 0;
}

std::vector<Rgb> radianceOf(const CoefficientLight& light, const std::vector<Direction>& world) {
    const LightCoefficients& c = *light.coefficients;
    std::vector<Rgb> radiance(world.size());
    std::vector<double> x, y, z, values(std::min(batchSize, world.size()) * c.slots());
    for (std::size_t first = 0; first < world.size(); first += batchSize) {
        const std::size_t count = std::min(batchSize, world.size() - first);
        x.clear(), y.clear(), z.clear();
        for (std::size_t k = 0; k < count; ++k) {
            const Direction local = toLocal(light, world[first + k]);
            x.push_back(local.x);
            y.push_back(local.y);
            z.push_back(covers(light, world[first + k]) ? local.z : std::abs(local.z));
        }
        light.basis->evaluate({x.data(), y.data(), z.data(), count}, values.data());
        for (std::size_t k = 0; k < count; ++k) {
            if (!covers(light, world[first + k])) continue;
            const double* at = values.data() + k * c.slots();
            for (std::size_t channel = 0; channel < 3; ++channel) {
                const double* from = c.at(c.channels.count() == 1 ? 0 : channel);
                double sum = 0;
                for (std::size_t i = 0; i < c.slots(); ++i) sum += from[i] * at[i];
                radiance[first + k][channel] = light.scale * sum;
            }
        }
    }
    return radiance;
}

Rgb radianceOf(const CoefficientLight& light, const Direction& world) {
    return radianceOf(light, std::vector<Direction>{world}).front();
}

void exchangeSides(int order, std::vector<double>& coefficients) {
    const auto slots = static_cast<std::size_t>(order) * static_cast<std::size_t>(order);
    for (std::size_t first = 0; first < coefficients.size(); first += slots)
        for (int l = 1; l < order; ++l)
            for (int m = -l; m < 0; ++m) {
                double& value = coefficients[first + static_cast<std::size_t>(slotOf(l, m))];
                value = -value;
            }
}

std::vector<double> harmonicsOf(const CoefficientLight& light, int order, bool condonShortley) {
    const LightCoefficients& c = *light.coefficients;
    assert(c.domain == Domain::sphere);
    const auto slots = static_cast<std::size_t>(order) * static_cast<std::size_t>(order);
    std::vector<double> values(3 * slots, 0.0);
    for (std::size_t channel = 0; channel < 3; ++channel) {
        const double* from = c.at(c.channels.count() == 1 ? 0 : channel);
        double* to = values.data() + channel * slots;
        for (int l = 0; l < std::min(order, c.order); ++l)
            for (int m = -l; m <= l; ++m)
                to[slotOf(l, m)] =
                    light.scale * azimuthSign(m, c.condonShortley) * from[slotOf(l, m)];
    }
    const Direction &x = light.tangent, &y = light.bitangent, &z = light.normal;
    const bool mirrored = dot(cross(x, y), z) < 0;
    const double side = mirrored ? -1 : 1;
    if (mirrored) exchangeSides(order, values);
    const Rotation placed =
        Rotation::fromMatrix({x.x, side * y.x, z.x, x.y, side * y.y, z.y, x.z, side * y.z, z.z});
    if (!isIdentity(placed))
        ShRotation(order).rotate({&placed, 1}, 3, values.data(), values.data());
    for (std::size_t channel = 0; channel < 3; ++channel)
        for (int l = 0; l < order; ++l)
            for (int m = -l; m <= l; ++m)
                values[channel * slots + static_cast<std::size_t>(slotOf(l, m))] *=
                    azimuthSign(m, condonShortley);
    return values;
}

}  // namespace hshfit::inline light
