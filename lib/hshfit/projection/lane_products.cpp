#include <hshfit/vector_targets.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hshfit/projection/lane_products.cpp"
#include <hwy/foreach_target.h>

#include <hshfit/projection/lane_products.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::inline projection {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::ScalableTag<double>;

/// Operands of one tile: rows at arbitrary places, and columns side by side.
struct Factors {
    const double* const* rows;
    std::size_t step;
    const double* columns;
    std::size_t stride, depth;
};

/// I rows by J vectors: 4 x 3 keep 12 sums, and their operands, in 16 registers. With few sums,
/// each addition would wait for the last: each sum is then split into several, over every n-th k.
template <std::size_t I, std::size_t J, class D>
HWY_INLINE void tile(D d, const Factors& factors, std::size_t column, double* HWY_RESTRICT out,
                     std::size_t outStride) {
    constexpr std::size_t parts = I * J >= 4 ? 1 : I * J >= 2 ? 2 : 4;
    const std::size_t lanes = hn::Lanes(d), step = factors.step, stride = factors.stride;
    const double* HWY_RESTRICT rows[I];
    for (std::size_t i = 0; i < I; ++i) rows[i] = factors.rows[i];
    hn::Vec<D> sums[parts][I][J];
    for (std::size_t part = 0; part < parts; ++part)
        for (std::size_t i = 0; i < I; ++i)
            for (std::size_t j = 0; j < J; ++j)
                sums[part][i][j] =
                    part > 0 ? hn::Zero(d) : hn::LoadU(d, out + i * outStride + j * lanes);
    const double* HWY_RESTRICT b = factors.columns + column;
    const auto add = [&](hn::Vec<D>(&to)[I][J], std::size_t k) HWY_ATTR {
        hn::Vec<D> right[J];
        for (std::size_t j = 0; j < J; ++j) right[j] = hn::LoadU(d, b + k * stride + j * lanes);
        for (std::size_t i = 0; i < I; ++i) {
            const hn::Vec<D> left = hn::Set(d, rows[i][k * step]);
            for (std::size_t j = 0; j < J; ++j) to[i][j] = hn::MulAdd(left, right[j], to[i][j]);
        }
    };
    std::size_t k = 0;
    for (; k + parts <= factors.depth; k += parts)
        for (std::size_t part = 0; part < parts; ++part) add(sums[part], k + part);
    for (; k < factors.depth; ++k) add(sums[0], k);
    for (std::size_t i = 0; i < I; ++i)
        for (std::size_t j = 0; j < J; ++j) {
            hn::Vec<D> sum = sums[0][i][j];
            for (std::size_t part = 1; part < parts; ++part) sum = hn::Add(sum, sums[part][i][j]);
            hn::StoreU(sum, d, out + i * outStride + j * lanes);
        }
}

/// I rows by all columns: three vectors at a time, then the rest, in groups at the end where
/// vectors are longer than that.
template <std::size_t I>
HWY_INLINE void rowsOf(const Factors& factors, std::size_t columns, double* out,
                       std::size_t outStride) {
    const Tag d;
    const std::size_t lanes = hn::Lanes(d);
    std::size_t j = 0;
    if constexpr (I <= 4) {
        for (; j + 3 * lanes <= columns; j += 3 * lanes)
            tile<I, 3>(d, factors, j, out + j, outStride);
        if (j + 2 * lanes <= columns) {
            tile<I, 2>(d, factors, j, out + j, outStride);
            j += 2 * lanes;
        }
    }
    for (; j + lanes <= columns; j += lanes) tile<I, 1>(d, factors, j, out + j, outStride);
    if (j < columns) tile<I, 1>(hn::CappedTag<double, laneGroup>(), factors, j, out + j, outStride);
}

/// All rows, shared out evenly among tiles: `rowAt(i)` is where row i starts.
template <class RowAt>
HWY_INLINE void tiles(std::size_t rows, RowAt rowAt, std::size_t step, const ColumnBlock& b,
                      std::size_t depth, double* out, std::size_t outStride) {
    constexpr std::size_t most = 6;
    const double* starts[most];
    const Factors factors{starts, step, b.data, b.stride, depth};
    const std::size_t atOnce = b.columns <= hn::Lanes(Tag()) ? most : 4;
    std::size_t tilesLeft = (rows + atOnce - 1) / atOnce;
    for (std::size_t i = 0; i < rows; --tilesLeft) {
        const std::size_t count = (rows - i + tilesLeft - 1) / tilesLeft;
        for (std::size_t k = 0; k < count; ++k) starts[k] = rowAt(i + k);
        double* to = out + i * outStride;
        switch (count) {
            case 1:
                rowsOf<1>(factors, b.columns, to, outStride);
                break;
            case 2:
                rowsOf<2>(factors, b.columns, to, outStride);
                break;
            case 3:
                rowsOf<3>(factors, b.columns, to, outStride);
                break;
            case 4:
                rowsOf<4>(factors, b.columns, to, outStride);
                break;
            case 5:
                rowsOf<5>(factors, b.columns, to, outStride);
                break;
            default:
                rowsOf<6>(factors, b.columns, to, outStride);
                break;
        }
        i += count;
    }
}

void products(const RowBlock& a, const ColumnBlock& b, std::size_t depth, double* out,
              std::size_t outStride) {
    tiles(
        a.rows, [&](std::size_t i) HWY_ATTR { return a.data + i * a.stride; }, a.step, b, depth,
        out, outStride);
}

void thetaSums(const ThetaSums& sums, double* out) {
    const std::size_t ring = sums.channels * sums.columns;
    const double* theta = sums.theta;
    for (int m = sums.firstM; m < sums.lastM; ++m) {
        const std::size_t lanes = thetaLanes(sums.order, m);
        const std::size_t kinds = m == 0 || sums.even ? 1 : 2;
        const std::size_t* columns = sums.columnOf + 2 * m;
        const auto rowAt = [&](std::size_t i) HWY_ATTR {
            const std::size_t kind = i < sums.channels ? 0 : 1;
            return sums.spectrum + (i - kind * sums.channels) * sums.columns + columns[kind];
        };
        tiles(kinds * sums.channels, rowAt, ring, {theta, lanes, lanes}, sums.rings, out, lanes);
        theta += sums.rings * lanes;
        out += 2 * sums.channels * lanes;
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace hshfit::inline projection
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hshfit::inline projection {

HWY_EXPORT(products);
HWY_EXPORT(thetaSums);

void addProducts(RowBlock a, ColumnBlock b, std::size_t depth, double* out, std::size_t outStride) {
    HWY_DYNAMIC_DISPATCH(products)(a, b, depth, out, outStride);
}

void addThetaSums(const ThetaSums& sums, double* out) {
    HWY_DYNAMIC_DISPATCH(thetaSums)(sums, out);
}

}  // namespace hshfit::inline projection
#endif  // HWY_ONCE
