// Sums of column_products.h. Included by column_products.cpp once for each instruction set.

#include <brdfs/lanes/lanes.h>

#include <algorithm>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

/// A block of products that fits the registers; columns past the last repeat it.
class ProductBlock {
public:
    static constexpr std::size_t rows = 3, columns = 4;

    HWY_ATTR static void add(const ColumnSpan& a, std::size_t i, const ColumnSpan& b, std::size_t j,
                             std::size_t length, double* out, std::size_t outStride) {
        const Lanes::Tag tag;
        const double *as[rows], *bs[columns];
        for (std::size_t r = 0; r < rows; ++r)
            as[r] = a.first + std::min(i + r, a.columns - 1) * a.stride;
        for (std::size_t c = 0; c < columns; ++c)
            bs[c] = b.first + std::min(j + c, b.columns - 1) * b.stride;
        Lanes::Vector sums[rows][columns];
        for (auto& row : sums)
            for (auto& sum : row) sum = hn::Zero(tag);
        const std::size_t lanes = hn::Lanes(tag), whole = length / lanes * lanes;
        for (std::size_t k = 0; k < whole; k += lanes) {
            Lanes::Vector left[rows];
            for (std::size_t r = 0; r < rows; ++r) left[r] = hn::LoadU(tag, as[r] + k);
            for (std::size_t c = 0; c < columns; ++c) {
                const auto value = hn::LoadU(tag, bs[c] + k);
                for (std::size_t r = 0; r < rows; ++r)
                    sums[r][c] = hn::MulAdd(left[r], value, sums[r][c]);
            }
        }
        for (std::size_t r = 0; r < rows && i + r < a.columns; ++r)
            for (std::size_t c = 0; c < columns && j + c < b.columns; ++c) {
                double sum = hn::GetLane(hn::SumOfLanes(tag, sums[r][c]));
                for (std::size_t k = whole; k < length; ++k) sum += as[r][k] * bs[c][k];
                out[(i + r) + (j + c) * outStride] += sum;
            }
    }
};

void addProductsOf(const ColumnSpan& a, const ColumnSpan& b, std::size_t length, double* out,
                   std::size_t outStride, bool lower) {
    for (std::size_t i = 0; i < a.columns; i += ProductBlock::rows)
        for (std::size_t j = 0; j < b.columns; j += ProductBlock::columns)
            if (!lower || j < i + ProductBlock::rows)
                ProductBlock::add(a, i, b, j, length, out, outStride);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
