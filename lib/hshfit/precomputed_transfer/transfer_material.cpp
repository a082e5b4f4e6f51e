#include <hshfit/precomputed_transfer/transfer_material.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/brdf/steps.h>
#include <hshfit/brdf/vectors.h>
#include <hshfit/error.h>
#include <hshfit/projection/albedo.h>
#include <hshfit/projection/projection.h>
#include <hshfit/quadrature/quadrature.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace hshfit::inline precomputed_transfer {
namespace {

/// f where it is the same for all pairs of a lattice of directions.
std::optional<std::vector<double>> constantOf(const Brdf& brdf) {
    std::optional<std::vector<double>> first;
    for (int o = 0; o < 6; ++o) {
        const Direction wo = directionFromAngles(radians(5 + 16 * o), radians(67 * o));
        for (int i = 0; i < 12; ++i) {
            const Direction wi = directionFromAngles(radians(3 + 7.6 * i), radians(101 * i));
            const std::vector<double> f = evaluate(brdf, wi, wo);
            if (!first) first = f;
            for (std::size_t c = 0; c < f.size(); ++c)
                if (!(std::abs(f[c] - (*first)[c]) <= 1e-9 * std::abs((*first)[c]))) return {};
        }
    }
    return first;
}

/// The integral of the directional albedo times 2 mu d mu, by Gauss-Legendre between the heights at
/// which f has kinks over wo. Patches of tables are at most 24 on a ring.
std::vector<double> meanAlbedo(const Brdf& brdf) {
    const Direction normal{0, 0, 1};
    const bool patches = !outgoingKinkCurvesOf(brdf, normal).empty() || squareLevelsOf(brdf) > 0;
    const int azimuths = brdf.laws().isotropic ? 1 : patches ? 48 : 8;
    std::vector<double> ends = {0, 1};
    if (dynamic_cast<const HasSteps*>(&brdf))
        for (const double height : outgoingKinksOf(brdf, normal)) ends.push_back(height);
    std::ranges::sort(ends);
    const GaussRule& rule = gaussLegendre(ends.size() > 2 ? 3 : 10);
    std::vector<double> mean(brdf.channels().count());
    for (std::size_t e = 0; e + 1 < ends.size(); ++e) {
        const double width = ends[e + 1] - ends[e];
        for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
            const double mu = ends[e] + width * (1 + rule.nodes[k]) / 2;
            for (int a = 0; a < azimuths; ++a) {
                const Direction wo =
                    directionFromAngles(std::acos(mu), 2 * pi * (a + 0.5) / azimuths);
                const std::vector<double> albedo = directionalAlbedo(brdf, wo);
                for (std::size_t c = 0; c < mean.size(); ++c)
                    mean[c] += width * rule.weights[k] * mu * albedo[c] / azimuths;
            }
        }
    }
    return mean;
}

}  // namespace

TransferMaterial transferMaterial(const std::string& name, const Brdf& brdf, int localOrder) {
    if (brdf.channels().kind == Channels::Kind::spectral)
        throw UsageError(fmt::format("material '{}' has spectra; scenes take grey and RGB", name));
    TransferMaterial material{.name = name, .source = brdf.name()};
    const auto constant = constantOf(brdf);
    material.diffuse = constant.has_value();
    std::vector<double> albedo = constant ? *constant : meanAlbedo(brdf);
    for (std::size_t c = 0; c < 3; ++c)
        material.albedo[c] = albedo[albedo.size() == 1 ? 0 : c] * (constant ? pi : 1);
    if (material.diffuse || localOrder == 0) return material;
    const auto basis = bases::make("hsh", localOrder);
    const Basis* const all[] = {basis.get()};
    ProjectionOptions options;
    options.quantity = Quantity::brdfCosine;
    // Far finer than a few bands; narrow lobes need not be resolved further.
    options.tolerance = 1e-4;
    const OutgoingSet outgoing = brdf.laws().isotropic
                                     ? OutgoingSet::elevations(responseElevations)
                                     : OutgoingSet::parabolic(responseSide, responseSide);
    material.response = project(brdf, all, outgoing, options)[0].coefficients;
    return material;
}

void TransferMaterial::towards(const Direction& wo, std::span<double> out) const {
    std::ranges::fill(out, 0.0);
    const bool above = wo.z > 0;
    const OutgoingLookup place =
        lookUp(response->outgoing, above ? wo : normalised({wo.x, wo.y, 0}));
    const std::size_t slots = response->slots(), channels = response->channels.count();
    for (std::size_t c = 0; c < 3; ++c) {
        double* to = out.data() + c * slots;
        for (int k = 0; k < place.count; ++k) {
            const auto index = static_cast<std::size_t>(k);
            const double* from = response->at(place.index[index], channels == 1 ? 0 : c);
            for (std::size_t j = 0; j < slots; ++j) to[j] += place.weight[index] * from[j];
        }
        for (int m = 1; m < response->order; ++m) {
            const double cosine = std::cos(m * place.turn), sine = std::sin(m * place.turn);
            for (int l = m; l < response->order; ++l) {
                double &even = to[slotOf(l, m)], &odd = to[slotOf(l, -m)];
                const double a = even, b = odd;
                even = a * cosine - b * sine;
                odd = a * sine + b * cosine;
            }
        }
    }
}

}  // namespace hshfit::inline precomputed_transfer
