#include <hshfit/light/light_nodes.h>

#include <hshfit/light/internal/picture_nodes.h>
#include <hshfit/quadrature/quadrature.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace hshfit::inline light {
namespace {

Direction scaled(double a, const Direction& u) {
    return {a * u.x, a * u.y, a * u.z};
}
Direction plus(const Direction& u, const Direction& v) {
    return {u.x + v.x, u.y + v.y, u.z + v.z};
}
Direction cross(const Direction& a, const Direction& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

int grown(double nodes, int level) {
    return std::max(2, static_cast<int>(std::ceil(nodes * std::pow(1.5, level))));
}

/// The part of a cap about `axis` that lies above the plane across `above`, if there is one.
struct Cap {
    Direction axis;
    double radius = pi;
    std::optional<Direction> above = {};
};

using Emit = std::function<void(const Direction&, double solidAngle)>;

/// Rings about the axis in panels that end where the plane touches a ring; each ring is whole, or
/// an arc with Gauss nodes.
class CapNodes {
public:
    CapNodes(const Cap& cap, int order, int level, const Emit& emit)
        : cap_(cap), order_(order), level_(level), emit_(emit) {
        u_ = std::abs(cap.axis.z) < 0.9 ? Direction{0, 0, 1} : Direction{1, 0, 0};
        if (cap.above) {
            height_ = std::clamp(dot(cap.axis, *cap.above), -1.0, 1.0);
            const Direction across = cross(cap.axis, *cap.above);
            slope_ = std::sqrt(dot(across, across));
            if (slope_ > 1e-9) u_ = *cap.above;
        }
        u_ = plus(u_, scaled(-dot(u_, cap.axis), cap.axis));
        u_ = scaled(1 / std::sqrt(dot(u_, u_)), u_);
        v_ = cross(cap.axis, u_);
    }

    void run() const {
        std::vector<double> ends{0, cap_.radius};
        if (cap_.above) {
            const double tilt = std::atan2(slope_, height_), touch = std::abs(pi / 2 - tilt);
            for (const double end : {touch, pi - touch})
                if (end > 1e-12 && end < cap_.radius - 1e-12) ends.push_back(end);
        }
        std::sort(ends.begin(), ends.end());
        for (std::size_t k = 0; k + 1 < ends.size(); ++k) panel(ends[k], ends[k + 1]);
    }

private:
    /// Half of the arc of a ring above the plane, about u.
    double halfArc(double chi) const {
        if (!cap_.above) return pi;
        const double across = std::sin(chi) * slope_, ahead = std::cos(chi) * height_;
        if (std::abs(ahead) >= across) return ahead > 0 ? pi : 0;
        return std::acos(std::clamp(-ahead / across, -1.0, 1.0));
    }

    void panel(double low, double high) const {
        const double middle = (low + high) / 2, half = (high - low) / 2;
        const double arc = halfArc(middle);
        if (arc <= 0) return;
        const bool whole = arc >= pi;
        const GaussRule& rule =
            gaussLegendre(grown(6 + order_ * half * (whole ? 0.8 : 1.2), level_));
        for (std::size_t r = 0; r < rule.nodes.size(); ++r) {
            // Arcs grow like a root from the ends of their panel: clustered there.
            const double t = rule.nodes[r];
            const double at = whole ? t : std::sin(pi / 2 * t);
            const double rate = whole ? 1 : pi / 2 * std::cos(pi / 2 * t);
            const double chi = middle + half * at;
            ring(chi, whole ? pi : halfArc(chi), std::sin(chi) * half * rate * rule.weights[r]);
        }
    }

    void ring(double chi, double arc, double weight) const {
        const double s = std::sin(chi), c = std::cos(chi);
        const bool whole = arc >= pi;
        const int count = grown(
            (whole ? 2 : 1.2 * arc / pi + 0.4) * order_ * std::min(1.0, s + .1) + (whole ? 8 : 6),
            level_);
        const GaussRule& rule = gaussLegendre(count);
        for (int j = 0; j < count; ++j) {
            const auto k = static_cast<std::size_t>(j);
            const double psi = arc * (whole ? (2 * j + 1.0) / count - 1 : rule.nodes[k]);
            const double share = arc * (whole ? 2.0 / count : rule.weights[k]);
            Direction d = plus(scaled(c, cap_.axis),
                               plus(scaled(s * std::cos(psi), u_), scaled(s * std::sin(psi), v_)));
            // Rings about the pole of the frame have one height, bit by bit.
            if (cap_.axis.z == 1) d.z = c;
            emit_(d, weight * share);
        }
    }

    Cap cap_;
    int order_, level_;
    const Emit& emit_;
    Direction u_, v_;
    double height_ = 1, slope_ = 0;  ///< of the axis to the plane: cosine and sine of its tilt
};

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
        const Emit emit = [&](const Direction& d, double weight) {
            nodes.add(d, radiance(d), weight);
        };
        CapNodes(cap, order, level, emit).run();
    }

    void operator()(const DiscLight& light) const {
        Cap part{.axis = frame.toLocal(light.towards), .radius = light.radius};
        if (hemisphere()) part.above = Direction{0, 0, 1};
        cap(part, [&](const Direction&) { return light.radiance; });
    }

    void operator()(const SkyLight& light) const {
        const Direction up = frame.toLocal({0, 0, 1}), down = scaled(-1, up);
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
        const bool peaked =
            light.model == SkyLight::Model::cie || light.model == SkyLight::Model::preetham;
        if (peaked && order <= ordersAboutSun)
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
