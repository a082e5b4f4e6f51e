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

/// A hemisphere cut into cells: `nodes(cell, points)` is a Gauss-Legendre rule with that many
/// points along each coordinate.
struct CellSet {
    std::size_t count = 0;
    std::function<CellNodes(std::size_t cell, int points)> nodes;
};

struct CellAverageOptions {
    double tolerance = 1e-3;
    int firstPoints = 1, mostPoints = 8;
    std::function<void(std::size_t, std::size_t)> progress = {};
};

struct CellAverages {
    std::vector<double> values;  ///< [outgoing][incident], f or luminance in 1/sr
    std::size_t uncertain = 0;   ///< pairs that did not converge to the tolerance
    double worstChange = 0;      ///< of these, relative as below
};

/// The average of f over every pair of cells, weighted with projected solid angle on both sides, so
/// that sums over cells are the directional reflectances of f. Channels are weighted (see
/// luminanceWeights). Two rules are compared for every pair, and points are doubled until they
/// agree to the tolerance, relative to the pair's value or, if that is greater, to the average of
/// the outgoing cell. A lobe between the nodes of the first two rules is missed.
///
/// Parallel over outgoing cells. Throws NumericError where f is negative or not finite.
CellAverages averageOverCells(const Brdf& brdf, const std::vector<double>& weights,
                              const CellSet& incident, const CellSet& outgoing,
                              const CellAverageOptions& options);

/// Weights that turn the channels into luminance (Rec. 709). A sentence on the loss goes to
/// `alterations`. Throws UsageError for spectra that do not cover the visible range.
std::vector<double> luminanceWeights(const Brdf& brdf, std::vector<std::string>& alterations);

}  // namespace hshfit::brdfs
