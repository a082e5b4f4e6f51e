#pragma once

#include <array>
#include <cstddef>
#include <mutex>
#include <vector>

namespace hshfit::bases::kernels {

template <class Real>
struct Recurrences;

/// The steps of all columns, row by row: row l takes every column m from function l - 1 to l.
/// Columns come in blocks, so that the state of a block stays in the first-level cache. Row r of
/// block b, l = b columns + r, is `width(b)` slopes, then as many ratios and carries; entries with
/// m >= l hold the start (0, 1, 0). With bands two apart row r serves both rows 2 r and 2 r + 1,
/// since each column has a function in one of them only.
template <class Real>
class StepRows {
public:
    static constexpr std::size_t columns = 64;  ///< 8 KiB of state for four directions in double
    static constexpr std::size_t group = 16;    ///< widths are multiples of the longest vector's

    StepRows() = default;
    /// From the end t = 1 (`side` 0) or t = -1 (1).
    StepRows(const Recurrences<double>& steps, std::size_t side);

    std::size_t blocks() const { return offsets_.size(); }
    std::size_t width(std::size_t block) const { return widths_[block]; }
    const Real* block(std::size_t block) const { return lines_[offsets_[block]].value.data(); }

private:
    static constexpr std::size_t perLine = 64 / sizeof(Real);
    struct alignas(64) Line {
        std::array<Real, perLine> value;
    };
    std::vector<Line> lines_;
    std::vector<std::size_t> offsets_, widths_;
};

/// Both ends' steps, made when they are first asked for.
template <class Real>
struct LazyStepRows {
    mutable std::once_flag once;
    mutable std::array<StepRows<Real>, 2> rows;
};

}  // namespace hshfit::bases::kernels
