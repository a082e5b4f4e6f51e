#pragma once

#include "models_grid.h"

#include <gtest/gtest.h>

#include <functional>

namespace hshfit::brdfs {

/// A pair of directions in the papers' angles: polar angles and azimuths of both directions and of
/// the half vector.
struct Angles {
    double thetaI, phiI, thetaO, phiO, thetaH, phiH;
    double cosHO;  ///< between half vector and wo

    explicit Angles(const Pair& p)
        : thetaI(std::acos(p.wi.z)),
          phiI(std::atan2(p.wi.y, p.wi.x)),
          thetaO(std::acos(p.wo.z)),
          phiO(std::atan2(p.wo.y, p.wo.x)) {
        const double x = p.wi.x + p.wo.x, y = p.wi.y + p.wo.y, z = p.wi.z + p.wo.z;
        const double length = std::sqrt(x * x + y * y + z * z);
        thetaH = std::atan2(std::hypot(x, y), z);
        phiH = std::atan2(y, x);
        cosHO = (x * p.wo.x + y * p.wo.y + z * p.wo.z) / length;
    }
    double cosAlpha() const {  // about the mirror direction of wo
        return std::cos(thetaI) * std::cos(thetaO) -
               std::sin(thetaI) * std::sin(thetaO) * std::cos(phiI - phiO);
    }
};

inline double square(double x) {
    return x * x;
}

/// Compares pairs away from grazing angles, where acos loses digits.
inline void expectFormula(const std::string& spec,
                          const std::function<double(const Angles&)>& formula,
                          std::size_t channel = 0) {
    SCOPED_TRACE(spec);
    const auto brdf = open(spec);
    Directions directions(21);
    int compared = 0;
    for (int i = 0; i < 400; ++i) {
        const Direction wo = directions.next();
        const Direction wi = i % 2 ? directions.next() : directions.near(mirrored(wo), .2);
        if (wo.z < .02 || wi.z < .02) continue;
        const double expected = formula(Angles({wi, wo}));
        const double value = evaluate(*brdf, wi, wo).at(channel);
        ASSERT_NEAR(value, expected, 1e-9 * std::max(expected, 1e-6)) << i;
        ++compared;
    }
    EXPECT_GT(compared, 300);
}

/// integral over the hemisphere of half vectors, by the midpoint rule in azimuth and in
/// v = log of the slope.
inline double overHalfVectors(const std::function<double(double theta, double phi)>& integrand) {
    double sum = 0;
    const int azimuths = 200, steps = 600;
    const double low = -12, high = 16, dv = (high - low) / steps;
    for (int j = 0; j < azimuths; ++j)
        for (int k = 0; k < steps; ++k) {
            const double slope = std::exp(low + (k + .5) * dv);
            const double solidAngle = slope * slope * dv / std::pow(1 + slope * slope, 1.5);
            sum += integrand(std::atan(slope), 2 * pi * (j + .5) / azimuths) * solidAngle;
        }
    return sum * 2 * pi / azimuths;
}

}  // namespace hshfit::brdfs
