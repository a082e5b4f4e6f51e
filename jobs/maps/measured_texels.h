#pragma once

#include <jobs/common/listener.h>
#include "svbrdf.h"

#include <hshfit/bases/basis.h>
#include <hshfit/brdf/brdf.h>
#include <hshfit/coefficients/coefficients.h>
#include <hshfit/files/mapped_file.h>
#include <hshfit/files/tensor_file.h>
#include <hshfit/material_maps/texel_source.h>

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace hshfit::jobs {

/// A tensor file of measured texels: `incoming` f32 [I][3] and `outgoing` f32 [O][3], unit vectors
/// above the horizon, and `reflectance` f32 [height][width][O][I][C], f in 1/sr, of one or three
/// channels. Coefficients are the least squares of projectLeastSquares, which are linear in the
/// samples: one matrix for all texels. The file is mapped, not read into memory.
class MeasuredTexels final : public TexelSource {
public:
    struct Options {
        std::string outgoing = {};  ///< empty: 8 elevations of isotropic texels, else 8x8
        Quantity quantity = Quantity::brdf;
        bool isotropic = false;  ///< all texels; they are mirror-symmetric too
    };
    /// Reads all samples once. Throws InputError that names the file, the field or the texel, and
    /// NumericError where the directions do not determine the coefficients.
    MeasuredTexels(const std::string& file, const Basis& basis, const Options& options,
                   const Listener& listener);

    std::size_t width() const override { return width_; }
    std::size_t height() const override { return height_; }
    const TexelLayout& layout() const override { return layout_; }
    const Laws& laws() const { return laws_; }
    std::unique_ptr<TexelBand> band(std::size_t top, std::size_t bottom) override;

    /// Over at most 2,048 texels.
    FitErrors fitErrors() const;
    void checkIntact() const { mapped_.checkIntact(); }

private:
    class Band;
    std::vector<Direction> directions(const char* name) const;
    void checkSamples(const Listener& listener) const;
    void findOperator(const Basis& basis, Quantity quantity);
    void samplesOf(std::size_t column, std::size_t row, std::size_t channel, float* out) const;
    void texel(std::size_t column, std::size_t row, float* out) const;

    std::string file_;
    MappedFile mapped_;
    TensorFile tensor_;
    std::vector<Direction> incoming_, outgoing_;
    std::size_t width_ = 0, height_ = 0, channels_ = 1, samples_ = 0;
    const unsigned char* reflectance_ = nullptr;
    Laws laws_ = {};
    TexelLayout layout_ = {};
    std::vector<float> operator_;   ///< [shape of the layout][sample]
    std::vector<float> responses_;  ///< [sample][shape]: values at the samples
};

}  // namespace hshfit::jobs
