#pragma once

#include <hshfit/bases/basis.h>
#include <hshfit/brdf/directions.h>
#include <hshfit/linear_algebra/descend.h>

#include <array>
#include <cstddef>
#include <vector>

namespace hshfit::inline representation::inline constraints {

/// A grid over the hemisphere on which sums over a basis are searched for local minima: polar
/// angles from the pole to the horizon, both included, times azimuths, at least `density` nodes
/// per wavelength of the highest band in both directions. `even`: sums are even in phi, and half
/// the azimuths do.
class HemisphereScan {
public:
    HemisphereScan(const Basis& basis, bool even, int density = coarse);
    /// To find where a sum is negative, and to make sure that nothing was missed.
    static constexpr int coarse = 8, fine = 24;

    std::size_t size() const { return polar_.size() * azimuths_.size(); }
    double polar(std::size_t node) const { return polar_[node / azimuths_.size()]; }
    double azimuth(std::size_t node) const { return azimuths_[node % azimuths_.size()]; }
    /// Steps of a search around a node: along the radius and across it, in the chart.
    std::array<SearchAxis, 2> axesAt(std::size_t node) const;
    /// The direction at such offsets from a node, in the plane of theta (cos phi, sin phi), where
    /// the pole is a point like others; held at the horizon.
    Direction offset(std::size_t node, double along, double across) const;
    /// The last polar angle: so near the horizon that nothing changes on the way.
    static double horizon();

    /// values[node] = sum over slots of c B.
    void synthesise(const double* c, double* values) const;
    /// Nodes with a value below `threshold` that no neighbour undercuts; `alongLines`: neither of
    /// the two neighbours along some line of the grid or its diagonals, which finds the floors of
    /// valleys all along.
    std::vector<std::size_t> minima(const double* values, double threshold, bool alongLines) const;

private:
    int order_;
    bool even_;
    double polarStep_, azimuthStep_;
    std::vector<double> polar_, azimuths_;
    std::vector<std::vector<double>> theta_;  ///< per m >= 0: [l - m][polar]
    std::vector<double> azimuthParts_;        ///< [azimuth][order - 1 + m]
};

}  // namespace hshfit::inline representation::inline constraints
