#pragma once

#include <hshfit/brdf/brdf.h>

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace hshfit::brdfs {

/// Directions within a cell with weights that add up to 1: averages by projected solid angle.
struct CellNodes {
    std::vector<double> x, y, z, weight;
    void add(const Direction& d, double w);
};

/// A hemisphere cut into cells.
struct CellSet {
    std::size_t count = 0;
    /// A Gauss-Legendre rule with that many points along each coordinate.
    std::function<CellNodes(std::size_t cell, int points)> nodes;
    /// The unit square onto a cell: equal areas are equal projected solid angles.
    std::function<Direction(std::size_t cell, double u, double v)> at;
};

struct CellAverageOptions {
    double tolerance = 1e-3;
    int firstPoints = 1;
    /// Evaluations of f after which no pair is refined; the first two rules are always taken.
    double evaluations = 2e7;
    std::function<void(std::size_t, std::size_t)> progress = {};
};

struct CellAverages {
    std::vector<double> values;  ///< [outgoing][incident], f or luminance in 1/sr
    std::size_t uncertain = 0;   ///< pairs that did not converge to the tolerance
    double worstChange = 0;      ///< of these, relative as below
    double typicalChange = 0;    ///< over all pairs: sum of last changes over the sum of values
};

/// The average of f over every pair of cells, weighted with projected solid angle on both sides, so
/// that sums over cells are the directional reflectances of f. Channels are weighted (see
/// luminanceWeights). Two Gauss rules are compared for every pair, the second with twice the points
/// along each coordinate. Where they differ by more than the tolerance, relative to the pair's
/// value or, if that is greater, to the average of the outgoing cell, a third rule follows, and
/// others where rules converge; elsewhere points in a low-discrepancy order, four times as many in
/// each round, since Gauss rules gain nothing where f has steps within a cell. Pairs with the
/// greatest changes go first, until all agree or the evaluations are spent. A lobe between the
/// nodes of the first two rules is missed.
///
/// Parallel; the averages do not depend on the number of threads. Throws NumericError where f is
/// negative or not finite.
CellAverages averageOverCells(const Brdf& brdf, const std::vector<double>& weights,
                              const CellSet& incident, const CellSet& outgoing,
                              const CellAverageOptions& options);

/// Weights that turn the channels into luminance (Rec. 709). A sentence on the loss goes to
/// `alterations`. Throws UsageError for spectra that do not cover the visible range.
std::vector<double> luminanceWeights(const Brdf& brdf, std::vector<std::string>& alterations);

}  // namespace hshfit::brdfs
