#include <hshfit/representation/forms/form.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/representation/basis_matrix.h>
#include <hshfit/representation/change.h>
#include <hshfit/representation/constraints/constraints.h>
#include <hshfit/representation/factoring/factoring.h>
#include <hshfit/representation/halfway/halfway.h>
#include <hshfit/representation/split.h>

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
        const Basis* const one[] = {basis.get()};
        return std::move(project(brdf_, one, outgoingOf(form), optionsFor(form))[0].coefficients);
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

/// Weights of an array's values in the norm of `relativeChange`, where they stand one for one.
std::vector<double> arrayWeights(const Representation& representation, const StoredArray& array) {
    if (array.name != "coefficients") return {};
    const Coefficients& head = representation.head;
    const std::size_t perDirection = array.values.size() / head.outgoing.size();
    std::vector<double> weights(array.values.size());
    for (std::size_t i = 0; i < weights.size(); ++i) {
        weights[i] = std::sqrt(head.outgoing.solidAngles[i / perDirection]);
    }
    return weights;
}

void keep(Representation& representation, std::size_t count) {
    const Representation before = representation;
    for (StoredArray& array : representation.arrays) {
        keepLargest(array, count, arrayWeights(before, array));
    }
    addStep(representation, before, fmt::format("keep {}", count));
}

void quantise(Representation& representation, Precision precision) {
    const Representation before = representation;
    for (StoredArray& array : representation.arrays) quantise(array, precision);
    if (precision == Precision::float64) return;
    addStep(representation, before, std::string(precisionName(precision)));
}

}  // namespace

Representation::Kind parseKind(std::string_view name) {
    for (std::size_t k = 0; k < kindNames.size(); ++k) {
        if (kindNames[k] == name) return static_cast<Kind>(k);
    }
    throw UsageError(fmt::format("'{}' is no form; known: outgoing, basis, halfway", name));
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
            throw UsageError(fmt::format(
                "--halfway '{}': give three numbers of functions from 1 to 256, as 12,6,3", text));
        }
        at = read.ptr;
    }
    return orders;
}

std::string optionsOf(const Form& form) {
    std::string out;
    const auto add = [&](bool given, const std::string& text) {
        if (given) out += (out.empty() ? "" : " ") + text;
    };
    const bool halfway = form.kind == Kind::halfway;
    add(form.kind != Kind::outgoing, fmt::format("--form {}", kindName(form.kind)));
    add(!halfway, fmt::format("--basis {} --order {}", form.basis, form.order));
    add(halfway, fmt::format("--halfway {},{},{}", form.halfway.half, form.halfway.difference,
                             form.halfway.azimuth));
    add(form.quantity == Quantity::brdfCosine, "--cosine");
    add(form.condonShortley, "--condon-shortley");
    add(!form.outgoing.empty(), "--outgoing " + form.outgoing);
    add(form.reciprocal, "--reciprocal");
    add(!form.split.empty(), fmt::format("--split '{}'", form.split));
    add(form.window != Window::none, fmt::format("--window {}", windowName(form.window)));
    add(form.nonNegative, "--non-negative");
    add(form.energyPreserving, "--energy-preserving");
    add(form.rank > 0, fmt::format("--rank {}", form.rank));
    add(form.rankError > 0, fmt::format("--rank-error {}", form.rankError));
    add(form.nonNegativeFactors, "--non-negative-factors");
    add(form.keep > 0, fmt::format("--keep {}", form.keep));
    add(true, fmt::format("--precision {}", precisionName(form.precision)));
    return out;
}

OutgoingSet outgoingOf(const Form& form) {
    if (!form.outgoing.empty()) return OutgoingSet::parse(form.outgoing);
    return OutgoingSet::parse("32x32");
}

void requireConsistent(const Form& form, const Laws& laws) {
    const auto refuse = [](const char* text) { throw UsageError(text); };
    if (form.kind != Kind::outgoing && !form.outgoing.empty()) {
        refuse("--outgoing belongs to --form outgoing: the other forms need no set of directions");
    }
    if (form.reciprocal && form.kind == Kind::outgoing) {
        refuse("--reciprocal needs --form basis, which treats both directions alike");
    }
    if (form.reciprocal && form.quantity == Quantity::brdfCosine) {
        refuse("f cos(theta_i) is not symmetric: leave out --cosine or --reciprocal");
    }
    if (form.kind == Kind::halfway) {
        if (form.quantity == Quantity::brdfCosine) refuse("--form halfway keeps f: no --cosine");
        if (form.window != Window::none || form.rank > 0 || form.rankError > 0 ||
            form.nonNegative || form.energyPreserving) {
            refuse(
                "--window, --rank, --non-negative and --energy-preserving are for linear forms, "
                "not "
                "for --form halfway");
        }
        if (!form.split.empty() && !laws.nonNegative) {
            refuse("--split with --form halfway needs a remainder that is nowhere negative");
        }
    }
    if (form.rank > 0 && form.rankError > 0) refuse("give --rank or --rank-error, not both");
    if (form.nonNegativeFactors && form.rank == 0) {
        refuse("--non-negative-factors needs --rank");
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
    quantise(result, form.precision);
    return result;
}

}  // namespace hshfit::inline representation::inline forms
