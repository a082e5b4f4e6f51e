#pragma once

#include <hshfit/bases/basis.h>

#include <span>
#include <vector>

namespace hshfit::bases {

/// Polynomials q_k orthonormal for (1 - mu^2)^m on [0, 1] (half-range Gegenbauer polynomials):
///     mu q_k = offDiagonal[k+1] q_{k+1} + diagonal[k] q_k + offDiagonal[k] q_{k-1}.
struct HalfRangeRecurrence {
    std::vector<double> diagonal, offDiagonal;  ///< offDiagonal[0] = 0
    double first = 1;                           ///< q_0
};

/// For m = 0 .. order - 1, with at least order - m coefficients each. No closed form is known: each
/// m follows from the last by the factors 1 + mu and 1 - mu (Christoffel's theorem), one Cholesky
/// LR step each (Kautsky & Golub 1983; Gautschi 2004, 2.4).
std::vector<HalfRangeRecurrence> halfRangeRecurrences(int order);

/// (1 - mu^2)^{m/2} q_k(mu), k < count, to out[k * points.size() + p]; 0 below the horizon.
/// (sin theta)^m may underflow, which changes no value above 1e-290 while m + count <= 200.
void halfRangeTheta(const HalfRangeRecurrence& q, int m, int count,
                    std::span<const Elevation<double>> points, double* out);

}  // namespace hshfit::bases
