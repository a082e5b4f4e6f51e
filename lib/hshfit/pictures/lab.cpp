#include <hshfit/pictures/lab.h>

#include <cmath>
#include <cstddef>

namespace hshfit::inline pictures {
namespace {

using Triple = std::array<double, 3>;

constexpr double toXyz[3][3] = {{0.41239080, 0.35758434, 0.18048079},
                                {0.21263901, 0.71516868, 0.07219232},
                                {0.01933082, 0.11919478, 0.95053215}};
constexpr double fromXyz[3][3] = {{3.24096994, -1.53738318, -0.49861076},
                                  {-0.96924364, 1.87596750, 0.04155506},
                                  {0.05563008, -0.20397696, 1.05697151}};

Triple times(const double (&matrix)[3][3], const Triple& v) {
    Triple result{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) result[i] += matrix[i][j] * v[j];
    return result;
}

const Triple& white() {
    static const Triple xyz = times(toXyz, {1, 1, 1});
    return xyz;
}

}  // namespace

Triple relativeXyz(const LinearRgb& rgb) {
    Triple xyz = times(toXyz, rgb);
    for (std::size_t i = 0; i < 3; ++i) xyz[i] /= white()[i];
    return xyz;
}

LinearRgb rgbOfRelativeXyz(Triple xyz) {
    for (std::size_t i = 0; i < 3; ++i) xyz[i] *= white()[i];
    return times(fromXyz, xyz);
}

Lab labOf(const LinearRgb& rgb) {
    Triple f = relativeXyz(rgb);
    constexpr double delta = 6.0 / 29;
    for (double& t : f)
        t = t > delta * delta * delta ? std::cbrt(t) : t / (3 * delta * delta) + 4.0 / 29;
    return {116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])};
}

}  // namespace hshfit::inline pictures
