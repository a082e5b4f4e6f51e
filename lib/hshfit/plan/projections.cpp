#include <hshfit/plan/projections.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/representation/basis_matrix.h>
#include <hshfit/representation/halfway.h>

#include <fmt/format.h>

#include <algorithm>

namespace hshfit::plan {
namespace {

/// Of f, per direction, before a projection gives up: this is only a search.
constexpr std::size_t mostEvaluations = std::size_t{1} << 22;

/// Bands of a matrix of both directions that are projected at once: costs grow with the fourth
/// power of the order where BRDFs are not isotropic.
int stepUp(int order, int highest) {
    for (int step : {4, 6, 8}) {
        if (order <= step) return std::min(step, highest);
    }
    return highest;
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

std::vector<Coefficients> KeptProjections::allBases(const OutgoingSet& set, Quantity quantity) {
    std::vector<std::unique_ptr<Basis>> made;
    std::vector<const Basis*> pointers;
    for (const std::string& name : ladder_.bases) {
        made.push_back(bases::make(name, highestOrder(name)));
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
            for (Coefficients& each : allBases(outgoingOf(form), form.quantity)) {
                std::string name = each.basis;
                kept.emplace(std::move(name), std::move(each));
            }
        });
    }
    const Coefficients& whole = kept.at(form.basis);
    if (whole.order == form.order) return whole;
    Coefficients cut = whole;
    cut.order = form.order;
    cut.values.clear();
    const std::size_t rows = whole.values.size() / whole.slots();
    for (std::size_t row = 0; row < rows; ++row) {
        const auto from = whole.values.begin() + static_cast<std::ptrdiff_t>(row * whole.slots());
        cut.values.insert(cut.values.end(), from, from + static_cast<std::ptrdiff_t>(cut.slots()));
    }
    return cut;
}

Representation KeptProjections::both(const Form& form) {
    const int order = stepUp(form.order, highestOrder(form.basis));
    const std::string key =
        fmt::format("{} {} {} {}", form.basis, order, quantityName(form.quantity), form.reciprocal);
    auto found = both_.find(key);
    if (found == both_.end()) {
        once(key, [&] {
            found = both_
                        .emplace(key, projectBoth(brdf_, *bases::make(form.basis, order),
                                                  form.reciprocal, optionsFor(form.quantity)))
                        .first;
        });
    }
    return form.order == order ? found->second : truncated(found->second, form.order);
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
