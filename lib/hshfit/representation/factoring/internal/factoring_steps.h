#pragma once

#include <hshfit/representation/factoring/factoring.h>
#include <hshfit/representation/hemisphere_gram.h>

#include <vector>

namespace hshfit::inline representation::inline factoring {

/// Rows of coefficients in all slots, with the norm that they are measured in.
struct WeightedRows {
    std::size_t rows = 0, slots = 0;
    std::vector<double> coefficients;  ///< [row][slot]
    std::vector<double> solidAngles;   ///< per row
};

/// left [row][rank] times right [rank][slot].
struct RowFactors {
    std::size_t rank = 0;
    std::vector<double> left, right;
    bool settled = true;  ///< the last sweep lowered the squared error by less than 1e-4 of it
};

/// See `factored`: left >= 0, right non-negative on the hemisphere.
RowFactors nonNegativeFactors(const WeightedRows& rows, const Basis& basis, std::size_t rank,
                              bool even, int mostSweeps);

}  // namespace hshfit::inline representation::inline factoring
