#pragma once

#include <hshfit/quadrature/azimuth_tables.h>

#include <cstddef>

namespace hshfit::inline projection {

/// Rows of values, `stride` apart, each value `step` after the one before.
struct RowBlock {
    const double* data = nullptr;
    std::size_t rows = 0, stride = 0, step = 1;
};
/// Columns side by side, a multiple of laneGroup; rows are `stride` apart.
struct ColumnBlock {
    const double* data = nullptr;
    std::size_t columns = 0, stride = 0;
};

/// out[i * outStride + j] += sum over k < depth of a[i][k] b[k][j], by the vector instructions that
/// this processor has (Google Highway). The order of a sum depends on the shapes alone.
void addProducts(RowBlock a, ColumnBlock b, std::size_t depth, double* out, std::size_t outStride);

/// Azimuth transforms of a panel's rings times theta functions, m after m.
struct ThetaSums {
    const double* spectrum;  ///< [ring][channel][column]
    std::size_t rings, channels, columns;
    const std::size_t* columnOf;  ///< of cos(m phi), then of sin(m phi), for each m
    int order, firstM, lastM;     ///< m = firstM .. lastM - 1
    bool even;                    ///< leave sines alone
    const double* theta;          ///< for each m: [ring][l - m], whole groups of l
};
/// out += sums over the rings, for each m: [cosine, sine][channel][l - m], whole groups of l.
void addThetaSums(const ThetaSums& sums, double* out);
/// Values of one m for each channel, of cosines and of sines, and for each ring of theta.
constexpr std::size_t thetaLanes(int order, int m) {
    return (static_cast<std::size_t>(order - m) + laneGroup - 1) / laneGroup * laneGroup;
}

}  // namespace hshfit::inline projection
