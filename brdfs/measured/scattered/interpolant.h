#pragma once

#include <brdfs/measured/scattered/chart.h>

#include <cstddef>
#include <memory>
#include <vector>

namespace hshfit::brdfs {

/// Interpolation of values at scattered points of 1 to 4 dimensions: the modified Shepard method
/// with linear nodal functions (Franke & Nielson 1980, 10.1002/nme.1620151110; Renka 1988,
/// 10.1145/45054.45055):
///     f(x) = sum_k w_k Q_k(x) / sum_k w_k,      w_k = (max(0, R - d_k) / (R d_k))^2
/// over the nearest nodes (3, 7, 12 or 20 for 1 to 4 dimensions); d_k is the distance of node k, R
/// the distance of the next node. Q_k goes through node k. Its slope is a weighted least-squares
/// fit to the node's neighbours, and it is clamped between the least and the greatest value among
/// them.
///
/// f is continuous, interpolates the nodes, and stays in the range of the neighbours' values. It
/// reproduces linear data but for the effect of the clamp: below 1 % of the data's range between
/// random nodes, 0 between even ones (scattered_test). It does not depend on the number of
/// threads. Points within 2e-4 of each other become one, with the mean of their values. Building
/// takes O(n log n), an evaluation O(log n) plus the sum.
class ScatterInterpolant {
public:
    /// For each member of a run of points that come from one sample, 1 if it is the image for
    /// exchanged directions. The first is the sample itself.
    using Exchanged = std::vector<unsigned char>;
    /// Samples of one place, some of them by their exchanged image. If the means of the two kinds
    /// differ by more than 1e-3 of the larger, the node has the first of them.
    struct BothOrders {
        std::size_t sample = 0, exchangedSample = 0;  ///< the first of each kind
        std::vector<double> value, exchanged;         ///< their means, one per channel
        bool contradict = false;
    };
    /// The last search of a thread: the next one, near by, is faster with it, and finds the same.
    struct Trail {
        Point at{};
        double reach = -1;  ///< distance of the last neighbour; below 0: no search yet
    };

    /// values[point * channels + channel]. At least one point, every coordinate and value finite.
    ScatterInterpolant(int dimensions, std::vector<Point> points, const std::vector<double>& values,
                       std::size_t channels, const Exchanged& exchanged = Exchanged(1));
    ~ScatterInterpolant();
    ScatterInterpolant(const ScatterInterpolant&) = delete;
    ScatterInterpolant& operator=(const ScatterInterpolant&) = delete;

    std::size_t nodes() const;
    /// Writes out[channel * stride] and returns the distance to the nearest node; beyond `limit`
    /// only the distance is found and zeros are written.
    double evaluate(const Point& x, double limit, double* out, std::size_t stride,
                    Trail* trail = nullptr) const;
    double nearest(const Point& x) const;
    /// The places where samples and exchanged images of others meet, in the order of the nodes.
    const std::vector<BothOrders>& bothOrders() const;

private:
    struct Nodes;
    std::unique_ptr<Nodes> nodes_;
};

}  // namespace hshfit::brdfs
