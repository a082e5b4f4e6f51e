#pragma once

#include <hshfit/gpu/texels.h>
#include <hshfit/material_maps/reduction.h>
#include <hshfit/material_maps/texel_layout.h>

#include <cstddef>
#include <span>
#include <string>

namespace hshfit::inline material_maps {

/// The place of encoded texels: layer k of `bytes` begins at k * pitch.
struct EncodedTexels {
    std::byte* bytes = nullptr;
    std::size_t pitch = 0;
    float* errors = nullptr;  ///< of each texel, relative to its norm
};

/// The largest magnitude among stored numbers, and whether all are finite.
struct EncodedRange {
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
    /// The number of floats that are averaged.
    virtual std::size_t linear() const = 0;
    /// Whether the averaged floats are the texel itself, and `reduce` is a copy.
    virtual bool averagesTexels() const { return false; }
    /// Makes the averaged floats from a texel of layout.floats().
    virtual void reduce(const float* texel, float* linear) const = 0;
    /// Encodes neighbouring texels of a level, linear[texel][linear()].
    virtual EncodedRange encode(std::size_t level, std::span<const float> linear,
                                const EncodedTexels& to) const = 0;
    /// Shapes and materials that texels share, as MapSidecar has them; empty: none.
    virtual std::span<const double> shapes() const { return {}; }
    virtual std::span<const float> centres() const { return {}; }
    /// All texels of a level, before they are encoded; by the first process alone, of the levels
    /// that are made from the results of all.
    virtual void learn(std::size_t level, std::span<const float> linear) {
        (void)level;
        (void)linear;
    }
};

/// All coefficients of a texel, as float16 or float32. Errors are zero: rounding, at most 2^-11 or
/// 2^-24 of each number, is left out.
class PlainEncoder final : public TexelEncoder {
public:
    PlainEncoder(const TexelLayout& layout, gpu::Number number);
    std::string form() const override { return "outgoing"; }
    gpu::Number number() const override { return number_; }
    std::size_t layers() const override { return layers_; }
    std::size_t linear() const override { return 4 * layers_; }
    bool averagesTexels() const override { return true; }
    void reduce(const float* texel, float* linear) const override;
    EncodedRange encode(std::size_t level, std::span<const float> linear,
                        const EncodedTexels& to) const override;

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
    EncodedRange encode(std::size_t level, std::span<const float> linear,
                        const EncodedTexels& to) const override;
    std::span<const double> shapes() const override { return lowRank_.shapes(); }
    const LowRank& lowRank() const { return lowRank_; }

private:
    LowRank lowRank_;
    gpu::Number number_;
};

/// The norm of a texel of weights of shared shapes and the norm of what they leave, [weights + 1].
double normOfReduced(const float* linear, std::size_t weights);
/// An error relative to such a norm; black is exact.
float relativeError(double error, double norm);

}  // namespace hshfit::inline material_maps
