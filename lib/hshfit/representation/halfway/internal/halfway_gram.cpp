#include <hshfit/representation/halfway/internal/halfway_gram.h>
#include <hshfit/vector_targets.h>

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
using Doubles = hn::CappedTag<double, gramPadding / 3>;

/// Rows and vectors of a tile that is summed in registers.
constexpr std::size_t tileRows = 4, tileVectors = 3;

/// The tile of the Gram matrix at row i and column j.
void addTile(const double* x, const double* scaled, std::size_t rows, std::size_t columns,
             std::size_t i, std::size_t j, double* gram) {
    const Doubles lanes;
    hn::Vec<Doubles> sums[tileRows][tileVectors];
    for (auto& row : sums) {
        for (auto& sum : row) sum = hn::Zero(lanes);
    }
    for (std::size_t k = 0; k < rows; ++k) {
        const double* along = x + k * columns + j;
        const hn::Vec<Doubles> right[tileVectors] = {
            hn::LoadU(lanes, along), hn::LoadU(lanes, along + hn::Lanes(lanes)),
            hn::LoadU(lanes, along + 2 * hn::Lanes(lanes))};
        for (std::size_t r = 0; r < tileRows; ++r) {
            const auto left = hn::Set(lanes, scaled[k * columns + i + r]);
            for (std::size_t v = 0; v < tileVectors; ++v) {
                sums[r][v] = hn::MulAdd(left, right[v], sums[r][v]);
            }
        }
    }
    for (std::size_t r = 0; r < tileRows; ++r) {
        double* out = gram + (i + r) * columns + j;
        for (std::size_t v = 0; v < tileVectors; ++v, out += hn::Lanes(lanes)) {
            hn::StoreU(hn::Add(hn::LoadU(lanes, out), sums[r][v]), lanes, out);
        }
    }
}

}  // namespace

void AddWeightedGram(const double* x, const double* weights, std::size_t rows, std::size_t columns,
                     double* scaled, double* gram) {
    const Doubles lanes;
    for (std::size_t k = 0; k < rows; ++k) {
        for (std::size_t i = 0; i < columns; ++i) {
            scaled[k * columns + i] = weights[k] * x[k * columns + i];
        }
    }
    const std::size_t width = tileVectors * hn::Lanes(lanes);
    for (std::size_t j = 0; j < columns; j += width) {
        for (std::size_t i = j / tileRows * tileRows; i < columns; i += tileRows) {
            addTile(x, scaled, rows, columns, i, j, gram);
        }
    }
}

}  // namespace hshfit::inline representation::inline halfway::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hshfit::inline representation::inline halfway {

HWY_EXPORT(AddWeightedGram);

void addWeightedGram(const double* x, const double* weights, std::size_t rows, std::size_t columns,
                     double* scaled, double* gram) {
    HWY_DYNAMIC_DISPATCH(AddWeightedGram)(x, weights, rows, columns, scaled, gram);
}

}  // namespace hshfit::inline representation::inline halfway
#endif
