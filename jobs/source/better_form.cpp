#include "better_form.h"

#include "picture.h"
#include "quality.h"
#include "source.h"

#include <hshfit/bases/catalog.h>
#include <hshfit/coefficients/reconstruction.h>
#include <hshfit/error.h>
#include <hshfit/pictures/poor.h>
#include <hshfit/projection/one_basis.h>
#include <hshfit/representation/forms/represented_brdf.h>
#include <hshfit/representation/halfway/halfway.h>

#include <brdfs/fit/fit_samples.h>

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace hshfit::jobs {
namespace {

using Kind = Representation::Kind;

bool isOneDirection(const OutgoingSet& set) {
    return !set.directions.empty() && set.map == OutgoingSet::Map::direction;
}

bool isPlain(const Form& form) {
    return form.kind == Kind::outgoing && form.precision == Precision::float32;
}

std::size_t functionsOf(const Form& form, const Laws& laws) {
    if (form.kind != Kind::halfway) {
        const auto order = static_cast<std::size_t>(form.order);
        return order * order;
    }
    const bool reciprocal = laws.reciprocal || form.reciprocal;
    return HalfwayTerms(halfwayOrdersOr(form.halfway, laws.isotropic, reciprocal),
                        {laws.isotropic, laws.mirrorSymmetric, reciprocal})
        .size();
}

/// The coefficients of the least order above that of the result which passes; empty if none does.
/// The highest order is tried first: where that is poor, lower ones are taken to be.
std::optional<Form> moreBands(const CoefficientHead& head, const Brdf& source) {
    std::vector<Form> higher;
    for (const int order : {8, 12, 16, 24, 32, 64}) {
        if (order <= head.order || (order > 32 && !isOneDirection(head.outgoing))) continue;
        Form form = coefficientsOf(order, head);
        if (determine(source, functionsOf(form, source.laws()))) higher.push_back(std::move(form));
    }
    if (higher.empty() || !passes(higher.back(), source)) return std::nullopt;
    return *std::ranges::find_if(higher, [&](const Form& form) {
        return form.order == higher.back().order || passes(form, source);
    });
}

bool areEqual(const HalfwayOrders& a, const HalfwayOrders& b) {
    return a.half == b.half && a.difference == b.difference && a.azimuth == b.azimuth;
}

/// More functions along each axis than `orders`; none where that makes too many.
std::optional<HalfwayOrders> moreFunctions(const HalfwayOrders& orders,
                                           const HalfwaySymmetry& symmetry) {
    for (const int more : {orders.half, orders.half / 2, orders.half / 4}) {
        const HalfwayOrders finer{orders.half + more, orders.difference + 2, orders.azimuth + 1};
        if (more > 0 && HalfwayTerms(finer, symmetry).size() <= mostHalfwayTerms) return finer;
    }
    return std::nullopt;
}

/// The halfway forms to try where `kept` is poor: the usual one and a finer one.
std::vector<Form> halfwayForms(const Representation& kept, const Brdf& source) {
    const CoefficientHead& head = kept.head;
    const HalfwayOrders usual = halfwayOrdersOr({}, head.isotropic, head.reciprocal);
    std::vector<HalfwayOrders> orders = {usual};
    if (const auto finer = moreFunctions(usual, halfwaySymmetryOf(head))) orders.push_back(*finer);
    std::vector<Form> forms;
    for (const HalfwayOrders& o : orders) {
        const Form form{.kind = Kind::halfway,
                        .halfway = o,
                        .reciprocal = head.reciprocal && !source.laws().reciprocal};
        if (!areEqual(o, kept.halfway) && determine(source, functionsOf(form, source.laws())))
            forms.push_back(form);
    }
    return forms;
}

}  // namespace

bool passes(const Form& form, const Brdf& source) {
    try {
        if (isPlain(form)) {
            const auto basis = bases::make(form.basis, form.order);
            const Projection made = hshfit::project(source, *basis, outgoingOf(form, source.laws()),
                                                    {.quantity = form.quantity});
            return !poorReason(capturedShare(made, source),
                               pictureErrorOf(source, Reconstruction(made.coefficients)));
        }
        const Representation made = represent(source, form, sourceOpener());
        return !poorReason(capturedShare(made, source),
                           pictureErrorOf(source, *reconstruct(made, sourceOpener())));
    } catch (const Error&) {
        return false;  // it cannot be made, so that it is no advice
    }
}

std::string callOf(const Form& form, const CoefficientHead& head, const std::string& output) {
    std::vector<Setting> settings;
    if (form.kind != Kind::outgoing)
        settings.push_back({"Form::kind", std::string(kindName(form.kind))});
    if (form.kind == Kind::halfway) {
        const HalfwayOrders& o = form.halfway;
        if (o.half > 0)
            settings.push_back(
                {"Form::halfway", fmt::format("{},{},{}", o.half, o.difference, o.azimuth)});
        if (form.reciprocal) settings.push_back({"Form::reciprocal"});
    } else {
        settings.push_back({"Form::basis", form.basis});
        settings.push_back({"Form::order", std::to_string(form.order)});
        if (!form.outgoing.empty()) settings.push_back({"Form::outgoing", form.outgoing});
        if (form.quantity == Quantity::brdfCosine) settings.push_back({"Form::quantity"});
    }
    return fmt::format("{}", Call{.function = "writeRepresentation",
                                  .subject = head.source,
                                  .settings = std::move(settings),
                                  .output = output});
}

Form coefficientsOf(int order, const CoefficientHead& head) {
    const bool ends = head.basis.empty() || bases::find(head.basis).maxOrder < order;
    Form form{.basis = ends ? "hsh" : head.basis, .order = order, .quantity = head.quantity};
    if (!head.outgoing.directions.empty()) form.outgoing = head.outgoing.spec();
    return form;
}

std::string callOfHalfway(const CoefficientHead& head, const Brdf& source,
                          const std::string& output) {
    if (!determine(source, halfwayFunctions(source.laws()))) return callOfModel(head);
    return callOf({.kind = Kind::halfway}, head, output);
}

std::optional<std::size_t> measuredPairs(const Brdf& source) {
    if (!brdfs::areMeasured(source)) return std::nullopt;
    try {
        return brdfs::gatherSamples(source, {}).size();
    } catch (const NumericError&) {
        return 0;
    }
}

bool determine(const Brdf& source, std::size_t functions) {
    const auto pairs = measuredPairs(source);
    return !pairs || *pairs >= functions;
}

std::size_t halfwayFunctions(const Laws& laws) {
    return functionsOf({.kind = Kind::halfway}, laws);
}

std::string callOfModel(const CoefficientHead& head) {
    return fmt::format("{}", Call{.function = "fit",
                                  .subject = head.source,
                                  .settings = {{"FitOptions::model", "lambert+ggx"}},
                                  .output = "fit.json"});
}

Advice adviceBeside(const CoefficientHead& head, const Representation* halfway, const Brdf& source,
                    const std::string& output, const std::vector<Form>& first) {
    for (const Form& form : first)
        if (passes(form, source)) return {callOf(form, head, output), {}};
    if (const auto more = moreBands(head, source)) return {callOf(*more, head, output), {}};
    if (halfway) {
        for (const Form& form : halfwayForms(*halfway, source))
            if (passes(form, source)) return {callOf(form, head, output), {}};
        return {};
    }
    // The halfway form holds f at every direction.
    if (isOneDirection(head.outgoing)) return {};
    return {{}, callOfHalfway(head, source, output)};
}

}  // namespace hshfit::jobs
