#pragma once

#include <hshfit/bases/basis.h>

#include <span>
#include <vector>

namespace hshfit::inline transfer {

/// The transfer matrix of a known factor f = sum c_k B_k (Schönefeld 2005, Eq. 39; Sloan et al.
/// 2002): matrix[i * order^2 + j] = sum over k of c_k T_ijk in `basis`, so that matrix times b are
/// the coefficients of f b, cut off at the order of `basis`. Symmetric. f has the functions of
/// `factorBasis`, the same family at any order: with 2 order - 1 bands the product with every b is
/// exact within `basis`. Built from the azimuth parts of f on exact rings, block by block of m, as
/// O(order^5) operations without the tensor, in the memory of the matrix.
/// Throws UsageError for bases that are not orthonormal, of two families, or of two inner products.
std::vector<double> transferMatrix(const Basis& basis, const Basis& factorBasis,
                                   std::span<const double> factor);

/// The product of two coefficient vectors.
struct Multiplied {
    std::vector<double> coefficients;
    double energy = 0;      ///< the integral of (a b)^2 in the basis' inner product, exact
    double truncation = 0;  ///< relative L2 error of the coefficients: what lies beyond the order
};

/// The coefficients of a b in `result`, for a in `first` and b in `second` of the same family, by
/// synthesis on an exact grid, multiplication, and analysis: O(order^3) where the tensor takes
/// O(order^5). Equal to TripleProducts::multiply but for rounding. Harmonics of the sphere of n_a
/// and n_b bands have a product of n_a + n_b - 1; other truncations are measured.
/// Throws UsageError as transferMatrix does.
Multiplied multiplied(const Basis& result, const Basis& first, std::span<const double> a,
                      const Basis& second, std::span<const double> b);

}  // namespace hshfit::inline transfer
