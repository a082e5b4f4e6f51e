#pragma once

#include <hshfit/bases/basis.h>
#include <hshfit/linear_algebra/decompositions.h>

#include <vector>

namespace hshfit::inline rotation {

/// Integrals over the lune that a hemisphere and the same hemisphere tilted about y by beta share
/// (Gautron et al. 2004, Eq. 14). With f = sum of c_j B_j on the hemisphere, f'(d) = f(R_y(-beta)
/// d) on the lune and 0 on the rest of the hemisphere:
struct LuneIntegrals {
    /// <A_i, f'> in the inner product of the basis, a column a vector.
    linear_algebra::RowMajor moments;
    /// Integral of f'^2 in that inner product, a vector each.
    std::vector<double> energy;
    /// The energy of f on the part that stays on the hemisphere, with the weight of where it was.
    std::vector<double> stayed;
};

enum class LuneFunctions {
    basis,     ///< A = B at the direction d
    analysis,  ///< the functions that coefficients come from (Basis::analysisTheta), at d
    source,    ///< A = B at R_y(-beta) d: the digon is deleted, and nothing is rotated
};

/// `c`: slots x vectors; 0 <= beta <= pi. Quadrature in polar coordinates about y,
///     d = (sin t sin a, cos t, sin t cos a),  a in [beta - pi/2, pi/2],
/// where functions behave like roots at the ends of a and t: Gauss-Legendre in the roots of the
/// distances from the ends, and panels that grow by 4 from an end, beside which the other root lies
/// beta away; next to an end, as many nodes as the shifted angle arccos(2 z - 1) turns. `density`
/// multiplies the number of nodes. Exact to 1e-13 (at order 100 by hemisphere_rotation_test).
LuneIntegrals luneIntegrals(const Basis& basis, double beta, const linear_algebra::RowMajor& c,
                            LuneFunctions functions = LuneFunctions::basis, double density = 1);

}  // namespace hshfit::inline rotation
