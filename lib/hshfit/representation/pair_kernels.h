#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace hshfit {

/// A sparse bilinear form for a few channels: v_c(k) = sum over entries of
/// values[entry][c] rows[row(entry)][k] columns[column(entry)][k].
struct BilinearForm {
    std::size_t channels = 0;
    std::vector<std::uint32_t> rowStarts;  ///< entries of row r: rowStarts[r] .. rowStarts[r + 1]
    std::vector<std::uint32_t> rows;       ///< which row function each row takes
    std::vector<std::uint32_t> columns;    ///< per entry
    std::vector<float> values;             ///< [entry][channel]
};

/// Lanes that `count` below has to be a multiple of: the widest vector of any instruction set.
constexpr std::size_t pairPadding = 16;

/// out[c * count + k] for k < count; rows and columns are [function][count].
void sumBilinear(const BilinearForm& form, const float* rows, const float* columns,
                 std::size_t count, float* out);

/// Up to four rows of coefficients to mix, [channel][length] each, with their weights.
struct RowMix {
    const float* rows[4] = {};
    float weights[4] = {};
    int count = 0;
};

/// out[c] = sum over k < length of basis[k] sum over rows of weight row[c][k]. `length` is a
/// multiple of `pairPadding`.
void dotMixed(const RowMix& mix, const float* basis, std::size_t length, std::size_t channels,
              float* out);

}  // namespace hshfit
