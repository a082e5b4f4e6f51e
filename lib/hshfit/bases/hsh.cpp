#include <hshfit/bases/internal/hsh.h>

#include <hshfit/bases/jacobi.h>

namespace hshfit::bases {

std::unique_ptr<Basis> makeHsh(int order, BasisOptions options) {
    const JacobiFamily family{
        .name = "hsh",
        .argument = JacobiFamily::Argument::shifted,
        .factor = JacobiFamily::Factor::hump,
        .startSquared = 1,
        .startGrowth = [](int m) { return (2.0 * m + 1) / (2.0 * m); },
    };
    return std::make_unique<JacobiBasis>(family, order, options);
}

}  // namespace hshfit::bases
