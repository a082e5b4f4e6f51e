#include <brdfs/measured/scattered/interpolant.h>

#include <tbb/parallel_for.h>
#include <Eigen/Eigenvalues>
#include <nanoflann.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>

namespace hshfit::brdfs {
namespace {

/// 0.011 degrees: below the resolution of goniometers, and above the rounding of angles in files.
constexpr double sameNode = 2e-4;
constexpr double onNode = 1e-12;
constexpr std::size_t mostNeighbours = 40;

/// The number of neighbours of an evaluation, and of the fit of a slope.
constexpr std::size_t weighed[] = {0, 3, 7, 12, 20};
constexpr std::size_t fitted[] = {0, 4, 10, 20, 36};
static_assert(weighed[4] + 1 <= mostNeighbours && fitted[4] + 2 <= mostNeighbours);

/// The interface that nanoflann requires of a set of points.
struct Cloud {
    std::vector<Point> points;

    std::size_t kdtree_get_point_count() const { return points.size(); }
    double kdtree_get_pt(std::size_t k, std::size_t dimension) const {
        return points[k][dimension];
    }
    template <class Box>
    bool kdtree_get_bbox(Box&) const {
        return false;
    }
};

struct Neighbours {
    std::size_t count = 0;
    std::uint32_t index[mostNeighbours];
    double distance[mostNeighbours];  ///< ascending
};

class Tree {
public:
    virtual ~Tree() = default;
    /// The nearest `count` points; all of them have to lie within `bound` of x.
    virtual void find(const Point& x, std::size_t count, Neighbours& found,
                      double bound = std::numeric_limits<double>::infinity()) const = 0;
    /// All points within `radius`, in ascending order of their indices.
    virtual std::vector<std::uint32_t> within(const Point& x, double radius) const = 0;
};

template <int Dimensions>
class TreeOf : public Tree {
public:
    explicit TreeOf(const Cloud& cloud)
        : index_(Dimensions, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(8)) {
        index_.buildIndex();
    }
    void find(const Point& x, std::size_t count, Neighbours& found, double bound) const override {
        nanoflann::KNNResultSet<double, std::uint32_t> set(count);
        set.init(found.index, found.distance);
        // The set takes its last distance for the largest that it still wants.
        found.distance[count - 1] = bound * bound;
        index_.findNeighbors(set, x.data(), nanoflann::SearchParams());
        found.count = set.size();
        for (std::size_t k = 0; k < found.count; ++k) {
            found.distance[k] = std::sqrt(found.distance[k]);
        }
    }
    std::vector<std::uint32_t> within(const Point& x, double radius) const override {
        std::vector<std::pair<std::uint32_t, double>> hits;
        index_.radiusSearch(x.data(), radius * radius, hits, nanoflann::SearchParams());
        std::vector<std::uint32_t> found;
        for (const auto& hit : hits) found.push_back(hit.first);
        std::ranges::sort(found);
        return found;
    }

private:
    using Metric = nanoflann::L2_Simple_Adaptor<double, Cloud>;
    nanoflann::KDTreeSingleIndexAdaptor<Metric, Cloud, Dimensions, std::uint32_t> index_;
};

std::unique_ptr<Tree> plant(int dimensions, const Cloud& cloud) {
    switch (dimensions) {
        case 1:
            return std::make_unique<TreeOf<1>>(cloud);
        case 2:
            return std::make_unique<TreeOf<2>>(cloud);
        case 3:
            return std::make_unique<TreeOf<3>>(cloud);
        default:
            assert(dimensions == 4);
            return std::make_unique<TreeOf<4>>(cloud);
    }
}

double shepardWeight(double distance, double radius) {
    const double rest = std::max(0.0, radius - distance) / (radius * distance);
    return rest * rest;
}

/// The mean of the values of some points.
std::vector<double> meanOf(const std::vector<std::size_t>& points, const std::vector<double>& given,
                           std::size_t channels) {
    std::vector<double> mean(channels, 0.0);
    for (const std::size_t point : points)
        for (std::size_t c = 0; c < channels; ++c) mean[c] += given[point * channels + c];
    for (double& sum : mean) sum /= static_cast<double>(points.size());
    return mean;
}

bool differ(const std::vector<double>& a, const std::vector<double>& b) {
    constexpr double alike = 1e-3;
    for (std::size_t c = 0; c < a.size(); ++c)
        if (std::fabs(a[c] - b[c]) > alike * std::max(std::fabs(a[c]), std::fabs(b[c])))
            return true;
    return false;
}

}  // namespace

struct ScatterInterpolant::Nodes {
    int dimensions = 0;
    std::size_t channels = 0;
    Cloud cloud;
    std::unique_ptr<Tree> tree;
    // Per node, channel by channel: value, slope in each dimension, least and greatest of Q.
    std::vector<double> values, slopes, least, greatest;
    std::vector<BothOrders> bothOrders;

    void merge(const std::vector<Point>& points, const std::vector<double>& given,
               const Exchanged& isExchanged);
    void addNode(const std::vector<std::size_t>& group, const std::vector<double>& given,
                 const Exchanged& isExchanged);
    void fitSlopes();
    void fitSlope(std::size_t node);
    double radius(const Neighbours& found, std::size_t wanted) const;
};

/// One node of all points of a group: their mean, or the mean of the samples themselves where
/// exchanged images of others contradict them.
void ScatterInterpolant::Nodes::addNode(const std::vector<std::size_t>& group,
                                        const std::vector<double>& given,
                                        const Exchanged& isExchanged) {
    const std::size_t run = isExchanged.size();
    std::vector<std::size_t> own, exchanged;
    for (const std::size_t point : group)
        (isExchanged[point % run] ? exchanged : own).push_back(point);
    std::vector<double> mean = meanOf(group, given, channels);
    const bool met = !own.empty() && !exchanged.empty();
    // A pair that is its own exchange was measured once.
    if (met && own.front() / run != exchanged.front() / run) {
        BothOrders both;
        both.value = meanOf(own, given, channels);
        both.exchanged = meanOf(exchanged, given, channels);
        both.contradict = differ(both.value, both.exchanged);
        if (both.contradict) mean = both.value;
        // The first of a run is the sample itself; the places of its images tell the same again.
        const auto sample = std::ranges::find(own, 0, [&](std::size_t p) { return p % run; });
        if (sample != own.end()) {
            both.sample = *sample / run;
            both.exchangedSample = exchanged.front() / run;
            bothOrders.push_back(std::move(both));
        }
    }
    values.insert(values.end(), mean.begin(), mean.end());
}

/// The nodes in lexical order of their coordinates: neither they nor their values depend on the
/// order in which the points came.
void ScatterInterpolant::Nodes::merge(const std::vector<Point>& points,
                                      const std::vector<double>& given,
                                      const Exchanged& isExchanged) {
    std::vector<std::size_t> order(points.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, [&](std::size_t a, std::size_t b) {
        if (points[a] != points[b]) return points[a] < points[b];
        return std::lexicographical_compare(
            given.begin() + a * channels, given.begin() + (a + 1) * channels,
            given.begin() + b * channels, given.begin() + (b + 1) * channels);
    });
    Cloud all;
    for (const std::size_t k : order) all.points.push_back(points[k]);
    const std::unique_ptr<Tree> among = plant(dimensions, all);
    std::vector<unsigned char> taken(order.size(), 0);
    std::vector<std::size_t> group;
    for (std::size_t k = 0; k < order.size(); ++k) {
        if (taken[k]) continue;
        group = {order[k]};
        taken[k] = 1;
        for (const std::uint32_t other : among->within(all.points[k], sameNode)) {
            if (taken[other]) continue;
            taken[other] = 1;
            group.push_back(order[other]);
        }
        cloud.points.push_back(all.points[k]);
        addNode(group, given, isExchanged);
    }
}

/// The distance at which weights vanish: to the first neighbour without weight.
double ScatterInterpolant::Nodes::radius(const Neighbours& found, std::size_t wanted) const {
    return found.count > wanted ? found.distance[wanted] : 2 * pi;
}

void ScatterInterpolant::Nodes::fitSlope(std::size_t node) {
    const auto size = static_cast<std::size_t>(dimensions);
    const Point& x = cloud.points[node];
    Neighbours found;
    tree->find(x, std::min(fitted[dimensions] + 2, cloud.points.size()), found);
    const double reach = radius(found, fitted[dimensions] + 1);
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    Eigen::Matrix<double, 4, Eigen::Dynamic> right(4, channels);
    right.setZero();
    const double* own = values.data() + node * channels;
    double* low = least.data() + node * channels;
    double* high = greatest.data() + node * channels;
    std::copy_n(own, channels, low);
    std::copy_n(own, channels, high);
    for (std::size_t n = 0; n < found.count; ++n) {
        if (found.index[n] == node) continue;
        const double weight = shepardWeight(found.distance[n], reach);
        if (!(weight > 0)) continue;
        const Point& other = cloud.points[found.index[n]];
        Eigen::Vector4d step = Eigen::Vector4d::Zero();
        for (std::size_t d = 0; d < size; ++d) step(static_cast<int>(d)) = other[d] - x[d];
        normal += weight * step * step.transpose();
        const double* value = values.data() + found.index[n] * channels;
        for (std::size_t c = 0; c < channels; ++c) {
            right.col(static_cast<Eigen::Index>(c)) += weight * (value[c] - own[c]) * step;
            low[c] = std::min(low[c], value[c]);
            high[c] = std::max(high[c], value[c]);
        }
    }
    // The slope of least norm: directions in which the neighbours hardly differ have none.
    constexpr double negligible = 1e-4;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(normal);
    const double largest = solver.eigenvalues()(3);
    Eigen::Matrix4d inverse = Eigen::Matrix4d::Zero();
    for (int e = 0; e < 4; ++e) {
        const double value = solver.eigenvalues()(e);
        if (!(value > negligible * largest)) continue;
        const Eigen::Vector4d axis = solver.eigenvectors().col(e);
        inverse += axis * axis.transpose() / value;
    }
    const Eigen::Matrix<double, 4, Eigen::Dynamic> slope = inverse * right;
    for (std::size_t d = 0; d < size; ++d) {
        for (std::size_t c = 0; c < channels; ++c) {
            slopes[(node * size + d) * channels + c] =
                slope(static_cast<Eigen::Index>(d), static_cast<Eigen::Index>(c));
        }
    }
}

void ScatterInterpolant::Nodes::fitSlopes() {
    slopes.assign(values.size() * static_cast<std::size_t>(dimensions), 0.0);
    least.resize(values.size());
    greatest.resize(values.size());
    tbb::parallel_for(std::size_t{0}, cloud.points.size(),
                      [&](std::size_t node) { fitSlope(node); });
}

ScatterInterpolant::ScatterInterpolant(int dimensions, std::vector<Point> points,
                                       const std::vector<double>& values, std::size_t channels,
                                       const Exchanged& isExchanged)
    : nodes_(std::make_unique<Nodes>()) {
    assert(!points.empty() && values.size() == points.size() * channels);
    nodes_->dimensions = dimensions;
    nodes_->channels = channels;
    nodes_->merge(points, values, isExchanged);
    nodes_->tree = plant(dimensions, nodes_->cloud);
    nodes_->fitSlopes();
}

ScatterInterpolant::~ScatterInterpolant() = default;

std::size_t ScatterInterpolant::nodes() const {
    return nodes_->cloud.points.size();
}

double ScatterInterpolant::nearest(const Point& x) const {
    Neighbours found;
    nodes_->tree->find(x, 1, found);
    return found.distance[0];
}

const std::vector<ScatterInterpolant::BothOrders>& ScatterInterpolant::bothOrders() const {
    return nodes_->bothOrders;
}

double ScatterInterpolant::evaluate(const Point& x, double limit, double* out, std::size_t stride,
                                    Trail* trail) const {
    const Nodes& n = *nodes_;
    const auto size = static_cast<std::size_t>(n.dimensions);
    const std::size_t channels = n.channels;
    for (std::size_t c = 0; c < channels; ++c) out[c * stride] = 0;
    const std::size_t wanted = weighed[n.dimensions];
    const std::size_t count = std::min(wanted + 1, n.cloud.points.size());
    Neighbours found;
    if (trail && trail->reach >= 0) {
        // The neighbours of the last search are this near to x, give or take rounding.
        constexpr double rounding = 1e-9;
        n.tree->find(x, count, found,
                     (trail->reach + distance(x, trail->at)) * (1 + rounding) + rounding);
    } else {
        n.tree->find(x, count, found);
    }
    if (trail) *trail = {x, found.distance[count - 1]};
    const double first = found.distance[0];
    if (first > limit) return first;
    if (first <= onNode) {
        const double* value = n.values.data() + found.index[0] * channels;
        for (std::size_t c = 0; c < channels; ++c) out[c * stride] = value[c];
        return first;
    }
    const double reach = n.radius(found, wanted);
    double total = 0;
    for (std::size_t k = 0; k < std::min(found.count, wanted); ++k) {
        // Equally distant nodes, all of them at R, have equal weights.
        const double weight = std::max(shepardWeight(found.distance[k], reach), 1e-300);
        total += weight;
        const std::size_t node = found.index[k];
        Point step{};
        for (std::size_t d = 0; d < size; ++d) step[d] = x[d] - n.cloud.points[node][d];
        const double* value = n.values.data() + node * channels;
        const double* slope = n.slopes.data() + node * size * channels;
        const double* low = n.least.data() + node * channels;
        const double* high = n.greatest.data() + node * channels;
        for (std::size_t c = 0; c < channels; ++c) {
            double q = value[c];
            for (std::size_t d = 0; d < size; ++d) q += slope[d * channels + c] * step[d];
            out[c * stride] += weight * std::clamp(q, low[c], high[c]);
        }
    }
    for (std::size_t c = 0; c < channels; ++c) out[c * stride] /= total;
    return first;
}

}  // namespace hshfit::brdfs
