#pragma once

#include <hshfit/gpu/texels.h>
#include <hshfit/material_maps/reduction.h>
#include <hshfit/material_maps/texel_layout.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace hshfit::inline material_maps {

/// The largest magnitude among stored numbers, and the errors of texels relative to their norms.
struct EncodedTexels {
    std::vector<float> errors = {};  ///< [texel]
    float largest = 0;
    bool finite = true;
};

/// The form in which texels are stored: a vector of numbers that are averaged from level to level,
/// because reflectance is linear in them, and its texels in a texture array of RGBA.
class TexelEncoder {
public:
    virtual ~TexelEncoder() = default;
    /// "outgoing", "low-rank" or "clusters".
    virtual std::string form() const = 0;
    virtual gpu::Number number() const = 0;
    virtual std::size_t layers() const = 0;
    /// Floats that are averaged.
    virtual std::size_t linear() const = 0;
    /// From a texel of layout.floats() to them.
    virtual void reduce(const float* texel, float* linear) const = 0;
    /// linear[texel][linear()] to out[layer][texel]: layer k begins at byte k * pitch.
    virtual EncodedTexels encode(const float* linear, std::size_t count, std::byte* out,
                                 std::size_t pitch) const = 0;
};

/// All coefficients of a texel, as float16 or float32. Errors are zero: those of rounding, at most
/// 2^-11 or 2^-24 of each number, are left out.
class PlainEncoder final : public TexelEncoder {
public:
    PlainEncoder(const TexelLayout& layout, gpu::Number number);
    std::string form() const override { return "outgoing"; }
    gpu::Number number() const override { return number_; }
    std::size_t layers() const override { return layers_; }
    std::size_t linear() const override { return 4 * layers_; }
    void reduce(const float* texel, float* linear) const override;
    EncodedTexels encode(const float* linear, std::size_t count, std::byte* out,
                         std::size_t pitch) const override;

private:
    std::size_t layers_;
    gpu::Number number_;
};

/// Weights [channel][rank] of shared shapes, as float16 or float32. The norm of what the shapes
/// leave is averaged along: for a level it is a bound, by the triangle inequality.
class LowRankEncoder final : public TexelEncoder {
public:
    LowRankEncoder(LowRank lowRank, gpu::Number number);
    std::string form() const override { return "low-rank"; }
    gpu::Number number() const override { return number_; }
    std::size_t layers() const override { return (lowRank_.weightsOfTexel() + 3) / 4; }
    std::size_t linear() const override { return 4 * layers() + 1; }
    void reduce(const float* texel, float* linear) const override;
    EncodedTexels encode(const float* linear, std::size_t count, std::byte* out,
                         std::size_t pitch) const override;
    const LowRank& lowRank() const { return lowRank_; }

private:
    LowRank lowRank_;
    gpu::Number number_;
};

/// The index of the nearest of some shared materials, found among weights of shared shapes. A texel
/// has four bytes: the index, low byte first, and its relative error in 1/65535, rounded up.
class ClusterEncoder final : public TexelEncoder {
public:
    static constexpr std::size_t most = 65536;
    /// centres[centre][channel * rank + r]
    ClusterEncoder(LowRank lowRank, std::vector<float> centres);
    std::string form() const override { return "clusters"; }
    gpu::Number number() const override { return gpu::Number::unorm8; }
    std::size_t layers() const override { return 1; }
    std::size_t linear() const override { return lowRank_.weightsOfTexel() + 1; }
    void reduce(const float* texel, float* linear) const override;
    EncodedTexels encode(const float* linear, std::size_t count, std::byte* out,
                         std::size_t pitch) const override;
    const LowRank& lowRank() const { return lowRank_; }
    const std::vector<float>& centres() const { return centres_; }

private:
    LowRank lowRank_;
    std::vector<float> centres_;
    NearestPoint nearest_;
};

}  // namespace hshfit::inline material_maps
