#pragma once

#include <cstddef>

namespace hshfit::inline representation::inline halfway {

/// One channel at a pair: the parts of the form as shares of f + e, and the error of the logarithm
/// with its weight.
struct HalfwayResidual {
    double smooth, lobe, error, weight;
};

/// Columns of `addResiduals` have to be a multiple of it: the widest vector.
constexpr std::size_t gramPadding = 8;

/// Terms at pairs, [pair][column], the smooth ones first, and one channel's residuals there, of
/// which the next is `stride` further.
struct HalfwayResidualRows {
    const double* terms;
    const HalfwayResidual* residuals;
    std::size_t count, columns, smooth, stride;
};

/// With the derivatives x[k][i] = share of the part of i times the term, adds over pairs
///     gram[i * columns + j] += weight x[k][i] x[k][j]  for i >= j (and some others),
///     slope[i]              += weight error x[k][i].
/// `space` has room for twice as many numbers as `terms`. Double precision, by code for the best
/// instruction set that the machine has.
void addResiduals(const HalfwayResidualRows& rows, double* space, double* gram, double* slope);

}  // namespace hshfit::inline representation::inline halfway
