#pragma once

#include <hshfit/brdf/directions.h>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {

/// The share of d(wi) d(wo) of a cell of a table in half and difference angles (Rusinkiewicz 1998),
/// up to a common factor: 4 cos(theta_d) d(h) d(d), with d(h) and d(d) the solid angles of the half
/// vector and of the difference direction, of which nothing beyond a right angle counts. The cell
/// reaches half an index to either side of the index h, whose theta_h is half(h) in radians, and
/// `step` / 2 to either side of theta_d = `thetaDifference`.
template <class Half>
double cellMeasure(const Half& half, double h, double thetaDifference, double step) {
    const auto band = [](double from, double to) {
        return std::cos(std::max(from, 0.0)) - std::cos(std::min(to, pi / 2));
    };
    const double low = h > 0.5 ? half(h - 0.5) : 0.0;
    return band(low, half(h + 0.5)) * 4 * std::cos(thetaDifference) *
           band(thetaDifference - step / 2, thetaDifference + step / 2);
}

}  // namespace hshfit::brdfs
