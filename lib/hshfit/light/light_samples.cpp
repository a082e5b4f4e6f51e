#include <hshfit/light/light_samples.h>

#include <hshfit/brdf/vectors.h>
#include <hshfit/light/coefficient_light.h>
#include <hshfit/light/internal/cap_nodes.h>
#include <hshfit/light/internal/node_levels.h>
#include <hshfit/light/internal/sky_nodes.h>
#include <hshfit/light/light_above.h>
#include <hshfit/light/panel_plane.h>
#include <hshfit/light/picture_light.h>
#include <hshfit/light/sky.h>
#include <hshfit/quadrature/quadrature.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline light {
namespace {

/// Axes with `towards` as the pole, the first along growing theta and the second along phi.
struct Axes {
    explicit Axes(const Direction& towards) : Axes(polarAngle(towards), azimuth(towards)) {}
    Axes(double theta, double phi)
        : pole(directionFromAngles(theta, phi)),
          down{std::cos(theta) * std::cos(phi), std::cos(theta) * std::sin(phi), -std::sin(theta)},
          along{-std::sin(phi), std::cos(phi), 0} {}
    Direction pole, down, along;
};

struct RadianceFrom {
    const Direction& world;

    Rgb operator()(const DiscLight& light) const {
        const Direction gap = world - light.towards;
        const bool inside = dot(gap, gap) <= std::pow(2 * std::sin(light.radius / 2), 2);
        return inside ? light.radiance : Rgb{};
    }
    Rgb operator()(const PanelLight& light) const {
        const Axes axes(light.towards);
        const double ahead = dot(world, axes.pole);
        if (!(ahead > 0)) return {};
        const double a = dot(world, axes.along) / ahead, b = dot(world, axes.down) / ahead;
        const double c = std::cos(light.turn), s = std::sin(light.turn);
        const bool inside = std::abs(c * a + s * b) <= std::tan(light.width / 2) &&
                            std::abs(c * b - s * a) <= std::tan(light.height / 2);
        return inside ? light.radiance : Rgb{};
    }
    Rgb operator()(const SkyLight& light) const { return radianceOf(light, world); }
    Rgb operator()(const PictureLight& light) const { return radianceOf(light, world); }
    Rgb operator()(const DirectionalLight&) const { return {}; }
    Rgb operator()(const CoefficientLight& light) const { return radianceOf(light, world); }
};

/// Share of a picture's flux times width, in radians, of its parts.
double finestAtLevel(int level) {
    return 1e-3 * std::pow(1.5, -3 * level);
}

/// Adds the nodes of one light at one level.
struct AddNodes {
    const Frame& frame;
    int level;
    LightSamples& samples;

    void operator()(const DiscLight& light) const {
        const Axes axes(light.towards);
        const int rings = nodesAtLevel(3 + 2 * light.radius, level), azimuths = 2 * rings + 1;
        const GaussRule& rule = gaussLegendre(rings);
        const double depth = 2 * std::pow(std::sin(light.radius / 2), 2);  // 1 - cos(radius)
        for (std::size_t r = 0; r < rule.nodes.size(); ++r) {
            const double missing = depth * (1 + rule.nodes[r]) / 2;
            const double s = std::sqrt(missing * (2 - missing));
            const double weight = depth * rule.weights[r] / 2 * 2 * pi / azimuths;
            for (int j = 0; j < azimuths; ++j) {
                const double phi = (j + 0.5) * 2 * pi / azimuths;
                samples.add(
                    frame.toLocal((1 - missing) * axes.pole + s * std::cos(phi) * axes.down +
                                  s * std::sin(phi) * axes.along),
                    light.radiance, weight);
            }
        }
    }

    void operator()(const PanelLight& light) const {
        const PanelPlane plane(light);
        const GaussRule& across = gaussLegendre(nodesAtLevel(4 + 4 * light.width, level));
        const GaussRule& down = gaussLegendre(nodesAtLevel(4 + 4 * light.height, level));
        for (std::size_t i = 0; i < across.nodes.size(); ++i) {
            for (std::size_t j = 0; j < down.nodes.size(); ++j) {
                const PanelPlane::Point point = plane.at(across.nodes[i], down.nodes[j]);
                samples.add(frame.toLocal(point.direction), light.radiance,
                            across.weights[i] * down.weights[j] * point.solidAngle);
            }
        }
    }

    void operator()(const SkyLight& light) const { addSkyNodes(light, frame, level, samples); }

    void operator()(const PictureLight& light) const {
        for (const PictureSample& part : pictureSamples(light, finestAtLevel(level)))
            samples.add(frame.toLocal(part.direction), part.flux, 1);
    }

    void operator()(const DirectionalLight& light) const {
        samples.add(frame.toLocal(light.towards), light.irradiance, 1);
    }

    void operator()(const CoefficientLight& light) const {
        Cap part{.axis = {0, 0, 1}, .radius = pi / 2};
        if (light.coefficients->domain == LightCoefficients::Domain::hemisphere)
            part.above = frame.toLocal(light.normal);
        std::vector<Direction> local, world;
        std::vector<double> weights;
        addCapNodes(part, light.coefficients->order, level, [&](const Direction& d, double weight) {
            local.push_back(d);
            world.push_back(frame.toWorld(d));
            weights.push_back(weight);
        });
        const std::vector<Rgb> radiance = radianceOf(light, world);
        for (std::size_t k = 0; k < local.size(); ++k)
            samples.add(local[k], radiance[k], weights[k]);
    }
};

/// Point k of the lattice on the unit square.
std::array<double, 2> latticePoint(std::size_t k) {
    constexpr double plastic = 1.32471795724474602596;  // the real root of x^3 = x + 1
    const auto part = [&](double step) {
        const double at = 0.5 + step * static_cast<double>(k);
        return at - std::floor(at);
    };
    return {part(1 / plastic), part(1 / (plastic * plastic))};
}

/// Adds lattice points of one light.
struct AddLattice {
    const Frame& frame;
    std::size_t points;
    LightSamples& samples;

    void operator()(const DiscLight& light) const {
        const Axes axes(light.towards);
        const double depth = 2 * std::pow(std::sin(light.radius / 2), 2);
        for (std::size_t k = 0; k < points; ++k) {
            const auto [u, v] = latticePoint(k);
            const double missing = depth * u, s = std::sqrt(missing * (2 - missing));
            samples.add(
                frame.toLocal((1 - missing) * axes.pole + s * std::cos(2 * pi * v) * axes.down +
                              s * std::sin(2 * pi * v) * axes.along),
                light.radiance, 2 * pi * depth / static_cast<double>(points));
        }
    }
    void operator()(const PanelLight& light) const {
        const PanelPlane plane(light);
        for (std::size_t k = 0; k < points; ++k) {
            const auto [u, v] = latticePoint(k);
            const PanelPlane::Point point = plane.at(2 * u - 1, 2 * v - 1);
            samples.add(frame.toLocal(point.direction), light.radiance,
                        4 * point.solidAngle / static_cast<double>(points));
        }
    }
    void operator()(const SkyLight& light) const {
        hemisphere([&](const Direction& world) { return radianceOf(light, world); });
    }
    void operator()(const PictureLight& light) const {
        hemisphere([&](const Direction& world) { return radianceOf(light, world); });
    }
    void operator()(const DirectionalLight& light) const {
        samples.add(frame.toLocal(light.towards), light.irradiance, 1);
    }
    void operator()(const CoefficientLight& light) const {
        hemisphere([&](const Direction& world) { return radianceOf(light, world); });
    }

private:
    template <class Radiance>
    void hemisphere(const Radiance& radiance) const {
        for (std::size_t k = 0; k < points; ++k) {
            const auto [u, v] = latticePoint(k);
            const double z = 1 - u, s = std::sqrt((1 - z) * (1 + z));
            const Direction local{s * std::cos(2 * pi * v), s * std::sin(2 * pi * v), z};
            samples.add(local, radiance(frame.toWorld(local)),
                        2 * pi / static_cast<double>(points));
        }
    }
};

}  // namespace

PanelPlane::PanelPlane(const PanelLight& light) {
    const Axes axes(light.towards);
    const double width = std::tan(light.width / 2), height = std::tan(light.height / 2);
    const double c = std::cos(light.turn), s = std::sin(light.turn);
    pole_ = axes.pole;
    across_ = width * (c * axes.along + s * axes.down);
    down_ = height * (c * axes.down - s * axes.along);
    area_ = width * height;
}

PanelPlane::Point PanelPlane::at(double x, double y) const {
    const Direction point = pole_ + x * across_ + y * down_;
    const double squared = dot(point, point), distance = std::sqrt(squared);
    return {(1 / distance) * point, area_ / (squared * distance)};
}

Frame::Frame(const Orientation& orientation) {
    const Axes axes(orientation.theta, orientation.phi);
    normal = axes.pole;
    // +x and +y, carried from +z along the great circle, then turned.
    const double turn = orientation.turn - orientation.phi;
    tangent = std::cos(turn) * axes.down + std::sin(turn) * axes.along;
    bitangent = cross(normal, tangent);
}

Direction Frame::toWorld(const Direction& d) const {
    return d.x * tangent + d.y * bitangent + d.z * normal;
}
Direction Frame::toLocal(const Direction& d) const {
    return {dot(d, tangent), dot(d, bitangent), dot(d, normal)};
}

void LightSamples::add(const Direction& local, const Rgb& radiance, double solidAngle) {
    // Coefficients of light ring below 0.
    const double total = std::abs(radiance[0]) + std::abs(radiance[1]) + std::abs(radiance[2]);
    if (!(local.z > 0) || !(total * solidAngle > 0)) return;
    const Direction d = normalised(local);
    x.push_back(d.x);
    y.push_back(d.y);
    z.push_back(d.z);
    for (std::size_t c = 0; c < 3; ++c) flux[c].push_back(radiance[c] * solidAngle);
}

void LightSamples::addAbove(const LightSamples& world, const Frame& frame) {
    std::size_t n = count();
    // Every sample is written, and the next one over it unless it is above.
    const std::size_t most = n + world.count() + 1;
    for (auto* values : {&x, &y, &z, &flux[0], &flux[1], &flux[2]}) values->resize(most);
    const Direction &t = frame.tangent, &b = frame.bitangent, &up = frame.normal;
    for (std::size_t k = 0; k < world.count(); ++k) {
        const double wx = world.x[k], wy = world.y[k], wz = world.z[k];
        x[n] = wx * t.x + wy * t.y + wz * t.z;
        y[n] = wx * b.x + wy * b.y + wz * b.z;
        z[n] = wx * up.x + wy * up.y + wz * up.z;
        for (std::size_t c = 0; c < 3; ++c) flux[c][n] = world.flux[c][k];
        n += z[n] > 0 ? 1 : 0;
    }
    for (auto* values : {&x, &y, &z, &flux[0], &flux[1], &flux[2]}) values->resize(n);
}

LightAbove::LightAbove(std::span<const Light> lights, int level) : level_(level) {
    for (const Light& light : lights) {
        const auto* picture = std::get_if<PictureLight>(&light);
        if (!picture) {
            others_.push_back(light);
            continue;
        }
        for (const PictureSample& part : pictureSamples(*picture, finestAtLevel(level))) {
            parts_.x.push_back(part.direction.x);
            parts_.y.push_back(part.direction.y);
            parts_.z.push_back(part.direction.z);
            for (std::size_t c = 0; c < 3; ++c) parts_.flux[c].push_back(part.flux[c]);
        }
    }
}

LightSamples LightAbove::pictures(const Frame& frame) const {
    LightSamples samples;
    samples.addAbove(parts_, frame);
    return samples;
}

LightSamples LightAbove::at(const Frame& frame) const {
    LightSamples samples = others(frame);
    samples.addAbove(parts_, frame);
    return samples;
}

Rgb radianceFrom(std::span<const Light> lights, const Direction& world) {
    Rgb total{};
    for (const Light& light : lights) {
        const Rgb one = std::visit(RadianceFrom{world}, light);
        for (std::size_t c = 0; c < 3; ++c) total[c] += one[c];
    }
    return total;
}

LightSamples sampleLights(std::span<const Light> lights, const Frame& frame, int level) {
    LightSamples samples;
    for (const Light& light : lights) std::visit(AddNodes{frame, level, samples}, light);
    return samples;
}

LightSamples latticeSamples(std::span<const Light> lights, const Frame& frame, std::size_t points) {
    LightSamples samples;
    for (const Light& light : lights) std::visit(AddLattice{frame, points, samples}, light);
    return samples;
}

}  // namespace hshfit::inline light
