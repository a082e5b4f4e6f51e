#include <hshfit/representation/constraints/constraints.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/representation/change.h>
#include <hshfit/representation/constraints/constraints_cone.h>
#include <hshfit/representation/constraints/internal/constraints_albedo.h>
#include <hshfit/representation/constraints/internal/constraints_both.h>
#include <hshfit/representation/split.h>
#include <hshfit/wording.h>

#include <fmt/format.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>

namespace hshfit::inline representation::inline constraints {
namespace {

constexpr const char* nonNegativeStep = "non-negative";

void requirePlain(const Representation& representation, const Setting& setting) {
    if (representation.as<CoefficientArray>() || representation.as<MatrixArray>()) return;
    throw UsageError(fmt::format(
        "{} is for coefficients of the forms outgoing and basis, not factored", setting));
}

std::unique_ptr<Basis> basisOf(const Representation& representation) {
    const CoefficientHead& head = representation.head;
    return bases::make(head.basis, head.order, {.condonShortley = head.condonShortley});
}

/// The part of f that is added in one channel at one wo, as a part of q.
NonNegativeCone::Added addedAt(const Brdf* added, const Direction& wo, std::size_t channel,
                               Quantity quantity) {
    if (!added) return {};
    return [=](const Direction& wi) {
        const std::vector<double> f = evaluate(*added, wi, wo);
        const double cosine = quantity == Quantity::brdfCosine ? wi.z : 1;
        return f[f.size() == 1 ? 0 : channel] * cosine;
    };
}

/// Coefficients in place of the stored ones; what was done stays on record.
void replaceRows(Representation& representation, const Coefficients& c) {
    Representation changed = fromCoefficients(c);
    representation.slots = std::move(changed.slots);
    representation.content = std::move(changed.content);
}

void liftRows(Representation& representation, const Brdf* added) {
    const auto basis = basisOf(representation);
    const NonNegativeCone cone(*basis, withoutSines(representation.slots));
    Coefficients c = decoded(representation);
    const std::size_t channels = c.channels.count();
    tbb::parallel_for(std::size_t{0}, c.outgoing.size() * channels, [&](std::size_t row) {
        double* from = c.at(row / channels, row % channels);
        const auto part =
            addedAt(added, c.outgoing.directions[row / channels], row % channels, c.quantity);
        std::ranges::copy(cone.nearest(from, part), from);
    });
    replaceRows(representation, c);
}

/// The nearest coefficients with functional . c = target: a projection on a plane.
void ontoPlane(const std::vector<double>& functional, double excess, const HemisphereGram* gram,
               double* c) {
    std::vector<double> direction = functional;
    if (gram) gram->whitenFunctional(direction.data());
    const double norm =
        std::inner_product(direction.begin(), direction.end(), direction.begin(), 0.0);
    if (gram) gram->unwhiten(direction.data());
    for (std::size_t i = 0; i < direction.size(); ++i) c[i] -= excess / norm * direction[i];
}

void lowerRows(Representation& representation, const Brdf& source, bool nonNegative) {
    const auto basis = basisOf(representation);
    const bool own = bases::find(basis->name()).orthonormal;
    const HemisphereGram gram(*basis);
    const std::vector<double> moments = albedoMoments(*basis, representation.head.quantity);
    Coefficients c = decoded(representation);
    const std::size_t channels = c.channels.count(), count = c.outgoing.size();
    const std::vector<Direction> checks = albedoChecks(c.outgoing);
    const std::vector<double> bounds = albedoBounds(source, checks);
    const NonNegativeCone cone(*basis, withoutSines(representation.slots));
    for (std::size_t channel = 0; channel < channels; ++channel) {
        std::vector<InterpolatedBound> limits;
        for (std::size_t p = 0; p < checks.size(); ++p) {
            OutgoingLookup at = lookUp(c.outgoing, checks[p]);
            if (p < count) at = {.index = {p}, .weight = {1.0}, .count = 1};
            limits.push_back({at, bounds[p * channels + channel]});
        }
        std::vector<double> albedos;
        for (std::size_t o = 0; o < count; ++o) {
            albedos.push_back(
                std::inner_product(moments.begin(), moments.end(), c.at(o, channel), 0.0));
        }
        const std::vector<double> targets = albedoTargets(albedos, c.outgoing.solidAngles, limits);
        tbb::parallel_for(std::size_t{0}, count, [&](std::size_t o) {
            if (!(albedos[o] > targets[o])) return;
            double* row = c.at(o, channel);
            if (!nonNegative) {
                ontoPlane(moments, albedos[o] - targets[o], own ? nullptr : &gram, row);
                return;
            }
            const NonNegativeCone::Limit limit{moments, targets[o]};
            const auto part =
                addedAt(addedTo(source), c.outgoing.directions[o], channel, c.quantity);
            std::ranges::copy(cone.nearest(row, part, &limit), row);
        });
    }
    replaceRows(representation, c);
}

bool isNonNegative(const Representation& representation) {
    return std::ranges::any_of(representation.steps, [](const RepresentationStep& step) {
        return step.what == nonNegativeStep;
    });
}

}  // namespace

Representation madeNonNegative(Representation representation, const Brdf* added) {
    requirePlain(representation, {"Form::nonNegative"});
    const Representation before = representation;
    if (representation.kind() == Representation::Kind::outgoing) {
        liftRows(representation, added);
    } else {
        constrainBoth(representation, {.nonNegative = true, .added = added});
    }
    addStep(representation, before, nonNegativeStep);
    return representation;
}

Representation madeEnergyPreserving(Representation representation, const Brdf& source) {
    requirePlain(representation, {"Form::energyPreserving"});
    const Representation before = representation;
    const bool nonNegative = isNonNegative(representation);
    if (representation.kind() == Representation::Kind::outgoing) {
        lowerRows(representation, source, nonNegative);
    } else {
        constrainBoth(representation, {.nonNegative = nonNegative,
                                       .added = nonNegative ? addedTo(source) : nullptr,
                                       .albedoSource = &source});
    }
    addStep(representation, before, "energy-preserving");
    return representation;
}

}  // namespace hshfit::inline representation::inline constraints
