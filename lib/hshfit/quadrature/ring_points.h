#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/quadrature/quadrature.h>

#include <cstddef>
#include <vector>

namespace hshfit::inline quadrature {

/// The points of a grid, ring by ring, for callers that need single values and not their azimuth
/// transform (rings.h):
///     RingPoints points(grid);
///     while (points.next()) sum += points.weight(j) * q(points.direction(j)) for each j
/// The points of a ring go once around from the panel's centre, so that the first half of them is
/// one side of it. The grid has to outlive this.
class RingPoints {
public:
    explicit RingPoints(const HemisphereGrid& grid) : grid_(grid) {}
    explicit RingPoints(HemisphereGrid&&) = delete;
    /// Takes the first ring, then the next one; false behind the last. `weight` is then the solid
    /// angle of a point; over the grid they sum to 2 pi. Rings that curves cross differ in `count`.
    bool next();

    std::size_t count() const { return cosine_.size(); }
    double mu() const { return grid_.elevations[next_ - 1].mu; }  ///< cos(theta) of the ring
    DirectionBatch directions() const { return {x_.data(), y_.data(), z_.data(), count()}; }
    Direction direction(std::size_t j) const { return {x_[j], y_[j], z_[j]}; }
    double weight(std::size_t j) const { return weights_[j]; }

private:
    void takeEqual(const HemisphereGrid::Panel& panel);
    void take(const HemisphereGrid::Panel& panel, const std::vector<double>& t,
              const std::vector<double>& weights);

    const HemisphereGrid& grid_;
    std::size_t panel_ = 0, next_ = 0;          ///< of the ring after this one
    std::vector<double> cosine_, sine_, step_;  ///< d phi
    std::vector<double> x_, y_, z_, weights_;
};

}  // namespace hshfit::inline quadrature
