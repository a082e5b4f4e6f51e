#pragma once

#include <hshfit/brdf/brdf.h>

#include <cstddef>
#include <vector>

namespace hshfit::brdfs {

/// Weighted sums of f over pairs of directions, such as the radiance of a surface under a light.
struct NodeSums {
    std::vector<double> wiX, wiY, wiZ;
    std::vector<Direction> wo;
    /// Nodes that stand for wi and for its mirror image in the xz plane, in which wo lies: the
    /// factors are of both, and f is the mean of both values. For models of isotropic materials the
    /// two values are equal.
    std::vector<bool> mirrored;
    /// One sum: over the nodes [firstNode, firstNode + nodes) with factors [firstFactor, …). Sums
    /// stand in the order of their nodes; those over the same nodes stand together.
    struct Row {
        std::size_t firstNode = 0, nodes = 0, firstFactor = 0;
    };
    std::vector<Row> rows;
    std::vector<double> factors;

    std::size_t size() const { return wo.size(); }  ///< nodes
};

/// Pairs of directions, one wi for each wo.
struct PairPlaces {
    const double *x = nullptr, *y = nullptr, *z = nullptr;  ///< of wi
    const Direction* wo = nullptr;
    std::size_t count = 0;
};

/// f of a BRDF at the nodes: [channel * size() + node].
std::vector<double> valuesAt(const Brdf& brdf, const NodeSums& sums);

/// The sums of `rows`, [channel * rows + k], of values at the nodes, [channel * nodes + node].
std::vector<double> summed(const NodeSums& sums, const std::vector<std::size_t>& rows,
                           const std::vector<double>& values);

}  // namespace hshfit::brdfs
