#pragma once

#include <limits>
#include <string>
#include <vector>

namespace hshfit::bases {
class JacobiBasis;
}

namespace hshfit::stability {

/// The error of an order that was not measured.
inline constexpr double unmeasured = std::numeric_limits<double>::quiet_NaN();

/// The number type that is measured, float or double, and its name.
enum class Precision { single, twice };
std::string precisionName(Precision precision);  ///< "float", "double"

/// The error of a computation by degree, as `stress` reports it.
struct DegreeErrors {
    std::string basis;
    Precision precision = Precision::twice;
    std::vector<double> error;  ///< [l]; NaN where the basis has no function of degree l

    /// The largest degree up to which every error is at most `bound`; -1: none.
    int goodUntil(double bound) const;
};

/// Errors of T_l^m, relative to the largest |T_l^m| over the directions: the largest over the m of
/// `orders` and directions with theta from 0 and 1e-12 to pi/2 - 1e-12, dense at both ends.
/// Directions are unit vectors in double precision; the error is against the functions at just
/// these vectors, so that the rounding to float counts as an error of float.
///
/// The reference is the textbook three-term recurrence of the orthonormal Jacobi polynomials in
/// extended precision (long double), with constants from the log-gamma function and not from
/// the basis. Its error is 3e-14 at degree 1000 if long double has a 64-bit significand. No
/// error is measured for functions below 1e-250 (1e-30 in float) everywhere.
///
/// `lsosh` evaluates SH; the H-basis has no degrees. Throws UsageError for these two.
DegreeErrors evaluationErrors(const bases::JacobiBasis& basis, Precision precision);

/// The same for |<T_l^m, T_l'^m> - delta|, the largest over l' <= l, by a Gauss-Legendre rule that
/// integrates the products exactly.
DegreeErrors orthonormalityErrors(const bases::JacobiBasis& basis, Precision precision);

/// The m that are measured: 0, 1, 2, 5, 10, 20, 50, … and the last two.
std::vector<int> sampledOrders(int order);

}  // namespace hshfit::stability
