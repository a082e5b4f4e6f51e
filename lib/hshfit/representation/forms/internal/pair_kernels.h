#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace hshfit::inline representation::inline forms {

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

/// Up to four rows of coefficients to mix, [channel][stride] each, with their weights.
struct RowMix {
    const float* rows[4] = {};
    float weights[4] = {};
    int count = 0;
};

/// Basis values [k][length] against a mix of rows for each of `count` pairs.
struct MixedDots {
    const float* basis;
    std::size_t length, stride;  ///< rows have `stride` values a channel, 0 from `length` on
    std::size_t channels, count, outStride;
};

/// out[c * outStride + k] = sum over i < length of basis[k][i] sum over rows of weight row[c][i].
void dotMixed(const MixedDots& dots, const RowMix* mixes, float* out);

}  // namespace hshfit::inline representation::inline forms
