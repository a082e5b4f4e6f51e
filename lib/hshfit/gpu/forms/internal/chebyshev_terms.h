#pragma once

#include <hshfit/representation/halfway/halfway_terms.h>

#include <vector>

namespace hshfit::gpu::inline forms {

/// Coefficients of the same sums over products of Chebyshev polynomials T_n(2 x - 1) along the axes
/// in place of Legendre's: T_{n+1} = 2 t T_n - T_{n-1} takes one product a function, where
/// orthonormal polynomials take three. Exact, because terms with a function of degree n come with
/// the terms of lower degree. `values` has one number per term in the order of the list.
std::vector<double> chebyshevValues(const HalfwayTerms& terms, std::vector<double> values);

}  // namespace hshfit::gpu::inline forms
