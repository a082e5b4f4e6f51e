#pragma once

#include <hshfit/brdf/directions.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace hshfit::inline sampling {

/// Polar coordinates about the mirror point of wo in the unit disc; psi = 0 points to the centre.
class MirrorPolar {
public:
    explicit MirrorPolar(const Direction& wo)
        : sine_(std::hypot(wo.x, wo.y)),
          square_(wo.z * wo.z),
          c_(sine_ > 0 ? wo.x / sine_ : 1),
          s_(sine_ > 0 ? wo.y / sine_ : 0),
          wo_(wo) {}

    /// The distance to the edge: the positive root of r^2 - 2 r sine cos psi = cos^2 theta_o.
    double reach(double cosPsi) const {
        const double along = sine_ * cosPsi, root = std::sqrt(along * along + square_);
        return along > 0 ? along + root : square_ / (root - along);
    }
    /// At `share` of the way to the edge. The height is a product, which keeps its digits.
    Direction direction(double share, double cosPsi, double sinPsi) const {
        const double most = reach(cosPsi), r = share * most;
        const double x = r * cosPsi, y = r * sinPsi;
        const double height = (1 - share) * (share * most * most + square_);
        return {c_ * x - s_ * y - wo_.x, s_ * x + c_ * y - wo_.y,
                std::max(std::sqrt(height), std::numeric_limits<double>::min())};
    }
    struct Place {
        double share, psi, reach;
    };
    Place place(const Direction& wi) const {
        const double x = wi.x + wo_.x, y = wi.y + wo_.y;
        const double u = c_ * x + s_ * y, v = c_ * y - s_ * x, r = std::hypot(u, v);
        const double most = reach(r > 0 ? u / r : 1);
        return {std::min(1.0, r / most), std::atan2(v, u), most};
    }

private:
    double sine_, square_, c_, s_;
    Direction wo_;
};

/// Ends of rows, as shares of the distance, and of columns in psi, from -pi to pi.
struct MirrorCells {
    std::vector<double> radii, angles;

    explicit MirrorCells(std::size_t columns) {
        radii.push_back(0);
        for (int half = -2 * 28; half < -2 * 6; ++half) radii.push_back(std::exp2(half / 2.0));
        for (int eighth = -8 * 6; eighth <= 0; ++eighth) radii.push_back(std::exp2(eighth / 8.0));
        const double side = static_cast<double>(columns) / 2;
        for (std::size_t k = 0; k <= columns; ++k) {
            const double t = static_cast<double>(k) / side - 1;
            angles.push_back(pi * t * std::abs(t));
        }
    }
    std::size_t rows() const { return radii.size() - 1; }
    std::size_t columns() const { return angles.size() - 1; }
    /// Half the difference of squares, times the angle: the area for a reach of 1.
    double area(std::size_t row, std::size_t column) const {
        return 0.5 * (radii[row + 1] - radii[row]) * (radii[row + 1] + radii[row]) *
               (angles[column + 1] - angles[column]);
    }
    std::size_t rowOf(double share) const { return at(radii, share); }
    std::size_t columnOf(double psi) const { return at(angles, psi); }

    /// The k with ends[k] <= value < ends[k + 1].
    template <class Ends, class Value>
    static std::size_t at(const Ends& ends, Value value) {
        const auto above = std::upper_bound(ends.begin(), ends.end(), value) - ends.begin();
        return static_cast<std::size_t>(
            std::clamp<std::ptrdiff_t>(above - 1, 0, static_cast<std::ptrdiff_t>(ends.size()) - 2));
    }
};

}  // namespace hshfit::inline sampling
