#pragma once

#include <cstddef>

namespace hshfit::inline representation::inline halfway {

/// Columns of `addWeightedGram` have to be a multiple of it: three of the widest vectors.
constexpr std::size_t gramPadding = 24;

/// gram[i * columns + j] += sum over k < rows of weights[k] x[k][i] x[k][j] for i >= j (and some
/// others), where x[k] starts at x + k * columns. `scaled` has room for as many numbers as x.
/// Double precision, by code for the best instruction set that the machine has.
void addWeightedGram(const double* x, const double* weights, std::size_t rows, std::size_t columns,
                     double* scaled, double* gram);

}  // namespace hshfit::inline representation::inline halfway
