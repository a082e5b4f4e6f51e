#pragma once

#include <brdfs/measured/bsdf_xml/bsdf_xml.h>
#include <brdfs/measured/bsdf_xml/klems_brdf.h>
#include <brdfs/measured/bsdf_xml/tree_brdf.h>

#include "bsdf_xml_patches.h"
#include "bsdf_xml_text.h"

#include <brdfs/measured_files.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

namespace hshfit::test {

/// A copy on the heap of exactly the size, so that a sanitizer detects a read past the end.
inline std::unique_ptr<brdfs::MeasuredBrdf> openBytes(const std::string& xml,
                                                      brdfs::BsdfSide side = brdfs::BsdfSide::front,
                                                      std::string_view wavelength = "visible") {
    const std::vector<unsigned char> copy(xml.begin(), xml.end());
    return brdfs::openBsdfXml({copy.data(), copy.size()}, "memory", side, wavelength);
}

inline double valueOf(const Brdf& brdf, const Direction& wi, const Direction& wo) {
    return evaluate(brdf, wi, wo)[0];
}

/// The x of the file's frame: its front side is seen from behind.
inline double fileX(brdfs::BsdfSide side, double x) {
    return side == brdfs::BsdfSide::front ? -x : x;
}

/// The concentric map in the paper's form, by sectors of azimuth.
inline std::pair<double, double> shirleyChiu(double x, double y) {
    const double r = std::hypot(x, y);
    double phi = std::atan2(y, x);
    if (phi < -pi / 4) phi += 2 * pi;
    double a, b;
    if (phi < pi / 4) {
        a = r, b = phi * a / (pi / 4);
    } else if (phi < 3 * pi / 4) {
        b = r, a = -(phi - pi / 2) * b / (pi / 4);
    } else if (phi < 5 * pi / 4) {
        a = -r, b = (phi - pi) * a / (pi / 4);
    } else {
        b = -r, a = -(phi - 3 * pi / 2) * b / (pi / 4);
    }
    return {(a + 1) / 2, (b + 1) / 2};
}

/// Directions with equal projected solid angle.
inline std::vector<Direction> projectedGrid(int rings, int azimuths) {
    std::vector<Direction> grid;
    for (int k = 0; k < rings; ++k) {
        for (int j = 0; j < azimuths; ++j) {
            const double r = std::sqrt((k + 0.5) / rings);
            const double phi = 2 * pi * (j + 0.37) / azimuths;
            grid.push_back({r * std::cos(phi), r * std::sin(phi), std::sqrt(1 - r * r)});
        }
    }
    return grid;
}

/// Directional-hemispherical reflectance for light from wi, summed over a grid.
inline double reflectanceFrom(const Brdf& brdf, const Direction& wi,
                              const std::vector<Direction>& grid) {
    double sum = 0;
    for (const Direction& wo : grid) sum += valueOf(brdf, wi, wo);
    return pi * sum / static_cast<double>(grid.size());
}

}  // namespace hshfit::test
