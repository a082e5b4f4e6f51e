#pragma once

#include <hshfit/bases/basis.h>

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

namespace hshfit::inline rotation {

/// Coefficients in one basis from coefficients in another (Gautron et al. 2004, Eq. 18):
///     C_(i,j) = integral over the hemisphere of TO_i FROM_j w d omega,
/// w = 1 or cos(theta), the inner product of TO unless `weight` states another: the projection of
/// sum c_j FROM_j, a function on the hemisphere that is 0 below the horizon, onto TO. A basis TO
/// that is not orthonormal (lsosh) solves its Gram system, so that C c fits the function best on
/// the hemisphere. C is block-diagonal in m, and the blocks of m and -m are equal.
///
/// HSH to SH is the transpose of SH to HSH, and not its inverse: the smallest singular value of C
/// is 1.3e-2 at order 4 and 1.7e-5 at order 8, so that an inverse amplifies what SH miss by as
/// much. Where the SH have to match on the hemisphere alone, convert to lsosh, which is least
/// squares with small singular values left out.
///
/// By Gauss-Legendre quadrature in mu or sqrt(mu), exact but for rounding for every pair of the
/// catalog: 2e-13 at order 1000 against 50 digits. Vectors of high order go through the values at
/// the nodes, O(order^3) operations for all m, and C is not made. The recurrence over the degree of
/// the SH, 2 [b' C_(l,l'+1) + b C_(l,l'-1)] - C_(l,l') = ..., is stable for small |m| alone: at
/// order 100 it errs by 5e-15 for m = 2, 3e-8 for m = 10 and 8e-4 for m = 20
/// (docs/explanation/rotation.md).
class BasisChange {
public:
    BasisChange(const Basis& from, const Basis& to, std::optional<Basis::Inner> weight = {});
    ~BasisChange();
    BasisChange(BasisChange&&) noexcept;
    BasisChange& operator=(BasisChange&&) noexcept;

    int fromOrder() const;
    int toOrder() const;

    /// C for one m: row (l - |m|), l = |m| .. toOrder - 1, column (l' - |m|), l' = |m| ..
    /// fromOrder - 1, row by row; zeros where a basis lacks a function. |m| below both orders.
    std::vector<double> block(int m) const;

    /// out = C in for vectors of slots one after the other: fromOrder^2 to toOrder^2 values each.
    void apply(std::size_t vectors, const double* in, double* out) const;
    /// out = C^T in: toOrder^2 to fromOrder^2 values each.
    void applyTransposed(std::size_t vectors, const double* in, double* out) const;

    /// All of C, toOrder^2 rows of fromOrder^2. Throws UsageError beyond 2^26 entries.
    std::vector<double> dense() const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace hshfit::inline rotation
