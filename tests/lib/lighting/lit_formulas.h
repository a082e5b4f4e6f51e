#pragma once

#include <hshfit/bases/catalog.h>
#include <hshfit/light/lights.h>

#include <lib/formula_brdf.h>

#include <cmath>
#include <memory>

namespace hshfit::lighting {

inline Light uniformLight() {
    return SkyLight{.zenith = {1, 1, 1}, .ground = {1, 1, 1}};
}

/// 1 + slope . w.
inline Light linearLight(const Direction& slope) {
    auto c = std::make_shared<LightCoefficients>();
    c->basis = "sh";
    c->order = 2;
    const double one = std::sqrt(4 * pi), first = std::sqrt(4 * pi / 3);
    for (int k = 0; k < 3; ++k)
        for (const double value : {one, slope.y * first, slope.z * first, slope.x * first})
            c->values.push_back(value);
    return CoefficientLight{.file = "",
                            .coefficients = c,
                            .basis = bases::make("sh", 2),
                            .tangent = {1, 0, 0},
                            .bitangent = {0, 1, 0},
                            .normal = {0, 0, 1}};
}

}  // namespace hshfit::lighting
