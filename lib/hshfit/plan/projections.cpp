#include <hshfit/plan/internal/projections.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/quadrature/quadrature.h>
#include <hshfit/representation/basis_matrix.h>
#include <hshfit/representation/halfway/halfway.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hshfit::plan {
namespace {

/// The limit of evaluations of f per direction, which is low because this is only a search.
constexpr std::size_t mostEvaluations = std::size_t{1} << 22;

/// Order of the matrices of BRDFs that are not isotropic, whose terms grow with its fourth power.
constexpr int anisotropicOrder = 8;
/// Outgoing directions below this cosine are left out: they are a thousandth of the hemisphere,
/// and lobes are narrowest there.
constexpr double leastCosine = 1e-3;

/// Gauss-Legendre in sqrt(cos theta_o) by equispaced azimuths, for products of `order` bands.
OutgoingSet outerNodes(int order, bool isotropic) {
    const GaussRule& rule = gaussLegendre(2 * order + 6);
    const int azimuths = isotropic ? 1 : 4 * (order / 2 + 2);
    OutgoingSet set{.map = OutgoingSet::Map::parabolic, .directions = {}, .solidAngles = {}};
    for (std::size_t r = 0; r < rule.nodes.size(); ++r) {
        const double u = (1 + rule.nodes[r]) / 2, mu = u * u;
        if (mu < leastCosine) continue;
        for (int j = 0; j < azimuths; ++j) {
            const double phi = isotropic ? 0 : (j + 0.5) * 2 * pi / azimuths;
            set.directions.push_back(directionFromAngles(std::acos(mu), phi));
            set.solidAngles.push_back(rule.weights[r] * u * 2 * pi / azimuths);
        }
    }
    set.width = static_cast<int>(set.directions.size());
    return set;
}

/// The matrix whose coefficients over wi at the nodes over wo are these.
Representation gathered(const Coefficients& c, const Basis& basis, bool reciprocal) {
    Representation result;
    result.head = c;
    result.head.outgoing = {};
    result.head.reciprocal = reciprocal;
    const ProductSymmetry symmetry = symmetryOf(result);
    const std::vector<ProductTerm> terms = productTerms(basis, symmetry);
    const std::size_t channels = c.channels.count();
    StoredArray matrix{.shape = {channels, terms.size()}, .values = {}};
    matrix.values.assign(channels * terms.size(), 0.0);
    std::vector<double> atWo(c.slots()), products(terms.size());
    for (std::size_t o = 0; o < c.outgoing.size(); ++o) {
        const Direction& wo = c.outgoing.directions[o];
        basis.evaluate(wo, atWo.data());
        const bool flux = basis.inner() == Basis::Inner::projectedSolidAngle;
        const double weight = c.outgoing.solidAngles[o] * (flux ? wo.z : 1);
        for (std::size_t channel = 0; channel < channels; ++channel) {
            evaluateProducts(terms, symmetry, c.at(o, channel), atWo.data(), products.data());
            for (std::size_t t = 0; t < terms.size(); ++t) {
                matrix.values[channel * terms.size() + t] += weight * products[t];
            }
        }
    }
    result.content = MatrixArray{std::move(matrix)};
    return result;
}

}  // namespace

KeptProjections::KeptProjections(const Brdf& brdf, const LadderOptions& ladder, double tolerance)
    : brdf_(brdf), ladder_(ladder), tolerance_(tolerance) {}
KeptProjections::~KeptProjections() = default;

ProjectionOptions KeptProjections::optionsFor(Quantity quantity) const {
    return {.quantity = quantity,
            .tolerance = std::max(tolerance_, brdf_.defaultTolerance()),
            .maxEvaluations = mostEvaluations};
}

int KeptProjections::highestOrder(const std::string& basis) const {
    return std::min(ladder_.maxOrder, bases::find(basis).maxOrder);
}

void KeptProjections::once(const std::string& key, const std::function<void()>& make) {
    if (const auto found = failed_.find(key); found != failed_.end()) {
        throw NumericError(found->second);
    }
    try {
        make();
    } catch (const NumericError& error) {
        failed_.emplace(key, error.what());
        throw;
    }
}

std::vector<Coefficients> KeptProjections::allBases(const OutgoingSet& set, Quantity quantity,
                                                    int order) {
    std::vector<std::unique_ptr<Basis>> made;
    std::vector<const Basis*> pointers;
    for (const std::string& name : ladder_.bases) {
        const int highest = highestOrder(name);
        made.push_back(bases::make(name, order > 0 ? std::min(order, highest) : highest));
        pointers.push_back(made.back().get());
    }
    std::vector<Coefficients> result;
    for (Projection& each : project(brdf_, pointers, set, optionsFor(quantity))) {
        result.push_back(std::move(each.coefficients));
    }
    return result;
}

Coefficients KeptProjections::outgoing(const Form& form) {
    const std::string key = quantityName(form.quantity) + " " + form.outgoing;
    auto& kept = outgoing_[key];
    if (kept.empty()) {
        once(key, [&] {
            for (Coefficients& each : allBases(outgoingOf(form, brdf_.laws()), form.quantity)) {
                std::string name = each.basis;
                kept.emplace(std::move(name), std::move(each));
            }
        });
    }
    return truncated(kept.at(form.basis), form.order);
}

Representation KeptProjections::both(const Form& form) {
    const bool isotropic = brdf_.laws().isotropic;
    const int highest = std::min(ladder_.maxOrder, isotropic ? ladder_.maxOrder : anisotropicOrder);
    const std::string quantity = quantityName(form.quantity);
    const std::string key = fmt::format("{} {} {}", form.basis, quantity, form.reciprocal);
    auto& rows = outer_[quantity];
    if (rows.empty()) {
        once("both " + quantity,
             [&] { rows = allBases(outerNodes(highest, isotropic), form.quantity, highest); });
    }
    auto found = both_.find(key);
    if (found == both_.end()) {
        const auto row = std::find_if(rows.begin(), rows.end(), [&](const Coefficients& each) {
            return each.basis == form.basis;
        });
        found =
            both_
                .emplace(key, gathered(*row, *bases::make(row->basis, row->order), form.reciprocal))
                .first;
    }
    return form.order == found->second.head.order ? found->second
                                                  : truncated(found->second, form.order);
}

Representation KeptProjections::halfway(const Form& form) {
    const std::string key = fmt::format("{} {} {} {}", form.halfway.half, form.halfway.difference,
                                        form.halfway.azimuth, form.reciprocal);
    auto found = halfway_.find(key);
    if (found == halfway_.end()) {
        once("halfway " + key, [&] {
            found = halfway_.emplace(key, projectHalfway(brdf_, form.halfway, {}, form.reciprocal))
                        .first;
        });
    }
    return found->second;
}

}  // namespace hshfit::plan
