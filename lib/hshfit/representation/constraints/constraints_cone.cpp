#include <hshfit/representation/constraints/constraints_cone.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/linear_algebra/descend.h>
#include <hshfit/representation/constraints/internal/constraints_least_change.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace hshfit::inline representation::inline constraints {
namespace {

void clearSines(int order, double* slots) {
    for (int l = 1; l < order; ++l) {
        for (int m = 1; m <= l; ++m) slots[slotOf(l, -m)] = 0;
    }
}

double product(const std::vector<double>& a, const double* b) {
    return std::inner_product(a.begin(), a.end(), b, 0.0);
}

}  // namespace

void requireNearlySettled(const Basis& basis, int rounds, double least) {
    if (least >= -nonNegativeTolerance) return;
    throw NumericError(fmt::format(
        "non-negative coefficients in {} of order {} were not found in {} rounds: {:.0e} of the "
        "root mean square was left below 0; lower the order",
        basis.name(), basis.order(), rounds, -least));
}

bool withoutSines(const std::vector<int>& slots) {
    return std::ranges::all_of(slots, [](int slot) {
        const int l = static_cast<int>(std::sqrt(slot + 0.5));
        return slot >= l * (l + 1);
    });
}

NonNegativeCone::NonNegativeCone(const Basis& basis, bool even, bool sure, int mostRounds)
    : basis_(basis),
      even_(even),
      sure_(sure),
      mostRounds_(mostRounds),
      coarse_(basis, even),
      fine_(basis, even, HemisphereScan::fine) {
    if (bases::find(basis.name()).orthonormal) return;
    gram_ = std::make_unique<HemisphereGram>(basis);
    if (gram_->condition() > 1e9) {
        throw UsageError(
            fmt::format("{} of order {} has a condition of {:.0e}: too much for constraints; lower "
                        "the order",
                        basis.name(), basis.order(), gram_->condition()));
    }
}

/// The functional that takes the value at wi, for whitened coefficients.
std::vector<double> NonNegativeCone::row(const Direction& wi) const {
    std::vector<double> values(static_cast<std::size_t>(basis_.slots()));
    basis_.evaluate(wi, values.data());
    if (even_) clearSines(basis_.order(), values.data());
    if (gram_) gram_->whitenFunctional(values.data());
    return values;
}

std::vector<NonNegativeCone::Minimum> NonNegativeCone::minima(const std::vector<double>& c,
                                                              const Added& added, double scale,
                                                              bool thorough) const {
    const HemisphereScan& scan = thorough ? fine_ : coarse_;
    std::vector<double> values(scan.size()), at(c.size());
    scan.synthesise(c.data(), values.data());
    if (added) {
        for (std::size_t k = 0; k < values.size(); ++k) {
            values[k] += added(directionFromAngles(scan.polar(k), scan.azimuth(k)));
        }
    }
    const auto valueAt = [&](const Direction& wi) {
        basis_.evaluate(wi, at.data());
        return product(c, at.data()) + (added ? added(wi) : 0);
    };
    std::vector<Minimum> found;
    const double threshold = (thorough ? 0.03 : 0.1) * scale;
    for (const std::size_t node : scan.minima(values.data(), threshold, thorough)) {
        const auto [along, across] = scan.axesAt(node);
        std::vector<double> x{0, 0};
        const double least = descend(
            [&](const std::vector<double>& to) { return valueAt(scan.offset(node, to[0], to[1])); },
            x, {along, across});
        found.push_back({scan.offset(node, x[0], x[1]), least});
    }
    return found;
}

std::vector<double> NonNegativeCone::nearest(const double* c, const Added& added,
                                             const Limit* limit) const {
    std::vector<double> result(c, c + basis_.slots());
    std::vector<double> start = result;
    if (gram_) gram_->whiten(start.data());
    const double norm = std::sqrt(product(start, start.data())), scale = norm / std::sqrt(2 * pi);
    if (norm == 0) return result;
    LeastChange program(std::move(start));
    if (limit) {
        std::vector<double> functional = limit->functional;
        if (gram_) gram_->whitenFunctional(functional.data());
        for (double& each : functional) each = -each;
        program.add(functional, -limit->most);
    }
    const auto solve = [&] {
        program.solve(1e-12 * norm);
        result = program.x();
        if (gram_) gram_->unwhiten(result.data());
    };
    if (limit) solve();
    double lift = 0;
    bool thorough = false, settled = false;
    for (int round = 0; !settled && round < mostRounds_; ++round) {
        bool negative = false;
        lift = 0;
        for (const Minimum& each : minima(result, added, scale, thorough)) {
            if (each.value >= 0) continue;
            std::vector<double> first(static_cast<std::size_t>(basis_.slots()));
            basis_.evaluate(each.wi, first.data());
            // In units of band 0, which for some bases falls to 0 at the horizon.
            lift = std::max(lift, -each.value / first[0]);
            if (-each.value < 0.01 * nonNegativeTolerance * norm * first[0]) continue;
            negative = true;
            program.add(row(each.wi), added ? -added(each.wi) : 0);
        }
        if (negative) solve();
        settled = !negative && (thorough || !sure_);
        thorough = thorough || !negative;
    }
    result[0] += lift;
    if (!settled) {
        double least = -lift / std::sqrt(2 * pi);
        for (const Minimum& each : minima(result, added, scale, sure_))
            least = std::min(least, each.value);
        requireNearlySettled(basis_, mostRounds_, least / scale);
    }
    if (limit) {
        const double sum = product(limit->functional, result.data());
        if (sum > limit->most && sum > 0) {
            for (double& each : result) each *= std::max(limit->most, 0.0) / sum;
        }
    }
    return result;
}

}  // namespace hshfit::inline representation::inline constraints
