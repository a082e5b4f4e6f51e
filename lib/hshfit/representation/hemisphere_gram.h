#pragma once

#include <hshfit/bases/basis.h>

#include <vector>

namespace hshfit::inline representation {

/// The Gram matrix of the functions of a basis over the hemisphere, in the basis' inner
/// product: for each m, with T the theta parts and w = 1 or mu,
///     G_ll' = integral of T_l^m T_l'^m w d mu over [0, 1] = (R^T R)_ll',   R upper triangular,
/// R from a QR decomposition of the functions at Gauss-Legendre nodes in sqrt(mu), which is exact
/// for every basis of the catalog. The identity for all but sh, which is orthonormal over the
/// sphere, and lsosh. Vectors are in slots; functions that the basis lacks keep their zeros.
class HemisphereGram {
public:
    explicit HemisphereGram(const Basis& basis);

    bool identity() const { return factors_.empty(); }
    /// The largest over m, of R; the condition of G is the square.
    double condition() const { return condition_; }

    /// c -> R c, whose Euclidean norm is the L2 norm of sum c_i B_i over the hemisphere.
    void whiten(double* slots) const;
    /// R c -> c. Loses `condition()` times the rounding.
    void unwhiten(double* slots) const;
    /// b -> R^-T b, so that the product with whitened coefficients is the product of b and c.
    void whitenFunctional(double* slots) const;

private:
    enum class Step { multiply, solve, solveTransposed };
    void apply(Step step, double* slots) const;

    struct Factor {
        std::vector<int> bands;     ///< l of the functions that exist
        std::vector<double> upper;  ///< row-major, square
    };
    std::vector<Factor> factors_;  ///< per m >= 0
    double condition_ = 1;
};

}  // namespace hshfit::inline representation
