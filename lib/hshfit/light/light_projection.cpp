#include <hshfit/light/light_projection.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/bases/sh.h>
#include <hshfit/error.h>
#include <hshfit/light/coefficient_light.h>
#include <hshfit/light/internal/node_moments.h>
#include <hshfit/light/latlong_projection.h>
#include <hshfit/light/light_energy.h>
#include <hshfit/light/picture_light.h>
#include <hshfit/rotation/sh_rotation.h>
#include <hshfit/version.h>
#include <hshfit/wording.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace hshfit::inline light {
namespace {

using Moments = std::vector<double>;  ///< [R, G, B][slot]

/// Products of nodes and functions after which no further level is tried.
constexpr double mostWork = 4e9;

/// Integrals over a cap about +z of Y_{l,0}, times sqrt(4 pi / (2 l + 1)):
/// 2 pi integral of P_l from cos r to 1.
std::vector<double> zonalIntegrals(double radius, int order) {
    std::vector<double> integrals{4 * pi * std::pow(std::sin(radius / 2), 2)};
    if (order < 2) return integrals;
    const auto harmonics = bases::makeSh(order, {});
    const double half = std::sin(radius / 2);
    const Elevation<double> rim{std::cos(radius), 2 * half * half};
    std::vector<double> theta(static_cast<std::size_t>(order - 1));
    harmonics->theta(1, {&rim, 1}, theta.data());
    for (int l = 1; l < order; ++l) {
        const double bands = (2.0 * l + 1) * l * (l + 1);
        integrals.push_back(2 * pi * std::sin(radius) * theta[static_cast<std::size_t>(l - 1)] *
                            std::sqrt(2 / bands));
    }
    return integrals;
}

/// All rows of the file, some at a time where it is not in memory.
void addAllRows(const PictureLight& light, LatlongProjection& projection) {
    if (light.fileWidth == 0) return projection.addRows(light.rgb.data(), light.height);
    constexpr std::size_t together = 64;
    const PictureGeometry size = fileGeometryOf(light);
    std::vector<float> rows;
    forEachRow(light, [&](std::size_t row, std::span<const float> rgb) {
        rows.insert(rows.end(), rgb.begin(), rgb.end());
        const std::size_t count = rows.size() / rgb.size();
        if (count < together && row + 1 < size.height) return;
        projection.addRows(rows.data(), count);
        rows.clear();
    });
}

/// Exact moments over the sphere, or none.
struct ExactMoments {
    const Basis& basis;
    Moments& moments;
    std::optional<double>& energy;  ///< of this light, where the moments come with it

    bool operator()(const DiscLight& light) const {
        addZonal(light.towards, light.radiance, zonalIntegrals(light.radius, basis.order()));
        return true;
    }
    bool operator()(const PictureLight& light) const {
        if (light.layout != PictureLayout::latlong) return false;
        const PictureGeometry size = fileGeometryOf(light);
        LatlongProjection projection(basis.order(), size.width, size.height);
        addAllRows(light, projection);
        energy = projection.energy()[0] + projection.energy()[1] + projection.energy()[2];
        Moments own(moments.size());
        // A mirrored picture turns the other way before the mirror.
        const bool still = isIdentity(light.tilt);
        projection.coefficients(still ? (light.mirrored ? -light.turn : light.turn) : 0,
                                own.data());
        if (light.mirrored) exchangeSides(basis.order(), own);
        if (!still) {
            const Rotation whole = Rotation::aboutAxis({0, 0, 1}, light.turn) * light.tilt;
            ShRotation(basis.order()).rotate({&whole, 1}, 3, own.data(), own.data());
        }
        for (std::size_t c = 0; c < 3; ++c) {
            for (int l = 0; l < basis.order(); ++l) {
                for (int m = -l; m <= l; ++m) {
                    const std::size_t at = index(c, l, m);
                    moments[at] += azimuthSign(m, basis.condonShortley()) * own[at];
                }
            }
        }
        return true;
    }
    bool operator()(const DirectionalLight& light) const {
        addZonal(light.towards, light.irradiance,
                 std::vector<double>(static_cast<std::size_t>(basis.order()), 1.0));
        return true;
    }
    bool operator()(const PanelLight&) const { return false; }
    bool operator()(const SkyLight&) const { return false; }
    bool operator()(const CoefficientLight& light) const {
        if (light.coefficients->domain != LightCoefficients::Domain::sphere) return false;
        const Moments own = harmonicsOf(light, basis.order(), basis.condonShortley());
        for (std::size_t k = 0; k < own.size(); ++k) moments[k] += own[k];
        energy = 0;
        for (const double value : harmonicsOf(light, light.coefficients->order, false))
            *energy += value * value;
        return true;
    }

private:
    std::size_t index(std::size_t channel, int l, int m) const {
        return channel * static_cast<std::size_t>(basis.slots()) +
               static_cast<std::size_t>(slotOf(l, m));
    }
    void addZonal(const Direction& axis, const Rgb& radiance,
                  const std::vector<double>& integrals) const {
        std::vector<double> values(static_cast<std::size_t>(basis.slots()));
        basis.evaluate(axis, values.data());
        for (std::size_t c = 0; c < 3; ++c)
            for (int l = 0; l < basis.order(); ++l)
                for (int m = -l; m <= l; ++m)
                    moments[index(c, l, m)] += radiance[c] *
                                               integrals[static_cast<std::size_t>(l)] *
                                               values[static_cast<std::size_t>(slotOf(l, m))];
    }
};

double squares(const Moments& values) {
    double sum = 0;
    for (const double value : values) sum += value * value;
    return sum;
}

/// Adds to `work` the products of nodes and functions.
Moments momentsByNodes(const std::vector<const Light*>& lights, const Basis& basis,
                       const LightDomain& domain, int level, double& work) {
    Moments moments(3 * static_cast<std::size_t>(basis.slots()), 0.0);
    for (const Light* light : lights) {
        const LightNodes nodes = nodesOf(*light, domain, basis.order(), level);
        addNodeMoments(basis, nodes, moments);
        work += static_cast<double>(nodes.count()) * basis.slots();
    }
    return moments;
}

/// Coefficients of each channel from its moments.
Moments coefficientsOf(const Basis& basis, const Moments& moments) {
    Moments coefficients(moments.size());
    const auto slots = static_cast<std::size_t>(basis.slots());
    for (std::size_t c = 0; c < 3; ++c)
        basis.coefficientsFromMoments(moments.data() + c * slots, basis.order(),
                                      coefficients.data() + c * slots);
    return coefficients;
}

/// The relative rounding of coefficients. It grows with the order, and a Gram system enlarges it by
/// up to the root of its largest inverse eigenvalue, which the solution of moments of alternating
/// signs shows.
double roundingOf(const Basis& basis) {
    const double ofBasis = std::numeric_limits<double>::epsilon() * basis.order();
    if (bases::find(basis.name()).orthonormal) return ofBasis;
    Moments signs(3 * static_cast<std::size_t>(basis.slots()));
    for (std::size_t i = 0; i < signs.size(); ++i) signs[i] = i % 2 == 0 ? 1 : -1;
    return ofBasis * std::sqrt(squares(coefficientsOf(basis, signs)) / squares(signs));
}

struct Integrated {
    Moments moments;
    std::vector<std::optional<double>> energies;  ///< of each light by itself, where known
    double error = 0;  ///< of the coefficients, relative to the root of the sum of their squares
};

Integrated integrate(std::span<const Light> lights, const Basis& basis,
                     const LightProjectionOptions& options) {
    Integrated result{.moments = Moments(3 * static_cast<std::size_t>(basis.slots()), 0.0),
                      .energies = {}};
    std::vector<const Light*> others;
    for (const Light& light : lights) {
        result.energies.emplace_back();
        const bool exact =
            !options.domain.normal &&
            std::visit(ExactMoments{basis, result.moments, result.energies.back()}, light);
        if (!exact) others.push_back(&light);
    }
    double missed = 0;
    if (!others.empty()) {
        double work = 0;
        Moments last = momentsByNodes(others, basis, options.domain, 0, work);
        for (int level = 1; level == 1 || (level <= options.maxLevel && work < mostWork); ++level) {
            Moments next = momentsByNodes(others, basis, options.domain, level, work);
            for (std::size_t k = 0; k < next.size(); ++k) last[k] -= next[k];
            missed = squares(coefficientsOf(basis, last));
            last = std::move(next);
            const double reached = squares(coefficientsOf(basis, last));
            if (missed <= options.tolerance * options.tolerance * reached) break;
        }
        for (std::size_t k = 0; k < last.size(); ++k) result.moments[k] += last[k];
    }
    const double all = squares(coefficientsOf(basis, result.moments));
    result.error = roundingOf(basis) + (all > 0 ? std::sqrt(missed / all) : 0);
    return result;
}

LightCurve curveOf(const Basis& basis, const Moments& moments, const Energy& energy) {
    LightCurve curve{.basis = basis.name(), .points = {}};
    const auto slots = static_cast<std::size_t>(basis.slots());
    for (int order = 1; order <= basis.order(); ++order) {
        double captured = 0;
        for (std::size_t c = 0; c < 3; ++c)
            captured += basis.capturedEnergy(moments.data() + c * slots, order);
        const bool known = energy.finite && energy.value > 0;
        curve.points.push_back(
            {order, basis.functionCount(order),
             known ? captured / energy.value : std::numeric_limits<double>::quiet_NaN()});
    }
    return curve;
}

}  // namespace

LightCoefficients projectLight(std::span<const Light> lights, const Basis& basis,
                               const LightProjectionOptions& options) {
    if (lights.empty()) throw UsageError("coefficients of no light; give at least one");
    const bool sphere = !options.domain.normal;
    if (sphere && basis.name() != "sh") {
        throw UsageError(fmt::format(
            "light over the whole sphere needs the basis 'sh'; '{}' is one of the hemisphere, "
            "which needs {}",
            basis.name(), Setting{"LightDomain::normal"}));
    }
    const Integrated result = integrate(lights, basis, options);
    LightCoefficients light;
    light.basis = basis.name();
    light.order = basis.order();
    light.condonShortley = basis.condonShortley();
    if (!sphere) {
        light.domain = LightCoefficients::Domain::hemisphere;
        light.normalTheta = options.domain.normal->theta;
        light.normalPhi = options.domain.normal->phi;
    }
    light.values = coefficientsOf(basis, result.moments);
    const bool projected = basis.inner() == Basis::Inner::projectedSolidAngle;
    light.energy = lightEnergy(lights, options.domain, projected, result.energies);
    light.error = result.error;
    light.curves = {curveOf(basis, result.moments, light.energy)};
    light.generator = std::string("hshfit ") + version;
    return light;
}

std::vector<double> bandEnergies(const LightCoefficients& light) {
    std::vector<double> bands(static_cast<std::size_t>(light.order), 0.0);
    for (std::size_t c = 0; c < light.channels.count(); ++c) {
        for (int l = 0; l < light.order; ++l) {
            for (int m = -l; m <= l; ++m) {
                const double value = light.at(c)[slotOf(l, m)];
                bands[static_cast<std::size_t>(l)] += value * value;
            }
        }
    }
    return bands;
}

}  // namespace hshfit::inline light
