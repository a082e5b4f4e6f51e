#pragma once

#include <hshfit/bases/basis.h>

#include <memory>

namespace hshfit::bases {

/// Least-squares optimal spherical harmonics: the functions of `makeSh`, with the coefficients that
/// fit f best on the hemisphere, c = G^+ b with G_ij the hemisphere integral of Y_i Y_j.
///
/// The functions are not orthogonal there (condition of G: 14 at order 2, 1e11 at 9), so f is
/// analysed by polynomials in mu that are orthonormal for (1 - mu^2)^m on [0, 1] and span the same
/// space band by band; coefficients follow from R c = moments, R_kj = <q_k, Y_j>, whose condition
/// is the square root of the condition of G. Directions of hardly any weight on the hemisphere,
/// with singular values of R below 1e-11 of the largest, are left out: evaluation in double leaves
/// noise of eps/sigma there. That happens from about order 16 on; the rest is the Slepian basis.
/// Order at most 100: a solve costs order^4 operations.
std::unique_ptr<Basis> makeLsosh(int order, BasisOptions options);

/// The condition of the systems of one order.
struct LsoshGram {
    /// The condition of G: the square of R's, the largest over m. Infinite beyond 1e30, where
    /// singular values of R are rounding errors.
    double condition = 1;
    int kept = 0;  ///< directions that the solve keeps, of order^2
};
LsoshGram lsoshGram(int order);

}  // namespace hshfit::bases
