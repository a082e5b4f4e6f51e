#include <hshfit/material_maps/reduction.h>

#include <hshfit/each_in_parallel.h>
#include <hshfit/linear_algebra/decompositions.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace hshfit::inline material_maps {
namespace {

/// Texels that share one sum, which is added to the others in order.
constexpr std::size_t chunk = 1024;

/// The shape of a channel of a texel, times the roots of the weights.
void weightedShape(const TexelLayout& layout, const float* texel, std::size_t channel,
                   Eigen::Ref<Eigen::VectorXd> shape) {
    const std::size_t slots = layout.slots.size();
    for (std::size_t o = 0; o < layout.outgoing.size(); ++o) {
        const double root = std::sqrt(layout.weights()[o]);
        const float* from = texel + o * layout.stride() + channel * slots;
        for (std::size_t s = 0; s < slots; ++s)
            shape[static_cast<Eigen::Index>(o * slots + s)] = root * static_cast<double>(from[s]);
    }
}

/// The weighted shapes of all channels of a texel, [shape][channel].
Eigen::MatrixXd weightedShapes(const TexelLayout& layout, const float* texel) {
    Eigen::MatrixXd shapes(layout.shape(), layout.channels);
    for (std::size_t c = 0; c < layout.channels; ++c)
        weightedShape(layout, texel, c, shapes.col(static_cast<Eigen::Index>(c)));
    return shapes;
}

}  // namespace

LowRank::LowRank(const TexelLayout& layout, std::vector<double> shapes)
    : layout_(layout),
      rank_(shapes.size() / layout.shape()),
      padded_((layout.shape() + 15) / 16 * 16),
      shapes_(std::move(shapes)),
      directions_(rank_ * padded_, 0.0F) {
    for (const double weight : layout.weights())
        roots_.push_back(static_cast<float>(std::sqrt(weight)));
    const std::size_t shape = layout.shape();
    for (std::size_t i = 0; i < shapes_.size(); ++i) {
        const std::size_t outgoing = i % shape / layout.slots.size();
        directions_[i / shape * padded_ + i % shape] =
            static_cast<float>(shapes_[i] * std::sqrt(layout.weights()[outgoing]));
        back_.push_back(static_cast<float>(shapes_[i]));
    }
}

float LowRank::reduce(const float* texel, float* weights) const {
    const std::size_t slots = layout_.slots.size();
    thread_local std::vector<float> channel;
    channel.assign(padded_, 0.0F);
    float rest = 0;
    for (std::size_t c = 0; c < layout_.channels; ++c) {
        for (std::size_t o = 0; o < layout_.outgoing.size(); ++o) {
            const float* from = texel + o * layout_.stride() + c * slots;
            float* to = channel.data() + o * slots;
            for (std::size_t s = 0; s < slots; ++s) to[s] = roots_[o] * from[s];
        }
        rest +=
            projectOnto(directions_.data(), rank_, padded_, channel.data(), weights + c * rank_);
    }
    return std::sqrt(rest);
}

void LowRank::restore(const float* weights, float* texel) const {
    const std::size_t slots = layout_.slots.size(), shape = layout_.shape();
    std::fill_n(texel, layout_.floats(), 0.0F);
    for (std::size_t c = 0; c < layout_.channels; ++c) {
        for (std::size_t r = 0; r < rank_; ++r) {
            const float weight = weights[c * rank_ + r];
            for (std::size_t o = 0; o < layout_.outgoing.size(); ++o) {
                float* to = texel + o * layout_.stride() + c * slots;
                const float* by = back_.data() + r * shape + o * slots;
                for (std::size_t s = 0; s < slots; ++s) to[s] += weight * by[s];
            }
        }
    }
}

PrincipalShapes::PrincipalShapes(const TexelLayout& layout, std::span<const float> texels,
                                 Processes& processes)
    : layout_(layout) {
    const std::size_t count = texels.size() / layout.floats(), shape = layout.shape();
    const std::size_t chunks = (count + chunk - 1) / chunk, square = shape * shape;
    std::vector<double> grams(chunks * square);
    const ItemRange mine = processes.share(chunks);
    eachInParallel(mine.last - mine.first, [&](std::size_t part) {
        const std::size_t k = mine.first + part, end = std::min((k + 1) * chunk, count);
        Eigen::MatrixXd rows(shape, layout.channels * (end - k * chunk));
        rows.setZero();
        for (std::size_t t = k * chunk; t < end; ++t) {
            const Eigen::MatrixXd shapes =
                weightedShapes(layout, texels.data() + t * layout.floats());
            const double norm = shapes.norm();
            if (norm > 0) {
                rows.middleCols(static_cast<Eigen::Index>((t - k * chunk) * layout.channels),
                                static_cast<Eigen::Index>(layout.channels)) = shapes / norm;
            }
        }
        Eigen::Map<Eigen::MatrixXd>(grams.data() + k * square, shape, shape) =
            rows * rows.transpose();
    });
    gatherValues(processes, chunks, grams);
    Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(shape, shape);
    for (std::size_t k = 0; k < chunks; ++k)
        gram += Eigen::Map<const Eigen::MatrixXd>(grams.data() + k * square, shape, shape);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(gram);
    const Eigen::VectorXd& values = solver.eigenvalues();  // rising
    // Float texels have relative errors of 6e-8, of which the eigenvalues are squares.
    const double least = values[values.size() - 1] * 1e-13;
    for (Eigen::Index k = values.size(); k-- > 0 && values[k] > least;) {
        ++most_;
        const Eigen::VectorXd vector = solver.eigenvectors().col(k);
        for (std::size_t i = 0; i < shape; ++i) {
            const double root = std::sqrt(layout.weights()[i / layout.slots.size()]);
            shapes_.push_back(root > 0 ? vector[static_cast<Eigen::Index>(i)] / root : 0);
        }
    }
}

LowRank PrincipalShapes::lowRank(std::size_t rank) const {
    const std::size_t kept = std::min(rank, most_) * layout_.shape();
    return {layout_, {shapes_.begin(), shapes_.begin() + static_cast<std::ptrdiff_t>(kept)}};
}

std::vector<TexelErrors> PrincipalShapes::errors(std::span<const float> texels,
                                                 Processes& processes) const {
    const std::size_t count = texels.size() / layout_.floats();
    Eigen::MatrixXd shapes(most_, layout_.shape());
    for (std::size_t r = 0; r < most_; ++r) {
        for (std::size_t i = 0; i < layout_.shape(); ++i) {
            shapes(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(i)) =
                shapes_[r * layout_.shape() + i] *
                std::sqrt(layout_.weights()[i / layout_.slots.size()]);
        }
    }
    std::vector<float> relative(count * most_);  // [texel][rank - 1]
    const ItemRange mine = processes.share(count);
    eachInParallel((mine.last - mine.first + chunk - 1) / chunk, [&](std::size_t k) {
        const std::size_t first = mine.first + k * chunk;
        for (std::size_t t = first; t < std::min(first + chunk, mine.last); ++t) {
            const Eigen::MatrixXd whole =
                weightedShapes(layout_, texels.data() + t * layout_.floats());
            Eigen::MatrixXd rest = whole;
            const double norm = whole.norm();
            const Eigen::MatrixXd weights = shapes * whole;
            for (std::size_t r = 0; r < most_; ++r) {
                const auto row = static_cast<Eigen::Index>(r);
                rest -= shapes.row(row).transpose() * weights.row(row);
                relative[t * most_ + r] = norm > 0 ? static_cast<float>(rest.norm() / norm) : 0;
            }
        }
    });
    gatherValues(processes, count, relative);
    std::vector<TexelErrors> result;
    std::vector<float> ofRank(count);
    for (std::size_t r = 0; r < most_; ++r) {
        for (std::size_t t = 0; t < count; ++t) ofRank[t] = relative[t * most_ + r];
        result.push_back(errorsOf(ofRank));
    }
    return result;
}

TexelErrors errorsOf(std::vector<float>& relative) {
    if (relative.empty()) return {};
    std::ranges::sort(relative);
    TexelErrors errors;
    for (const float value : relative) errors.mean += static_cast<double>(value);
    errors.mean /= static_cast<double>(relative.size());
    errors.percentile99 = static_cast<double>(relative[(relative.size() - 1) * 99 / 100]);
    errors.maximum = static_cast<double>(relative.back());
    return errors;
}

namespace {

double drawn(std::mt19937_64& generator) {
    return static_cast<double>(generator() >> 11) * 0x1p-53;
}

double squareDistance(const float* a, const float* b, std::size_t dimensions) {
    double square = 0;
    for (std::size_t k = 0; k < dimensions; ++k) {
        const double off = static_cast<double>(a[k]) - static_cast<double>(b[k]);
        square += off * off;
    }
    return square;
}

/// Each start is drawn in proportion to its weighted square distance from the starts before it.
std::vector<float> starts(const WeightedPoints& all, const ClusterOptions& options) {
    const std::size_t count = all.weights.size(), d = all.dimensions;
    std::mt19937_64 generator(options.seed);
    std::vector<double> shares(all.weights.begin(), all.weights.end());
    std::vector<double> nearest(count, std::numeric_limits<double>::infinity());
    std::vector<float> centres;
    while (centres.size() < options.clusters * d) {
        double total = 0;
        for (const double share : shares) total += share;
        if (!(total > 0)) break;  // no point is left that is no centre
        double left = drawn(generator) * total;
        std::size_t chosen = 0, last = 0;
        for (; chosen < count; ++chosen) {
            if (shares[chosen] > 0) last = chosen;
            left -= shares[chosen];
            if (left < 0) break;
        }
        chosen = std::min(chosen, count - 1);
        if (!(shares[chosen] > 0)) chosen = last;
        const float* centre = all.points.data() + chosen * d;
        centres.insert(centres.end(), centre, centre + d);
        eachInParallel((count + chunk - 1) / chunk, [&](std::size_t k) {
            for (std::size_t i = k * chunk; i < std::min((k + 1) * chunk, count); ++i) {
                nearest[i] =
                    std::min(nearest[i], squareDistance(all.points.data() + i * d, centre, d));
                shares[i] = nearest[i] * static_cast<double>(all.weights[i]);
            }
        });
        if (options.progress) options.progress(centres.size() / d, options.clusters);
    }
    return centres;
}

}  // namespace

std::vector<float> clusterCentres(const WeightedPoints& all, const ClusterOptions& options) {
    const std::size_t count = all.weights.size(), d = all.dimensions;
    std::vector<float> centres = starts(all, options);
    if (centres.empty()) centres.assign(d, 0.0F);
    const std::size_t clusters = centres.size() / d;
    std::vector<std::uint32_t> index, before;
    Processes alone;
    Processes& processes = options.processes ? *options.processes : alone;
    const ItemRange mine = processes.share(count);
    for (int round = 0; round < options.mostRounds; ++round) {
        const NearestPoint nearest(centres, d);
        index.resize(count);
        eachInParallel((mine.last - mine.first + chunk - 1) / chunk, [&](std::size_t k) {
            const std::size_t first = mine.first + k * chunk;
            for (std::size_t i = first; i < std::min(first + chunk, mine.last); ++i)
                index[i] = nearest(all.points.data() + i * d).index;
        });
        gatherValues(processes, count, index);
        if (index == before) break;
        before = index;
        std::vector<double> sums(clusters * d, 0.0), weights(clusters, 0.0);
        for (std::size_t i = 0; i < count; ++i) {
            const double weight = static_cast<double>(all.weights[i]);
            weights[index[i]] += weight;
            for (std::size_t k = 0; k < d; ++k)
                sums[index[i] * d + k] += weight * static_cast<double>(all.points[i * d + k]);
        }
        for (std::size_t c = 0; c < clusters; ++c) {
            if (!(weights[c] > 0)) continue;
            for (std::size_t k = 0; k < d; ++k)
                centres[c * d + k] = static_cast<float>(sums[c * d + k] / weights[c]);
        }
    }
    return centres;
}

}  // namespace hshfit::inline material_maps
