#pragma once

#include <hshfit/bases/catalog.h>
#include <hshfit/projection/projection.h>
#include <hshfit/quadrature/quadrature.h>
#include <hshfit/representation/basis_matrix.h>
#include <hshfit/representation/forms/represented_brdf.h>
#include <lib/formula_brdf.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

namespace hshfit::test {

/// f of one exponent about the half vector over a diffuse part, symmetric in wi and wo.
inline FormulaBrdf glossy(double exponent, double diffuse = 0.1) {
    return FormulaBrdf(
        [=](const Direction& wi, const Direction& wo) {
            if (!(wi.z > 0 && wo.z > 0)) return 0.0;
            const double x = wi.x + wo.x, y = wi.y + wo.y, z = wi.z + wo.z;
            const double cosine = z / std::sqrt(x * x + y * y + z * z);
            return diffuse / pi + (exponent + 2) / (8 * pi) * std::pow(cosine, exponent);
        },
        {}, {.nonNegative = true, .reciprocal = true, .isotropic = true, .mirrorSymmetric = true});
}

/// An anisotropic lobe, wider along x than along y.
inline FormulaBrdf brushed() {
    return FormulaBrdf(
        [](const Direction& wi, const Direction& wo) {
            if (!(wi.z > 0 && wo.z > 0)) return 0.0;
            const double z = wi.z + wo.z, x = (wi.x + wo.x) / z, y = (wi.y + wo.y) / z;
            return 0.05 + 0.6 * std::exp(-x * x / 0.5 - y * y / 0.08);
        },
        {}, {.nonNegative = true, .reciprocal = true, .isotropic = false, .mirrorSymmetric = true});
}

/// Nodes over the hemisphere for products of two sums over a basis, independent of the
/// library's weights; each has the weight of the requested inner product.
struct HemisphereNodes {
    std::vector<double> x, y, z, weights;

    explicit HemisphereNodes(Basis::Inner inner, int rings = 48, int azimuths = 48) {
        const GaussRule& rule = gaussLegendre(rings);
        for (int r = 0; r < rings; ++r) {
            const double u = (1 + rule.nodes[r]) / 2, mu = u * u;
            double weight = rule.weights[r] * u * 2 * pi / azimuths;
            if (inner == Basis::Inner::projectedSolidAngle) weight *= mu;
            for (int j = 0; j < azimuths; ++j) {
                const double phi = (j + 0.3) * 2 * pi / azimuths;
                x.push_back(std::sqrt(1 - mu * mu) * std::cos(phi));
                y.push_back(std::sqrt(1 - mu * mu) * std::sin(phi));
                z.push_back(mu);
                weights.push_back(weight);
            }
        }
    }
    DirectionBatch batch() const { return {x.data(), y.data(), z.data(), x.size()}; }
    Direction at(std::size_t k) const { return {x[k], y[k], z[k]}; }
    std::size_t size() const { return x.size(); }
};

inline std::unique_ptr<Brdf> opensNothing(const std::string&) {
    return nullptr;
}

/// |b - a| / |a| in L2 over both hemispheres, from values of the reconstructions (of f).
inline double measuredChange(const Representation& a, const Representation& b) {
    const auto basis =
        bases::make(a.head.basis, a.head.order, {.condonShortley = a.head.condonShortley});
    const HemisphereNodes nodes(basis->inner());
    std::vector<Direction> outgoing = a.head.outgoing.directions;
    std::vector<double> weights = a.head.outgoing.solidAngles;
    if (a.kind() == Representation::Kind::basis) {
        const HemisphereNodes both(basis->inner(), 20, a.head.isotropic ? 1 : 20);
        outgoing.clear();
        weights = both.weights;
        for (std::size_t k = 0; k < both.size(); ++k) outgoing.push_back(both.at(k));
    }
    const auto first = reconstruct(a, opensNothing), second = reconstruct(b, opensNothing);
    const std::size_t count = nodes.size() * first->channels().count();
    std::vector<double> before(count), after(count);
    double change = 0, norm = 0;
    for (std::size_t o = 0; o < outgoing.size(); ++o) {
        if (weights[o] == 0) continue;
        first->eval(outgoing[o], nodes.batch(), before.data());
        second->eval(outgoing[o], nodes.batch(), after.data());
        for (std::size_t i = 0; i < count; ++i) {
            const double weight = weights[o] * nodes.weights[i % nodes.size()];
            change += weight * std::pow(after[i] - before[i], 2);
            norm += weight * before[i] * before[i];
        }
    }
    return std::sqrt(change / norm);
}

inline std::unique_ptr<Basis> basisOf(const bases::Entry& entry, int order) {
    return bases::make(entry.name, std::min(order, entry.maxOrder));
}

inline Representation perOutgoing(const Brdf& brdf, const Basis& basis, const OutgoingSet& set,
                                  Quantity quantity = Quantity::brdf) {
    const Basis* const one[] = {&basis};
    return fromCoefficients(
        project(brdf, one, set, {.quantity = quantity, .tolerance = 1e-6})[0].coefficients);
}

inline Representation bothIn(const Brdf& brdf, const Basis& basis, bool reciprocal) {
    return projectBoth(brdf, basis, reciprocal, {.tolerance = 1e-2});
}

/// Uniform over the hemisphere.
inline Direction randomDirection(std::mt19937& random) {
    std::uniform_real_distribution<double> uniform(0, 1);
    const double z = uniform(random), phi = 2 * pi * uniform(random);
    return {std::sqrt(1 - z * z) * std::cos(phi), std::sqrt(1 - z * z) * std::sin(phi), z};
}

}  // namespace hshfit::test
