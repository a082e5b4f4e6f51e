#pragma once

#include <hshfit/rotation/rotation.h>

#include <array>
#include <cstddef>
#include <span>

namespace hshfit::inline rotation {
namespace kernels {

/// Bands below this are rotated one vector a lane, by kernels unrolled at compile time.
constexpr int shortBands = 10;

/// The entries of J (quarter_turns.h) that differ from 0, block by block, in the kernel's order.
class ShortTable {
public:
    /// `entry(l, m1, m2)` is J with cosines for m >= 0 and sines for m < 0.
    template <class Entry>
    explicit ShortTable(Entry entry) {
        double* next = entries_.data();
        const auto block = [&](int l, int rows, int first, int columns, int second) {
            for (int i = 0; i < rows; ++i)
                for (int j = 0; j < columns; ++j)
                    *next++ = entry(l, first + (first < 0 ? -2 : 2) * i, second + 2 * j);
        };
        const auto square = [&](int l, int size, int first) {
            for (int i = 0; i < size; ++i)
                for (int j = 0; j < size; ++j) {
                    const int step = first < 0 ? -2 : 2;
                    *next++ = entry(l, first + step * i, first + step * j);
                }
        };
        for (int l = 1; l < shortBands; ++l) {
            const int h = l / 2;
            if (l % 2 == 0) {
                square(l, h + 1, 0);
                square(l, h, -1);
                block(l, h, -2, h, 1);
            } else {
                square(l, h + 1, 1);
                square(l, h, -2);
                block(l, h + 1, -1, h + 1, 0);
            }
        }
    }
    const double* data() const { return entries_.data(); }

    /// The entries of one band. The last block serves twice, also transposed.
    static constexpr std::size_t entries(int l) {
        const auto h = static_cast<std::size_t>(l / 2);
        return (h + 1) * (h + 1) + h * h + (l % 2 == 0 ? h * h : (h + 1) * (h + 1));
    }
    static constexpr std::size_t offset(int l) {
        return l <= 1 ? 0 : offset(l - 1) + entries(l - 1);
    }

private:
    std::array<double, 254> entries_{};
};
static_assert(ShortTable::offset(shortBands) == 254);

/// `count` vectors, vector k under rotations[k / channels]: bands 0 .. bands - 1 (at most
/// shortBands) of in[k * stride + slot] to the same place of out, which may be the same array.
struct ShortBatch {
    std::span<const Rotation> rotations;
    std::size_t channels, count, stride;
    int bands;
    const double* in;
    double* out;
};
void rotateShort(const ShortTable& table, const ShortBatch& batch);

}  // namespace kernels
}  // namespace hshfit::inline rotation
