#pragma once

#include <hshfit/material_maps/processes.h>
#include <hshfit/material_maps/texel_encoder.h>
#include <hshfit/material_maps/texel_source.h>

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace hshfit::inline material_maps {

/// Texels of the first levels of a map as weights of shared shapes, and the norm of what the shapes
/// leave: [level][texel][weights + 1].
using LevelSamples = std::vector<std::vector<float>>;

/// Sampled texels of level 0, [texel][layout.floats()], and averages of levels 1 to at most 6 from
/// blocks of 64 x 64 texels, at most `blocks`, on an even grid over the map. Shared out among
/// processes; each has all afterwards.
LevelSamples sampleLevels(TexelSource& source, const LowRank& lowRank,
                          std::span<const float> samples, const std::vector<LevelSize>& sizes,
                          std::size_t blocks, Processes& processes);

/// The index of the nearest of some shared materials, found among weights of shared shapes. Each
/// level has materials of its own, since its averages lie between the materials of level 0; indices
/// count through all levels. A texel has four bytes: the index, low byte first, and its relative
/// error in 1/65535, rounded up.
class ClusterEncoder final : public TexelEncoder {
public:
    static constexpr std::size_t most = 65536;  ///< materials of all levels together

    struct Options {
        std::size_t clusters = 256;  ///< of each level; fewer where it has fewer texels
        std::size_t levels = 1;      ///< of the map
        std::function<void(std::size_t done, std::size_t total)> progress = {};
    };
    /// Learns the materials of the first levels from samples of these levels. The materials of
    /// further levels are learnt when all their texels are known. Throws UsageError for more
    /// materials than indices.
    ClusterEncoder(LowRank lowRank, const LevelSamples& samples, const Options& options,
                   Processes& processes);

    std::string form() const override { return "clusters"; }
    gpu::Number number() const override { return gpu::Number::unorm8; }
    std::size_t layers() const override { return 1; }
    std::size_t linear() const override { return lowRank_.weightsOfTexel() + 1; }
    void reduce(const float* texel, float* linear) const override;
    EncodedRange encode(std::size_t level, std::span<const float> linear,
                        const EncodedTexels& to) const override;
    void learn(std::size_t level, std::span<const float> linear) override;

    std::span<const double> shapes() const override { return lowRank_.shapes(); }
    /// The materials of all levels known so far.
    std::span<const float> centres() const override { return centres_; }

    const LowRank& lowRank() const { return lowRank_; }
    /// The weights of the material of a level that is nearest to a texel of linear() numbers.
    const float* centre(std::size_t level, const float* linear) const;
    /// Materials of a level.
    std::size_t count(std::size_t level) const { return nearest_[level].count(); }

private:
    void addLevel(std::span<const float> linear, Processes& processes);

    LowRank lowRank_;
    Options options_;
    std::vector<float> centres_;
    std::vector<std::size_t> firsts_;    ///< the first material of each level
    std::vector<NearestPoint> nearest_;  ///< by level
};

}  // namespace hshfit::inline material_maps
