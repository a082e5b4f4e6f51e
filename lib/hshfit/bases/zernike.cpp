#include <hshfit/bases/internal/zernike.h>

#include <hshfit/bases/jacobi.h>

namespace hshfit::bases {

// R_q^m = rho^m P_k^{(0,m)}(2 rho^2 - 1) with 2 rho^2 - 1 = 1 - 2 mu and q = m + 2k.
std::unique_ptr<Basis> makeZernike(int order, BasisOptions options) {
    const JacobiFamily family{
        .name = "zernike",
        .argument = JacobiFamily::Argument::shiftedDown,
        .factor = JacobiFamily::Factor::chord,
        .alpha = {.slope = 0},
        .startSquared = 1,
        .startGrowth = [](int m) { return (m + 1.0) / m; },
        .bandStep = 2,
    };
    return std::make_unique<JacobiBasis>(family, order, options);
}

}  // namespace hshfit::bases
