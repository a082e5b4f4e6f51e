#include <hshfit/gpu/internal/basis_steps.h>

#include <hshfit/bases/jacobi.h>
#include <hshfit/bases/sh.h>
#include <hshfit/error.h>

#include <cmath>

namespace hshfit::gpu {
namespace {

using bases::JacobiBasis;
using bases::JacobiFamily;

double azimuthScale(int m, bool condonShortley) {
    return m == 0 ? 1 / std::sqrt(2 * pi) : azimuthSign(m, condonShortley) / std::sqrt(pi);
}

BasisSteps::Scale scaleOf(JacobiFamily::Factor factor) {
    switch (factor) {
        case JacobiFamily::Factor::hump:
            return BasisSteps::Scale::hump;
        case JacobiFamily::Factor::chord:
            return BasisSteps::Scale::chord;
        case JacobiFamily::Factor::sine:
            break;
    }
    return BasisSteps::Scale::one;
}

BasisSteps jacobiSteps(const JacobiBasis& basis) {
    const JacobiFamily& family = basis.family();
    const bool down = family.argument == JacobiFamily::Argument::shiftedDown;
    BasisSteps result;
    result.scale = scaleOf(family.factor);
    result.rootCosine = family.timesRootCosine;
    result.bothEnds = family.argument != JacobiFamily::Argument::cosine;
    result.near = down ? -1 : 1;
    result.bandStep = family.bandStep;
    for (int m = 0; m < basis.order(); ++m) {
        const auto pole = basis.steps(m, down), horizon = basis.steps(m, !down);
        BasisSteps::Column column{m, basis.start(m) * azimuthScale(m, basis.condonShortley()), {}};
        for (std::size_t k = 0; k < pole.size(); ++k) {
            // Slopes are the same from either end: only t changes sign.
            column.steps.push_back({pole[k].slope,
                                    {pole[k].ratio, horizon[k].ratio},
                                    {pole[k].carry, horizon[k].carry}});
        }
        result.columns.push_back(std::move(column));
    }
    return result;
}

/// 1, sqrt(3) (2 z - 1), sqrt(3/2) u, sqrt(15/8) u^2 (bases/internal/h_basis.h).
BasisSteps habelSteps(const Basis& basis) {
    const double root3 = std::sqrt(3.0);
    BasisSteps result;
    result.bothEnds = true;
    const double starts[] = {1, std::sqrt(1.5), std::sqrt(1.875)};
    for (int m = 0; m < basis.order(); ++m) {
        BasisSteps::Column column{m, starts[m] * azimuthScale(m, basis.condonShortley()), {}};
        if (m == 0 && basis.order() > 1) column.steps.push_back({root3, {root3, -root3}, {0, 0}});
        result.columns.push_back(std::move(column));
    }
    return result;
}

}  // namespace

BasisSteps basisSteps(const Basis& basis) {
    if (const auto* jacobi = dynamic_cast<const JacobiBasis*>(&basis)) return jacobiSteps(*jacobi);
    if (basis.name() == "h-basis") return habelSteps(basis);
    if (basis.name() != "lsosh")
        throw UsageError("shaders have no recurrence for the basis '" + basis.name() + "'");
    // Least-squares SH differ from SH in their coefficients only.
    const auto harmonics = bases::makeSh(basis.order(), {.condonShortley = basis.condonShortley()});
    return jacobiSteps(dynamic_cast<const JacobiBasis&>(*harmonics));
}

}  // namespace hshfit::gpu
