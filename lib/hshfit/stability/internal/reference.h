#pragma once

#include <hshfit/brdf/directions.h>

#include <vector>

namespace hshfit::bases {
struct JacobiFamily;
}

namespace hshfit::stability {

/// T_l^m, l = m .. order - 1, in extended precision: out[(l - m) * directions.size() + p], 0 for
/// functions that the family lacks. Orthonormal Jacobi polynomials p_k for (1-t)^alpha (1+t)^beta
/// by
///     b_{k+1} p_{k+1} = (t - a_k) p_k - b_k p_{k-1}
/// (Gautschi 2004, table 1.1), normalised by the weight's integral
///     2^(alpha+beta+1) Gamma(alpha+1) Gamma(beta+1) / Gamma(alpha+beta+2).
/// These are the functions of bases/jacobi.h, evaluated independently to measure the errors there.
std::vector<long double> referenceTheta(const bases::JacobiFamily& family, int m, int order,
                                        const std::vector<Direction>& directions);

}  // namespace hshfit::stability
