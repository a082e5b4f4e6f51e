#include <hshfit/material_maps/cluster_encoder.h>

#include <hshfit/each_in_parallel.h>
#include <hshfit/error.h>
#include <hshfit/material_maps/internal/level_rows.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline material_maps {
namespace {

/// Blocks of a map on an even grid.
struct Blocks {
    std::size_t side, levels;   ///< levels above level 0
    std::size_t across, down;   ///< that are taken
    std::size_t columns, rows;  ///< that there are

    Blocks(const std::vector<LevelSize>& sizes, std::size_t most) {
        levels = std::min<std::size_t>(sizes.size() - 1, 6);
        while (levels > 0 && (sizes[levels].width << levels != sizes[0].width ||
                              sizes[levels].height << levels != sizes[0].height))
            --levels;  // one side has shrunk to 1
        side = std::size_t{1} << levels;
        columns = sizes[0].width / side;
        rows = sizes[0].height / side;
        const double share = std::sqrt(
            std::min(1.0, static_cast<double>(most) / static_cast<double>(columns * rows)));
        const auto of = [&](std::size_t count) {
            return std::clamp<std::size_t>(
                static_cast<std::size_t>(share * static_cast<double>(count)), 1, count);
        };
        across = of(columns);
        down = of(rows);
    }
    static std::size_t place(std::size_t k, std::size_t taken, std::size_t all) {
        return (2 * k + 1) * all / (2 * taken);
    }
};

}  // namespace

LevelSamples sampleLevels(TexelSource& source, const LowRank& lowRank,
                          std::span<const float> samples, const std::vector<LevelSize>& sizes,
                          std::size_t most, Processes& processes) {
    const Blocks blocks(sizes, most);
    const std::size_t d = lowRank.weightsOfTexel(), n = d + 1, side = blocks.side;
    const std::size_t floats = source.layout().floats();
    LevelSamples result(1);
    result[0].resize(samples.size() / floats * n);
    const auto reduce = [&](const float* texel, float* to) { to[d] = lowRank.reduce(texel, to); };
    eachInParallel(samples.size() / floats, [&](std::size_t t) {
        reduce(samples.data() + t * floats, result[0].data() + t * n);
    });
    for (std::size_t level = 1; level <= blocks.levels; ++level)
        result.emplace_back(blocks.across * blocks.down * (side >> level) * (side >> level) * n);
    if (blocks.levels == 0) return result;
    const ItemRange mine = processes.share(blocks.down);
    for (std::size_t r = mine.first; r < mine.last; ++r) {
        const std::size_t top = Blocks::place(r, blocks.down, blocks.rows) * side;
        const auto band = source.band(top, top + side);
        eachInParallel(blocks.across, [&](std::size_t c) {
            const std::size_t left = Blocks::place(c, blocks.across, blocks.columns) * side;
            LevelRows rows(side, n, blocks.levels + 1);
            std::vector<float> texels(side * floats);
            for (std::size_t row = 0; row < side; ++row) {
                band->texels(top + row, left, side, texels.data());
                for (std::size_t t = 0; t < side; ++t)
                    reduce(texels.data() + t * floats, rows.next() + t * n);
                rows.push([&](std::size_t level, std::size_t at, const float* linear) {
                    if (level == 0) return;
                    const std::size_t width = side >> level;
                    const std::size_t before = ((r * blocks.across + c) * width + at) * width;
                    std::copy_n(linear, width * n, result[level].data() + before * n);
                });
            }
        });
    }
    for (std::size_t level = 1; level <= blocks.levels; ++level)
        gatherValues(processes, blocks.down, result[level]);
    return result;
}

ClusterEncoder::ClusterEncoder(LowRank lowRank, const LevelSamples& samples, const Options& options,
                               Processes& processes)
    : lowRank_(std::move(lowRank)), options_(options) {
    if (options_.clusters + options_.levels - 1 > most) {
        throw UsageError(fmt::format("{} materials for level 0 leave none for the other levels",
                                     options_.clusters));
    }
    for (const auto& level : samples) addLevel(level, processes);
}

void ClusterEncoder::addLevel(std::span<const float> linear, Processes& processes) {
    const std::size_t n = this->linear(), d = n - 1, count = linear.size() / n;
    // Levels above level 0 share what it leaves.
    const bool first = nearest_.empty();
    const std::size_t room =
        first ? options_.clusters
              : (most - options_.clusters) / std::max<std::size_t>(options_.levels - 1, 1);
    std::vector<float> points(count * d), weights(count);
    for (std::size_t t = 0; t < count; ++t) {
        const float* texel = linear.data() + t * n;
        std::copy_n(texel, d, points.data() + t * d);
        const double norm = normOfReduced(texel, d);
        weights[t] = norm > 0 ? static_cast<float>(1 / (norm * norm)) : 0;
    }
    const std::vector<float> centres =
        clusterCentres({points, weights, d}, {.clusters = std::min(options_.clusters, room),
                                              .progress = options_.progress,
                                              .processes = &processes});
    firsts_.push_back(centres_.size() / d);
    centres_.insert(centres_.end(), centres.begin(), centres.end());
    nearest_.emplace_back(centres, d);
}

void ClusterEncoder::learn(std::size_t level, std::span<const float> linear) {
    Processes alone;
    while (nearest_.size() <= level) addLevel(linear, alone);
}

void ClusterEncoder::reduce(const float* texel, float* linear) const {
    linear[lowRank_.weightsOfTexel()] = lowRank_.reduce(texel, linear);
}

const float* ClusterEncoder::centre(std::size_t level, const float* linear) const {
    const std::size_t material = firsts_[level] + nearest_[level](linear).index;
    return centres_.data() + material * lowRank_.weightsOfTexel();
}

EncodedRange ClusterEncoder::encode(std::size_t level, std::span<const float> linear,
                                    const EncodedTexels& to) const {
    EncodedRange result;
    const std::size_t n = this->linear(), weights = n - 1;
    for (std::size_t t = 0; t < linear.size() / n; ++t) {
        const float* point = linear.data() + t * n;
        const Nearest nearest = nearest_[level](point);
        const auto rest = static_cast<double>(point[weights]);
        const double off = std::sqrt(static_cast<double>(nearest.square) + rest * rest);
        to.errors[t] = relativeError(off, normOfReduced(point, weights));
        result.finite = result.finite && std::isfinite(off);
        result.largest = std::max(result.largest, to.errors[t]);
        const auto code = static_cast<std::uint32_t>(
            std::clamp(std::ceil(static_cast<double>(to.errors[t]) * 65535), 0.0, 65535.0));
        const auto index = static_cast<std::uint32_t>(firsts_[level] + nearest.index);
        const std::uint32_t bytes[] = {index & 255, index >> 8, code & 255, code >> 8};
        for (std::size_t k = 0; k < 4; ++k) to.bytes[4 * t + k] = static_cast<std::byte>(bytes[k]);
    }
    return result;
}

}  // namespace hshfit::inline material_maps
