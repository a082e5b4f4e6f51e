#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/quadrature/quadrature.h>

#include <cstddef>
#include <vector>

namespace hshfit::inline quadrature {

/// The points of a grid, ring by ring, for callers that need single values and not their azimuth
/// transform (rings.h). The points of a ring go once around from the panel's centre, so that the
/// first half of them is one side of it.
class RingPoints {
public:
    /// Takes the azimuths of a panel.
    void start(const HemisphereGrid::Panel& panel);
    /// Takes a ring of that panel; `weights` are then the solid angles of its points, and sum over
    /// the grid to 2 pi. Rings that curves cross differ in `count`.
    void move(const HemisphereGrid& grid, std::size_t ring);

    std::size_t count() const { return cosine_.size(); }
    DirectionBatch directions() const { return {x_.data(), y_.data(), z_.data(), count()}; }
    Direction direction(std::size_t j) const { return {x_[j], y_[j], z_[j]}; }
    double weight(std::size_t j) const { return weights_[j]; }

private:
    void take(const HemisphereGrid::Panel& panel, const std::vector<double>& t,
              const std::vector<double>& weights);

    std::vector<double> cosine_, sine_, step_;  ///< d phi
    std::vector<double> x_, y_, z_, weights_;
};

}  // namespace hshfit::inline quadrature
