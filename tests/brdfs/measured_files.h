#pragma once

#include <hshfit/brdf/directions.h>

#include <temporary_file.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <random>
#include <string>

namespace hshfit::test {

/// A MERL file written cell by cell: value(channel, h, d, p) as stored, before the scale.
using MerlCells = std::function<double(int, int, int, int)>;
inline std::string merlFile(const MerlCells& value, int azimuths = 180) {
    std::string bytes(12 + 3 * std::size_t{8100} * azimuths * 8, '\0');
    const std::int32_t header[3] = {90, 90, azimuths};
    std::memcpy(bytes.data(), header, sizeof header);
    char* to = bytes.data() + 12;
    for (int c = 0; c < 3; ++c)
        for (int h = 0; h < 90; ++h)
            for (int d = 0; d < 90; ++d)
                for (int p = 0; p < azimuths; ++p, to += 8) {
                    const double v = value(c, h, d, p);
                    std::memcpy(to, &v, 8);
                }
    return bytes;
}

/// Uniform on the hemisphere, above `least` = cos(theta).
inline Direction randomDirection(std::mt19937& random, double least = 0.01) {
    const double z = std::uniform_real_distribution<>(least, 1)(random);
    const double phi = std::uniform_real_distribution<>(-pi, pi)(random);
    const double s = std::sqrt(1 - z * z);
    return {s * std::cos(phi), s * std::sin(phi), z};
}

}  // namespace hshfit::test
