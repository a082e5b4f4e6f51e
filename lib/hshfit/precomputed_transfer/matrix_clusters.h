#pragma once

#include <hshfit/precomputed_transfer/lit_transfer.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace hshfit::inline precomputed_transfer {

/// The distance of compressed matrices from the given ones, by the number of components.
struct ClusterError {
    std::size_t clusters = 0, components = 0;
    std::size_t bytes = 0;     ///< of float32 means, components and weights, and of cluster numbers
    double relativeL2 = 0;     ///< root of the sum of squares over the matrices'
    double largest = 0;        ///< of a vertex, over the root of the mean square
    std::uint32_t vertex = 0;  ///< of the largest
};

/// Matrices by clustered principal components (Sloan, Hall, Hart, Snyder 2003):
///     M_p = mean_c + sum over k of w_pk B_ck,   c the cluster of p.
/// The product with light is made once for each mean and component, and so costs a vertex
/// `components` additions of local vectors instead of a matrix product.
struct MatrixClusters {
    std::size_t clusters = 0, components = 0;
    std::size_t dimension = 0;              ///< channels x j x i
    std::vector<float> means = {};          ///< [cluster][dimension]
    std::vector<float> basis = {};          ///< [cluster][component][dimension], orthonormal
    std::vector<std::uint32_t> of = {};     ///< [vertex] its cluster
    std::vector<float> weights = {};        ///< [vertex][component]
    std::vector<ClusterError> errors = {};  ///< by components, from 0

    /// The same with fewer components, which are the first of these.
    MatrixClusters truncated(std::size_t components) const;
    /// The matrix of a vertex.
    std::vector<float> matrix(std::size_t vertex) const;
};

struct ClusterOptions {
    std::size_t clusters = 64;
    std::size_t components = 12;  ///< the most
    int rounds = 4;               ///< vertices go to the cluster that holds them best, each time
    std::function<void(std::size_t done, std::size_t total)> progress = {};
};

/// Clusters start as k-means finds them over 24 principal coordinates of all matrices. Clusters
/// with fewer vertices than components have zeros in the rest. The result does not depend on the
/// number of threads. Throws UsageError without matrices or clusters.
MatrixClusters clusterMatrices(const TransferView& transfer, const ClusterOptions& options = {});

}  // namespace hshfit::inline precomputed_transfer
