#include <hshfit/representation/forms/form.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/projection/one_basis.h>
#include <hshfit/representation/basis_matrix.h>
#include <hshfit/representation/change.h>
#include <hshfit/representation/constraints/constraints.h>
#include <hshfit/representation/factoring/factoring.h>
#include <hshfit/representation/halfway/halfway.h>
#include <hshfit/representation/halfway/halfway_rounding.h>
#include <hshfit/representation/named_arrays.h>
#include <hshfit/representation/split.h>
#include <hshfit/spelling.h>

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>

namespace hshfit::inline representation::inline forms {
namespace {

using Kind = Representation::Kind;

constexpr std::array kindNames{"outgoing", "basis", "halfway"};

class Projecting final : public ProjectionSource {
public:
    Projecting(const Brdf& brdf, const ProjectionOptions& options)
        : brdf_(brdf), options_(options) {}

    Coefficients outgoing(const Form& form) override {
        const auto basis = basisOf(form);
        const OutgoingSet set = outgoingOf(form, brdf_.laws());
        return project(brdf_, *basis, set, optionsFor(form)).coefficients;
    }
    Representation both(const Form& form) override {
        return projectBoth(brdf_, *basisOf(form), form.reciprocal, optionsFor(form));
    }
    Representation halfway(const Form& form) override {
        return projectHalfway(brdf_, form.halfway, optionsFor(form), form.reciprocal);
    }
    const Brdf& remainder() const override { return brdf_; }

private:
    static std::unique_ptr<Basis> basisOf(const Form& form) {
        return bases::make(form.basis, form.order, {.condonShortley = form.condonShortley});
    }
    ProjectionOptions optionsFor(const Form& form) const {
        ProjectionOptions options = options_;
        options.quantity = form.quantity;
        return options;
    }

    const Brdf& brdf_;
    ProjectionOptions options_;
};

Representation projected(ProjectionSource& source, const Form& form) {
    switch (form.kind) {
        case Kind::outgoing:
            return fromCoefficients(source.outgoing(form));
        case Kind::basis:
            return source.both(form);
        case Kind::halfway:
            break;
    }
    return source.halfway(form);
}

/// Weights of stored values in the norm of `relativeChange`, where they stand one for one.
std::vector<double> valueWeights(const Representation& representation) {
    const auto* content = representation.as<CoefficientArray>();
    if (!content) return {};
    const CoefficientHead& head = representation.head;
    const std::size_t count = content->coefficients.values.size();
    const std::size_t perDirection = count / head.outgoing.size();
    std::vector<double> weights(count);
    for (std::size_t i = 0; i < weights.size(); ++i) {
        weights[i] = std::sqrt(head.outgoing.solidAngles[i / perDirection]);
    }
    return weights;
}

void keep(Representation& representation, std::size_t count) {
    const Representation before = representation;
    const std::vector<double> weights = valueWeights(before);
    for (const auto& each : namedArrays(representation)) keepLargest(*each.array, count, weights);
    addStep(representation, before, fmt::format("keep {}", count));
}

void quantise(Representation& representation, Precision precision, const Brdf& source) {
    const Representation before = representation;
    if (representation.kind() == Kind::halfway) {
        quantiseHalfway(representation, precision, source);
    } else {
        for (const auto& each : namedArrays(representation)) {
            quantise(*each.array, precision, each.name);
        }
    }
    if (precision == Precision::float64) return;
    addStep(representation, before, std::string(precisionName(precision)));
}

/// Holds options to the form halfway: it keeps f and is not linear in its coefficients.
void requireConsistentHalfway(const Form& form, const Laws& laws) {
    const Setting halfway{"Form::kind", std::string(kindName(Kind::halfway))};
    if (form.quantity == Quantity::brdfCosine) {
        throw UsageError(
            fmt::format("{} keeps f: no {}", halfway, Setting{"Form::quantity", "brdf_cosine"}));
    }
    if (form.window != Window::none || form.rank > 0 || form.rankError > 0 || form.nonNegative ||
        form.energyPreserving) {
        throw UsageError(fmt::format("{}, {}, {} and {} are for linear forms, not for {}",
                                     Setting{"Form::window"}, Setting{"Form::rank"},
                                     Setting{"Form::nonNegative"},
                                     Setting{"Form::energyPreserving"}, halfway));
    }
    if (!form.split.empty() && !laws.nonNegative) {
        throw UsageError(fmt::format("{} with {} needs a remainder that is nowhere negative",
                                     Setting{"Form::split"}, halfway));
    }
}

}  // namespace

Representation::Kind parseKind(std::string_view name) {
    for (std::size_t k = 0; k < kindNames.size(); ++k) {
        if (kindNames[k] == name) return static_cast<Kind>(k);
    }
    throw spelling::unknown("form", name, kindNames);
}

HalfwayOrders parseHalfway(std::string_view text) {
    HalfwayOrders orders;
    std::array<int*, 3> parts{&orders.half, &orders.difference, &orders.azimuth};
    const char *at = text.data(), *end = at + text.size();
    for (std::size_t k = 0; k < parts.size(); ++k) {
        if (k > 0 && (at == end || *at++ != ',')) at = nullptr;
        const auto read = at ? std::from_chars(at, end, *parts[k]) : std::from_chars_result{};
        const bool good = at && read.ec == std::errc() && *parts[k] >= 1 && *parts[k] <= 256;
        if (!good || (k == 2 && read.ptr != end)) {
            throw UsageError(
                fmt::format("{} '{}': give three numbers of functions from 1 to 256, as 9,8,6",
                            Setting{"Form::halfway"}, text));
        }
        at = read.ptr;
    }
    return orders;
}

std::vector<Setting> settingsOf(const Form& form) {
    std::vector<Setting> out;
    const auto add = [&](bool given, std::string_view member, std::string value = {}) {
        if (given) out.push_back({member, std::move(value)});
    };
    const bool halfway = form.kind == Kind::halfway;
    add(form.kind != Kind::outgoing, "Form::kind", std::string(kindName(form.kind)));
    add(!halfway, "Form::basis", form.basis);
    add(!halfway, "Form::order", fmt::format("{}", form.order));
    add(halfway && form.halfway.half != 0, "Form::halfway",
        fmt::format("{},{},{}", form.halfway.half, form.halfway.difference, form.halfway.azimuth));
    add(form.quantity == Quantity::brdfCosine, "Form::quantity", quantityName(form.quantity));
    add(form.condonShortley, "Form::condonShortley");
    add(!form.outgoing.empty(), "Form::outgoing", form.outgoing);
    add(form.reciprocal, "Form::reciprocal");
    add(!form.split.empty(), "Form::split", form.split);
    add(form.window != Window::none, "Form::window", std::string(windowName(form.window)));
    add(form.nonNegative, "Form::nonNegative");
    add(form.energyPreserving, "Form::energyPreserving");
    add(form.rank > 0, "Form::rank", fmt::format("{}", form.rank));
    add(form.rankError > 0, "Form::rankError", fmt::format("{}", form.rankError));
    add(form.nonNegativeFactors, "Form::nonNegativeFactors");
    add(form.keep > 0, "Form::keep", fmt::format("{}", form.keep));
    add(true, "Form::precision", std::string(precisionName(form.precision)));
    return out;
}

std::string optionsOf(const Form& form) {
    return fmt::format("{}", fmt::join(settingsOf(form), " "));
}

OutgoingSet outgoingOf(const Form& form, const Laws& laws) {
    if (!form.outgoing.empty()) return OutgoingSet::parse(form.outgoing);
    return laws.isotropic ? OutgoingSet::elevations(32) : OutgoingSet::parabolic(32, 32);
}

void requireConsistent(const Form& form, const Laws& laws) {
    const Setting reciprocal{"Form::reciprocal"}, outgoing{"Form::outgoing"},
        cosine{"Form::quantity", "brdf_cosine"}, rank{"Form::rank"},
        factors{"Form::nonNegativeFactors"};
    const auto kind = [](Kind k) { return Setting{"Form::kind", std::string(kindName(k))}; };
    if (form.kind != Kind::outgoing && !form.outgoing.empty()) {
        throw UsageError(fmt::format("{} belongs to {}: the other forms need no set of directions",
                                     outgoing, kind(Kind::outgoing)));
    }
    if (form.reciprocal && form.kind == Kind::outgoing) {
        throw UsageError(fmt::format("{} needs {}, which treats both directions alike", reciprocal,
                                     kind(Kind::basis)));
    }
    if (form.reciprocal && form.quantity == Quantity::brdfCosine) {
        throw UsageError(
            fmt::format("f cos(theta_i) is not symmetric: leave out {} or {}", cosine, reciprocal));
    }
    if (form.kind == Kind::halfway) requireConsistentHalfway(form, laws);
    if (form.rank > 0 && form.rankError > 0) {
        throw UsageError(fmt::format("give {} or {}, not both", rank, Setting{"Form::rankError"}));
    }
    if (form.nonNegativeFactors && form.rank == 0) {
        throw UsageError(fmt::format("{} needs {}", factors, rank));
    }
}

std::unique_ptr<ProjectionSource> projecting(const Brdf& brdf, const ProjectionOptions& options) {
    return std::make_unique<Projecting>(brdf, options);
}

Representation represent(const Brdf& brdf, const Form& form, const BrdfOpener& open,
                         const ProjectionOptions& options) {
    if (form.split.empty()) {
        const auto source = projecting(brdf, options);
        return represent(*source, form);
    }
    const Split split = takeOut(brdf, form.split, open);
    ProjectionOptions remainder = options;
    if (remainder.tolerance == 0) remainder.tolerance = brdf.defaultTolerance();
    const auto source = projecting(*split.remainder, remainder);
    Representation result = represent(*source, form, split.added);
    result.head.source = brdf.name();
    return result;
}

Representation represent(ProjectionSource& source, const Form& form, const std::string& added) {
    requireConsistent(form, source.remainder().laws());
    Representation result = projected(source, form);
    result.added = added;
    if (form.window != Window::none) result = windowed(std::move(result), form.window);
    if (form.nonNegative) result = madeNonNegative(std::move(result), addedTo(source.remainder()));
    if (form.energyPreserving) {
        result = madeEnergyPreserving(std::move(result), source.remainder());
    }
    if (form.rank > 0 || form.rankError > 0) {
        result = factored(
            std::move(result),
            {.rank = form.rank, .error = form.rankError, .nonNegative = form.nonNegativeFactors});
    }
    if (form.keep > 0) keep(result, form.keep);
    quantise(result, form.precision, source.remainder());
    return result;
}

}  // namespace hshfit::inline representation::inline forms
