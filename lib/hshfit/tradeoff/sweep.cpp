#include <hshfit/tradeoff/sweep.h>

#include <hshfit/error.h>
#include <hshfit/representation/halfway/halfway_terms.h>
#include <hshfit/spelling.h>

#include <fmt/format.h>

#include <array>
#include <set>

namespace hshfit::tradeoff {
namespace {

using Kind = Representation::Kind;

constexpr std::array constraintNames{"none", "non-negative", "energy-preserving", "both"};

/// The forms that are projected: one for each projection and order.
std::vector<Form> projectedForms(const Sweep& sweep, const Brdf& brdf) {
    const std::vector<std::string> sets = outgoingSets(sweep, brdf);
    std::vector<Form> forms;
    const auto addBases = [&](const Form& form) {
        for (const std::string& basis : sweep.bases) {
            for (const int order : sweep.orders) {
                forms.push_back(form);
                forms.back().basis = basis;
                forms.back().order = order;
            }
        }
    };
    for (const Kind kind : sweep.kinds) {
        Form form;
        form.kind = kind;
        form.quantity = sweep.quantity;
        if (kind == Kind::outgoing) {
            for (const std::string& set : sets) {
                form.outgoing = set;
                addBases(form);
            }
        } else if (kind == Kind::basis) {
            addBases(form);
            form.reciprocal = true;
            if (sweep.reciprocal) addBases(form);
        } else {
            for (const HalfwayOrders& orders : sweep.halfway) {
                const Laws laws = brdf.laws();
                form.halfway = halfwayOrdersOr(orders, laws.isotropic, laws.reciprocal);
                forms.push_back(form);
                if (!sweep.reciprocal || laws.reciprocal) continue;
                form.halfway = halfwayOrdersOr(orders, laws.isotropic, true);
                forms.push_back(form);
                forms.back().reciprocal = true;
            }
        }
    }
    return forms;
}

bool isConsistent(const Form& form, const Laws& laws) {
    try {
        requireConsistent(form, laws);
        return true;
    } catch (const UsageError&) {
        return false;
    }
}

bool isNonNegative(Constraint constraint) {
    return constraint == Constraint::nonNegative || constraint == Constraint::both;
}

bool isEnergyPreserving(Constraint constraint) {
    return constraint == Constraint::energyPreserving || constraint == Constraint::both;
}

/// Whether factors of this rank can be smaller than what they multiply to.
bool makesLess(const Form& form) {
    return form.rank == 0 || form.rank < form.order * form.order;
}

}  // namespace

Constraint parseConstraint(std::string_view name) {
    for (std::size_t k = 0; k < constraintNames.size(); ++k) {
        if (constraintNames[k] == name) return static_cast<Constraint>(k);
    }
    throw spelling::unknown("constraint", name, constraintNames);
}

std::vector<std::string> outgoingSets(const Sweep& sweep, const Brdf& brdf) {
    if (!sweep.outgoing.empty()) return sweep.outgoing;
    if (brdf.laws().isotropic) return {"8", "16", "32"};
    return {"8x8", "16x16"};
}

std::vector<Form> formsOf(const Sweep& sweep, const Brdf& brdf) {
    std::vector<Form> forms = projectedForms(sweep, brdf);
    /// Every form with each of the values that `set` puts into it.
    const auto multiply = [&](const auto& values, auto set) {
        std::vector<Form> more;
        for (const Form& form : forms) {
            for (const auto& value : values) {
                more.push_back(form);
                set(more.back(), value);
            }
        }
        forms = std::move(more);
    };
    multiply(sweep.splits, [](Form& form, const std::string& split) { form.split = split; });
    multiply(sweep.windows, [](Form& form, Window window) { form.window = window; });
    multiply(sweep.constraints, [](Form& form, Constraint constraint) {
        form.nonNegative = isNonNegative(constraint);
        form.energyPreserving = isEnergyPreserving(constraint);
    });
    multiply(sweep.ranks, [](Form& form, int rank) { form.rank = rank; });
    multiply(sweep.keep, [](Form& form, std::size_t keep) { form.keep = keep; });
    multiply(sweep.precisions, [](Form& form, Precision precision) { form.precision = precision; });

    std::vector<Form> consistent;
    std::set<std::string> seen;
    for (const Form& form : forms) {
        if (!makesLess(form) || !isConsistent(form, brdf.laws())) continue;
        if (seen.insert(optionsOf(form)).second) consistent.push_back(form);
    }
    return consistent;
}

}  // namespace hshfit::tradeoff
