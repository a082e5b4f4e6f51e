#include <hshfit/stability/rotation_errors.h>

#include <hshfit/rotation/sh_rotation.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace hshfit::stability {

DegreeErrors rotationErrors(int order) {
    const ShRotation rotate(order);
    std::mt19937_64 random(1);
    std::vector<double> c(static_cast<std::size_t>(order) * static_cast<std::size_t>(order));
    for (double& value : c) value = static_cast<double>(random() >> 11) * 0x1p-52 - 1;
    DegreeErrors result{"sh", Precision::twice,
                        std::vector<double>(static_cast<std::size_t>(order), 0.0)};
    const Rotation second = Rotation::euler(2.1, 0.9, -0.4);
    for (const Rotation& first : {Rotation::euler(0.3, 1e-4, 1.2), Rotation::euler(0, pi / 2, 0),
                                  Rotation::euler(-1.7, 2.4, 0.8)}) {
        const std::vector<double> twice = rotate.rotate(second, rotate.rotate(first, c));
        const std::vector<double> once = rotate.rotate(second * first, c);
        for (std::size_t l = 0; l < result.error.size(); ++l) {
            double difference = 0, norm = 0;
            for (std::size_t i = l * l; i < (l + 1) * (l + 1); ++i) {
                difference += (twice[i] - once[i]) * (twice[i] - once[i]);
                norm += c[i] * c[i];
            }
            result.error[l] = std::max(result.error[l], std::sqrt(difference / norm));
        }
    }
    return result;
}

}  // namespace hshfit::stability
