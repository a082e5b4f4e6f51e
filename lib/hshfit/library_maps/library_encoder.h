#pragma once

#include <hshfit/library_maps/library_sidecar.h>
#include <hshfit/material_library/pair_fit.h>
#include <hshfit/material_maps/texel_encoder.h>

namespace hshfit::inline library_maps {

/// Coordinates in the basis of a library (PairFit), fitted to f of each texel by itself. The
/// numbers that are averaged are f at material_library::fitPairs(), [channel][pair], so that a
/// texel of a level is fitted to the mean reflectance of the texels that it stands for.
///
/// The error of a texel is the L2 error of f cos(theta_i) over these pairs, by solid angle,
/// relative to the norm of f cos(theta_i). It is taken with the numbers as stored and contains all
/// that the basis leaves out.
class LibraryEncoder final : public TexelEncoder {
public:
    LibraryEncoder(const material_library::Basis& basis, std::size_t channels, gpu::Number number);

    std::string form() const override { return "library"; }
    gpu::Number number() const override { return number_; }
    std::size_t layers() const override { return layout_.layers(); }
    std::size_t linear() const override;
    bool averagesTexels() const override { return true; }
    void reduce(const float* texel, float* linear) const override;
    EncodedRange encode(std::size_t level, std::span<const float> linear,
                        const EncodedTexels& to) const override;

    const LibraryLayout& layout() const { return layout_; }

private:
    /// LibraryLayout's numbers of a texel.
    std::vector<float> numbersOf(const float* linear) const;

    material_library::PairFit fit_;
    LibraryLayout layout_;
    gpu::Number number_;
};

}  // namespace hshfit::inline library_maps
