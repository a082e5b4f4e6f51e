#pragma once

#include <hshfit/wavelets/partition.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace hshfit::wavelets {

// SOHO wavelets (Lessig & Fiume 2008, "SOHO: Orthogonal and Symmetric Haar Wavelets on the Sphere",
// ACM TOG 27(1)): orthonormal piecewise constant functions over solid angle. The scaling function
// of a triangle is 1 / sqrt(area) on it. With S = sqrt(a_0 / a_T), g = sqrt(a / a_T), b = (S - 1)/3
// for the areas a_0 of the central child, a of each outer one and a_T of their parent,
//     psi_i = phi_i + b (phi_1 + phi_2 + phi_3) - g phi_0,    i = 1, 2, 3:
// the three wavelets of a triangle are each other's images when its outer children are relabelled.
// (The other sign of S makes a second such basis, whose wavelets are less local.)

/// There are as many functions as leaves. Indices: the roots' scaling functions, then level by
/// level roots 4^j + 3 k + i - 1 for wavelet i of triangle k at level j.
///
/// Analysis of averages over the leaves, and synthesis back: O(leaves), exact but for rounding.
/// Both arrays have `leaves()` numbers.
void analyse(const Partition& partition, const double* averages, double* coefficients);
void synthesise(const Partition& partition, const double* coefficients, double* averages);

/// Averages over leaves, from the value at the centre of each.
using SphereFunction = std::function<double(const Direction&)>;
std::vector<double> averagesOf(const Partition& partition, const SphereFunction& f);

/// The k largest coefficients in magnitude: the nearest function of any k terms, an adaptive
/// (nonlinear) approximation. Ties go to the lower index. In the order of their indices.
struct Term {
    std::uint32_t index;
    double value;
};
std::vector<Term> bestTerms(std::span<const double> coefficients, std::size_t k);
/// [k]: the energy of the best k, for k = 0 .. most.
std::vector<double> capturedByTerms(std::span<const double> coefficients, std::size_t most);

/// The value of a sum of terms, ordered by index, in the leaf in which d lies.
double valueOf(const Partition& partition, std::span<const Term> terms, const Direction& d);

}  // namespace hshfit::wavelets
