#include <hshfit/bases/sh.h>

#include <hshfit/bases/jacobi.h>

namespace hshfit::bases {

namespace {

JacobiFamily sphereFamily() {
    return {
        .name = "sh",
        .argument = JacobiFamily::Argument::cosine,
        .factor = JacobiFamily::Factor::sine,
        .startSquared = 0.5,
        .startGrowth = [](int m) { return (2.0 * m + 1) / (2.0 * m); },
    };
}

}  // namespace

std::unique_ptr<Basis> makeSh(int order, BasisOptions options) {
    return std::make_unique<JacobiBasis>(sphereFamily(), order, options);
}

std::unique_ptr<Basis> makeEsh(int order, BasisOptions options) {
    JacobiFamily family = sphereFamily();
    family.name = "esh";
    family.startSquared = 1;
    family.evenOnly = true;
    return std::make_unique<JacobiBasis>(family, order, options);
}

}  // namespace hshfit::bases
