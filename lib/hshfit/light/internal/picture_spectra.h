#pragma once

#include <cstddef>
#include <vector>

namespace hshfit::inline light {

/// Columns of a spectrum: cos(m phi) and sin(m phi) side by side, even m before odd m, each kind
/// filled up to whole groups; m < order.
struct SpectrumColumns {
    static constexpr std::size_t group = 8;
    std::size_t order, even, odd;
    explicit SpectrumColumns(int bands)
        : order(static_cast<std::size_t>(bands)),
          even((order + 1) / 2 * 2),
          odd(order / 2 * 2),
          evens((even + group - 1) / group * group),
          all(evens + (odd + group - 1) / group * group) {}
    std::size_t evens, all;  ///< with the filling
    std::size_t of(std::size_t m, bool sine) const {
        return (m % 2 == 0 ? m : evens + m - 1) + (sine ? 1 : 0);
    }
};

/// cos(pi k / (2 quarter)), k < 4 quarter.
std::vector<double> wavesOf(std::size_t quarter);

/// Real Fourier sums over `count` values by a fast transform: any count, of which the power of two
/// (to 4096) is transformed in radix 2 and the rest summed.
struct FourierPlan {
    std::size_t count, base;
    std::vector<double> twiddles;  ///< at 2 (n / 4 + k): cosine, tangent of 2 pi k / n, k < n / 4
    std::vector<double> waves;     ///< wavesOf(count)
    explicit FourierPlan(std::size_t values);
};

/// Tables of the sums of low orders, whose rows are transformed in the lanes that they come in.
struct ShortPlan {
    static constexpr std::size_t points = 32;  ///< of the transforms within a row
    static constexpr int mostOrder = 32;
    std::size_t order = 0, width = 0;
    /// [group of 8 of the values of 1/32 row][m][cosine, sine][8]
    std::vector<double> table;
    ShortPlan(int bands, std::size_t columns);
    static bool serves(int bands, std::size_t columns) {
        return bands <= mostOrder && columns % points == 0;
    }
};

/// Rows of a latitude-longitude picture, [row][column][R, G, B], to their sums over columns of
/// value times cos(m psi) and sin(m psi), psi = 2 pi (column + 1/2) / width:
/// out[row][R, G, B][column of the spectrum], and the sums of squares, squares[row][R, G, B].
/// The two differ by rounding. A sum depends on its row alone.
void pictureSpectra(const FourierPlan& plan, const SpectrumColumns& columns, const float* rows,
                    std::size_t count, double* out, double* squares);
void pictureSpectra(const ShortPlan& plan, const SpectrumColumns& columns, const float* rows,
                    std::size_t count, double* out, double* squares);

/// Sums over `plan.count` rows r of in[r * stride + i] times cos(j theta_r) or sin(j theta_r),
/// theta_r = pi (r + 1/2) / count, to out[j * stride + i], i < SpectrumColumns::group, j < degrees,
/// each times factors[j].
void colatitudeSums(const FourierPlan& plan, bool sine, const double* in, std::size_t stride,
                    std::size_t degrees, const double* factors, double* out);

/// The sum of all values of a row: one pass over its pixels, to compare with.
double sumPictureRow(const float* row, std::size_t width);

}  // namespace hshfit::inline light
