#include <hshfit/normal_filtering/mip_layout.h>

#include <hshfit/error.h>

#include <Imath/half.h>
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace hshfit::inline normal_filtering {
namespace {

/// xx, xy, yy of a covariance to standard deviations and their correlation.
void toDeviations(double* m) {
    const double x = std::sqrt(std::max(0.0, m[0])), y = std::sqrt(std::max(0.0, m[2]));
    const double correlation = x * y > 0 ? std::clamp(m[1] / (x * y), -1.0, 1.0) : 0;
    m[0] = x;
    m[1] = correlation;
    m[2] = y;
}
void toCovariance(double* m) {
    const double x = m[0], y = m[2];
    m[0] = x * x;
    m[1] *= x * y;
    m[2] = y * y;
}

}  // namespace

void MipLayout::check(int most) const {
    if (weights < 0 || weights > SurfaceTexel::most || albedos < 0 || albedos > SurfaceTexel::most)
        throw UsageError(fmt::format("{} weights and {} albedos of a texel: 0 to {} are possible",
                                     weights, albedos, SurfaceTexel::most));
    if (order < 1 || order % 2 == 0 || order > most)
        throw UsageError(fmt::format(
            "order {} of filtered normals: an odd number from 1 to {} is needed", order, most));
}

std::vector<double> storedNumbers(std::span<const double> texel) {
    std::vector<double> numbers(texel.begin(), texel.end());
    const double* plane = &numbers[MipLayout::plane];
    double* squares = &numbers[MipLayout::planeSquares];
    squares[0] -= plane[0] * plane[0];
    squares[1] -= plane[0] * plane[1];
    squares[2] -= plane[1] * plane[1];
    toDeviations(squares);
    toDeviations(&numbers[MipLayout::widths]);
    return numbers;
}

void momentsOf(std::span<double> stored) {
    const double* plane = &stored[MipLayout::plane];
    double* squares = &stored[MipLayout::planeSquares];
    toCovariance(squares);
    toCovariance(&stored[MipLayout::widths]);
    squares[0] += plane[0] * plane[0];
    squares[1] += plane[0] * plane[1];
    squares[2] += plane[1] * plane[1];
}

void encodeHalf(const MipLayout& layout, std::span<const double> texel,
                std::span<std::uint16_t> out) {
    const std::vector<double> numbers = storedNumbers(texel);
    for (std::size_t i = 0; i < layout.size(); ++i) {
        const Imath::half stored(static_cast<float>(numbers[i]));
        if (!stored.isFinite())
            throw NumericError(
                fmt::format("number {} of a filtered texel is {:.6g}; half precision ends at 65504",
                            i, numbers[i]));
        out[i] = stored.bits();
    }
}

void decodeHalf(const MipLayout& layout, std::span<const std::uint16_t> stored,
                std::span<double> texel) {
    for (std::size_t i = 0; i < layout.size(); ++i) {
        Imath::half number;
        number.setBits(stored[i]);
        texel[i] = static_cast<float>(number);
    }
    momentsOf(texel);
}

}  // namespace hshfit::inline normal_filtering
