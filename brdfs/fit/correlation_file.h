#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace hshfit::brdfs {

/// Correlations of the errors of values at nodes, or in the rows of a scan.
struct CorrelationBlock {
    std::vector<double> nodes;   ///< ascending; of a scan none
    std::vector<double> matrix;  ///< [n * n], diagonal 1
    std::size_t size = 0;        ///< n; 0: no block
};

/// A file of correlations; the errors of two values have the product of its blocks' correlations:
///     {"format": "hshfit-covariance", "version": 1,
///      "wavelength": {"nodes": [450, 550], "matrix": [[1, 0.5], [0.5, 1]]},
///      "angle": {"nodes": [-40, 0, 40], "matrix": …} or "scan": {"matrix": …}}
/// Nodes are in nm, and polar angles of the outgoing direction in degrees, negative on the side of
/// the light. A matrix of covariances counts as its matrix of correlations.
struct CorrelationBlocks {
    std::string path;
    CorrelationBlock wavelength, angle, scan;
};

/// Throws InputError naming file, block and row for what is not square, symmetric and positive
/// definite. At most 2000 nodes.
std::shared_ptr<const CorrelationBlocks> readCorrelations(const std::string& path);

}  // namespace hshfit::brdfs
