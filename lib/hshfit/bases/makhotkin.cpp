#include <hshfit/bases/internal/makhotkin.h>

#include <hshfit/bases/jacobi.h>

namespace hshfit::bases {

namespace {

JacobiFamily fluxFamily() {
    return {
        .name = "makhotkin-flux",
        .argument = JacobiFamily::Argument::shifted,
        .factor = JacobiFamily::Factor::hump,
        .beta = {.offset = 1},
        .startSquared = 2,
        .startGrowth = [](int m) { return (2.0 * m + 1) / (2.0 * m); },
        .inner = Basis::Inner::projectedSolidAngle,
    };
}

}  // namespace

std::unique_ptr<Basis> makeMakhotkinFlux(int order, BasisOptions options) {
    return std::make_unique<JacobiBasis>(fluxFamily(), order, options);
}

std::unique_ptr<Basis> makeMakhotkin(int order, BasisOptions options) {
    JacobiFamily family = fluxFamily();
    family.name = "makhotkin";
    family.timesRootCosine = true;
    family.inner = Basis::Inner::solidAngle;
    return std::make_unique<JacobiBasis>(family, order, options);
}

}  // namespace hshfit::bases
