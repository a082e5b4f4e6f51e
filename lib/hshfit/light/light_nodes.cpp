#include <hshfit/light/light_nodes.h>

#include <hshfit/light/coefficient_light.h>
#include <hshfit/light/internal/cap_nodes.h>
#include <hshfit/light/internal/picture_nodes.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace hshfit::inline light {
namespace {

/// Largest order for which the sharp peak of a sky about the sun is resolved by rings about it.
constexpr int ordersAboutSun = 32;

struct AddLight {
    const Light& whole;
    const LightDomain& domain;
    const Frame frame;
    int order, level;
    LightNodes& nodes;

    bool hemisphere() const { return domain.normal.has_value(); }

    void cap(const Cap& cap, const std::function<Rgb(const Direction&)>& radiance) const {
        addCapNodes(cap, order, level,
                    [&](const Direction& d, double weight) { nodes.add(d, radiance(d), weight); });
    }

    void operator()(const DiscLight& light) const {
        Cap part{.axis = frame.toLocal(light.towards), .radius = light.radius};
        if (hemisphere()) part.above = Direction{0, 0, 1};
        cap(part, [&](const Direction&) { return light.radiance; });
    }

    void operator()(const SkyLight& light) const {
        const Direction up = frame.toLocal({0, 0, 1}), down = Direction{-up.x, -up.y, -up.z};
        const auto sky = [&](const Direction& d) {
            // The world's horizon belongs to the sky, whatever rounding makes of it.
            Direction world = frame.toWorld(d);
            world.z = std::max(world.z, 0.0);
            return radianceFrom({&whole, 1}, world);
        };
        const auto ground = [&](const Direction&) { return light.ground; };
        if (hemisphere()) {
            cap({.axis = {0, 0, 1}, .radius = pi / 2, .above = up}, sky);
            cap({.axis = {0, 0, 1}, .radius = pi / 2, .above = down}, ground);
            return;
        }
        if (light.peaked() && order <= ordersAboutSun)
            cap({.axis = light.sun, .radius = pi, .above = up}, sky);
        else
            cap({.axis = up, .radius = pi / 2}, sky);
        cap({.axis = down, .radius = pi / 2}, ground);
    }

    /// The order asked for is met by more levels of the panel's own nodes.
    void operator()(const PanelLight& light) const {
        const double wide = std::max(light.width, light.height);
        const double finer = std::log(1 + order * wide / (4 + 4 * wide)) / std::log(1.5);
        const int at = level + static_cast<int>(std::ceil(finer));
        addSamples(sampleLights({&whole, 1}, frame, at), 1, light.radiance);
        if (hemisphere()) return;
        addSamples(sampleLights({&whole, 1}, Frame({.theta = pi, .phi = 0, .turn = 0}), at), 0,
                   light.radiance);
    }

    void operator()(const DirectionalLight& light) const {
        const Direction d = frame.toLocal(light.towards);
        if (hemisphere() && !(d.z > 0)) return;
        nodes.add(d, light.irradiance, 1);
        nodes.weight.back() = 0;
    }

    void operator()(const PictureLight& light) const {
        addPictureNodes(light, domain, order, level, nodes);
    }

    /// The bands of the light and the bands asked for share the nodes.
    void operator()(const CoefficientLight& light) const {
        Cap part{.axis = {0, 0, 1}, .radius = hemisphere() ? pi / 2 : pi};
        if (light.coefficients->domain == LightCoefficients::Domain::hemisphere)
            part.above = frame.toLocal(light.normal);
        std::vector<Direction> local, world;
        std::vector<double> weights;
        addCapNodes(part, std::max(order, light.coefficients->order), level,
                    [&](const Direction& d, double weight) {
                        local.push_back(d);
                        world.push_back(frame.toWorld(d));
                        weights.push_back(weight);
                    });
        const std::vector<Rgb> radiance = radianceOf(light, world);
        for (std::size_t k = 0; k < local.size(); ++k) nodes.add(local[k], radiance[k], weights[k]);
    }

private:
    void addSamples(const LightSamples& samples, int isOwn, const Rgb& radiance) const {
        const Frame other({.theta = pi, .phi = 0, .turn = 0});
        const auto brightest = static_cast<std::size_t>(
            std::max_element(radiance.begin(), radiance.end()) - radiance.begin());
        for (std::size_t k = 0; k < samples.count(); ++k) {
            Direction d{samples.x[k], samples.y[k], samples.z[k]};
            if (!isOwn) d = frame.toLocal(other.toWorld(d));
            nodes.add(d, radiance, samples.flux[brightest][k] / radiance[brightest]);
        }
    }
};

}  // namespace

void LightNodes::add(const Direction& local, const Rgb& radiance, double solidAngle) {
    x.push_back(local.x);
    y.push_back(local.y);
    z.push_back(local.z);
    weight.push_back(solidAngle);
    for (std::size_t c = 0; c < 3; ++c) flux[c].push_back(radiance[c] * solidAngle);
}

LightNodes nodesOf(const Light& light, const LightDomain& domain, int order, int level) {
    LightNodes nodes;
    std::visit(AddLight{light, domain, domain.frame(), order, level, nodes}, light);
    return nodes;
}

}  // namespace hshfit::inline light
