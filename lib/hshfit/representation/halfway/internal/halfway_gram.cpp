#include <hshfit/representation/halfway/internal/halfway_gram.h>
#include <hshfit/vector_targets.h>

#include <algorithm>

// Compiled once for every instruction set; the best one is chosen when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hshfit/representation/halfway/internal/halfway_gram.cpp"
#include <hwy/foreach_target.h>
// foreach_target.h comes before this.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::inline representation::inline halfway::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Doubles = hn::CappedTag<double, gramPadding>;

/// Rows, and vectors at most, of a tile that is summed in registers.
constexpr std::size_t tileRows = 4, tileVectors = 3;

/// The tile of the Gram matrix at row i and column j.
template <std::size_t vectors>
void addTile(const double* x, const double* scaled, std::size_t rows, std::size_t columns,
             std::size_t i, std::size_t j, double* gram) {
    const Doubles lanes;
    hn::Vec<Doubles> sums[tileRows][vectors];
    for (auto& row : sums) {
        for (auto& sum : row) sum = hn::Zero(lanes);
    }
    for (std::size_t k = 0; k < rows; ++k) {
        const double* along = x + k * columns + j;
        hn::Vec<Doubles> right[vectors];
        for (std::size_t v = 0; v < vectors; ++v)
            right[v] = hn::LoadU(lanes, along + v * hn::Lanes(lanes));
        for (std::size_t r = 0; r < tileRows; ++r) {
            const auto left = hn::Set(lanes, scaled[k * columns + i + r]);
            for (std::size_t v = 0; v < vectors; ++v) {
                sums[r][v] = hn::MulAdd(left, right[v], sums[r][v]);
            }
        }
    }
    for (std::size_t r = 0; r < tileRows; ++r) {
        double* out = gram + (i + r) * columns + j;
        for (std::size_t v = 0; v < vectors; ++v, out += hn::Lanes(lanes)) {
            hn::StoreU(hn::Add(hn::LoadU(lanes, out), sums[r][v]), lanes, out);
        }
    }
}

/// Writes the derivatives to `x` and, times the weights, to `scaled`; their product is the Gram
/// matrix. Adds to `slope`.
void scaleTerms(const HalfwayResidualRows& rows, double* x, double* scaled, double* slope) {
    const Doubles lanes;
    for (std::size_t k = 0; k < rows.count; ++k) {
        const HalfwayResidual& residual = rows.residuals[k * rows.stride];
        const auto smooth = hn::Set(lanes, residual.smooth), lobe = hn::Set(lanes, residual.lobe),
                   weight = hn::Set(lanes, residual.weight),
                   error = hn::Set(lanes, residual.weight * residual.error);
        for (std::size_t i = 0; i < rows.columns; i += hn::Lanes(lanes)) {
            const auto isSmooth = hn::FirstN(lanes, rows.smooth - std::min(i, rows.smooth));
            const std::size_t at = k * rows.columns + i;
            const auto slopes =
                hn::Mul(hn::IfThenElse(isSmooth, smooth, lobe), hn::LoadU(lanes, rows.terms + at));
            hn::StoreU(slopes, lanes, x + at);
            hn::StoreU(hn::Mul(weight, slopes), lanes, scaled + at);
            hn::StoreU(hn::MulAdd(error, slopes, hn::LoadU(lanes, slope + i)), lanes, slope + i);
        }
    }
}

}  // namespace

void AddResiduals(const HalfwayResidualRows& rows, double* space, double* gram, double* slope) {
    const Doubles lanes;
    const std::size_t columns = rows.columns;
    double* scaled = space + rows.count * columns;
    scaleTerms(rows, space, scaled, slope);
    for (std::size_t j = 0; j < columns; j += tileVectors * hn::Lanes(lanes)) {
        const std::size_t left = std::min(tileVectors, (columns - j) / hn::Lanes(lanes));
        const auto add = left == 1 ? addTile<1> : left == 2 ? addTile<2> : addTile<tileVectors>;
        for (std::size_t i = j / tileRows * tileRows; i < columns; i += tileRows)
            add(space, scaled, rows.count, columns, i, j, gram);
    }
}

}  // namespace hshfit::inline representation::inline halfway::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hshfit::inline representation::inline halfway {

HWY_EXPORT(AddResiduals);

void addResiduals(const HalfwayResidualRows& rows, double* space, double* gram, double* slope) {
    HWY_DYNAMIC_DISPATCH(AddResiduals)(rows, space, gram, slope);
}

}  // namespace hshfit::inline representation::inline halfway
#endif
