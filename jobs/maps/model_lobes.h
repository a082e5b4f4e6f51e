#pragma once

#include "parameter_maps.h"

#include <hshfit/bases/basis.h>
#include <hshfit/material_maps/lobe_grid.h>
#include <hshfit/material_maps/lobe_texels.h>
#include <hshfit/material_maps/texel_layout.h>
#include <hshfit/projection/projection.h>

#include <cstddef>
#include <mutex>
#include <string>
#include <vector>

namespace hshfit::jobs {

/// The least share of the energy of a BRDF at a node of the grid that the basis captures.
struct LeastCaptured {
    std::mutex mutex = {};
    double share = 1;
    std::string brdf = {};
};

/// A model with parameters from texel to texel as a sum of lobes. f is affine in some parameters,
/// each by itself while the others are held, and so is a sum over products of them,
///     f = sum over sets T of prod_{i in T} t_i f_T(p),   t = (value - low) / (high - low),
/// with lobes f_T that depend on the other parameters p alone. Affine parameters are found by
/// evaluating f at random pairs of directions; products whose lobe is zero there are left out.
class ModelLobes {
public:
    /// Throws InputError where the BRDF cannot be opened or has wavelengths, and where more than
    /// three parameters are not affine.
    ModelLobes(const ParameterMaps& maps, const std::string& file);

    std::size_t count() const { return products_.size(); }
    /// "kd", "ks", "base_color * metallic", … and "1".
    std::vector<std::string> names() const;
    const std::vector<LobeAxis>& axes() const { return axes_; }
    bool axesByChannel() const { return axesByChannel_; }
    std::size_t channels() const { return channels_; }
    /// Laws that hold for all texels.
    const Laws& laws() const { return laws_; }

    /// Coefficients of the lobes, as a function of the axes, whose calls lower `least`.
    LobeFunction function(const TexelLayout& layout, const Basis& basis,
                          const ProjectionOptions& options, LeastCaptured& least) const;
    /// A row of ParameterMaps as weights and places.
    TexelBlock block(const std::vector<float>& row, std::size_t count) const;
    /// The specification of one texel in one channel; values[parameter].
    std::string specification(const std::vector<double>& values) const;

private:
    struct Varying {
        std::string name;
        std::size_t first = 0, channels = 1;  ///< in the values of a texel
        double low = 0, high = 1;             ///< of t, or the range that occurs
        bool affine = false;
        std::size_t axis = 0;  ///< if not
    };
    void findAffine();
    void findProducts();
    std::vector<double> mapped(const std::vector<double>& shares) const;
    std::vector<double> valuesAt(std::size_t product, std::span<const double> p) const;

    std::string common_;
    std::vector<Varying> varying_;
    std::vector<std::size_t> affine_;    ///< indices into `varying_`
    std::vector<std::size_t> products_;  ///< bits of `affine_`, rising in number
    std::vector<LobeAxis> axes_;
    bool axesByChannel_ = false;
    std::size_t channels_ = 1;
    Laws laws_;
};

/// The texels of parameter maps for the kernel.
class ModelRows final : public ParameterRows {
public:
    ModelRows(ParameterMaps& maps, const ModelLobes& lobes) : maps_(maps), lobes_(lobes) {}
    std::size_t width() const override { return maps_.width(); }
    std::size_t height() const override { return maps_.height(); }
    std::vector<TexelBlock> read(std::size_t top, std::size_t bottom) override;

private:
    ParameterMaps& maps_;
    const ModelLobes& lobes_;
};

}  // namespace hshfit::jobs
