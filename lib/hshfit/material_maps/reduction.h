#pragma once

#include <hshfit/material_maps/processes.h>
#include <hshfit/material_maps/texel_kernel.h>
#include <hshfit/material_maps/texel_layout.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace hshfit::inline material_maps {

/// Texels as weights of a few shapes that all of them share,
///     x_c = sum_{r < rank} y_{c,r} B_r + rest,
/// with B orthonormal in the norm of the layout (Parseval: squares of f over all incoming and, with
/// their solid angles, outgoing directions), so that y is the best that these shapes can do and the
/// norm of the rest is its error.
class LowRank {
public:
    /// shapes[rank][layout.shape()], orthonormal.
    LowRank(const TexelLayout& layout, std::vector<double> shapes);

    std::size_t rank() const { return rank_; }
    std::size_t weightsOfTexel() const { return layout_.channels * rank_; }
    const std::vector<double>& shapes() const { return shapes_; }

    /// Weights [channel][rank] of a texel of layout.floats(); the norm of the rest is returned.
    float reduce(const float* texel, float* weights) const;
    /// The texel of these weights.
    void restore(const float* weights, float* texel) const;

private:
    TexelLayout layout_;
    std::size_t rank_, padded_;  ///< length of a direction
    std::vector<double> shapes_;
    std::vector<float> roots_;       ///< of the weights, [outgoing]
    std::vector<float> directions_;  ///< [rank][outgoing][slot] times these roots, padded
    std::vector<float> back_;        ///< [rank][outgoing][slot]
};

/// Errors of texels, each relative to its own norm; black texels count as exact.
struct TexelErrors {
    double mean = 0;
    double percentile99 = 0;
    double maximum = 0;
};

/// The shapes that are best in the mean over texels of the square of the relative error (principal
/// components of the shapes of all channels, about zero, each texel divided by its norm).
/// texels[count][layout.floats()]; all processes have all of them and share the work.
class PrincipalShapes {
public:
    PrincipalShapes(const TexelLayout& layout, std::span<const float> texels, Processes& processes);

    /// The number of shapes: at most layout.shape(), and no more than the numerical rank.
    std::size_t most() const { return most_; }
    LowRank lowRank(std::size_t rank) const;
    /// The errors over the texels for every rank up to `most()`: [rank - 1].
    std::vector<TexelErrors> errors(std::span<const float> texels, Processes& processes) const;

private:
    TexelLayout layout_;
    std::size_t most_ = 0;
    std::vector<double> shapes_;
};

/// Points with the weight of each, [count][dimensions].
struct WeightedPoints {
    std::span<const float> points;
    std::span<const float> weights;
    std::size_t dimensions = 1;
};

/// Settings of `clusterCentres`; the seed is for the random starts.
struct ClusterOptions {
    std::size_t clusters = 256;
    int mostRounds = 40;
    std::uint64_t seed = 1;
    std::function<void(std::size_t done, std::size_t total)> progress = {};
    Processes* processes = nullptr;  ///< that share the work; each has all points
};

/// Centres that make the weighted sum of squared distances small: k-means (Lloyd 1982) from starts
/// by k-means++ (Arthur & Vassilvitskii 2007), a local minimum. At most as many centres as there
/// are different points. Deterministic, on any number of threads and processes.
/// [centre][dimension]
std::vector<float> clusterCentres(const WeightedPoints& points, const ClusterOptions& options);

/// Sorted in place.
TexelErrors errorsOf(std::vector<float>& relative);

}  // namespace hshfit::inline material_maps
