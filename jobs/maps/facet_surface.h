#pragma once

#include <jobs/source/facet_lobes.h>
#include "parameter_maps.h"

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace hshfit::jobs {

/// Parameter maps as texels of a surface of microfacets: the normal, the direction of its lobe, the
/// lobe's parameters, and the factors of its terms. A parameter that changes only these factors is
/// one of them (f has to be affine in it); at most two others are parameters of the lobe.
class FacetSurface {
public:
    /// Reads the maps once, by all processes together, to find factors that are equal. Throws
    /// InputError, which starts with `file`, for a model without facets, and for parameters that
    /// are neither.
    FacetSurface(ParameterMaps& maps, const std::string& file, Processes& processes,
                 const Listener& listener);

    const FacetLobes& lobes() const { return *lobes_; }
    /// [term of the lobe][channel]
    const std::vector<std::vector<LobeWeight>>& terms() const { return terms_; }
    std::size_t channels() const { return channels_; }
    int weights() const { return static_cast<int>(columnOfWeight_.size()); }
    int albedos() const { return albedos_; }
    /// The largest relative distance of D from its interpolation, at the middle of intervals.
    double nodeError() const { return nodeError_; }
    /// f of texels, its parts, and nothing of the map.
    FilteredSurface reflectance() const { return lobes_->surface(terms_, channels_, albedos_); }

    std::vector<SurfaceTexel> row(std::size_t row);

private:
    struct Varying {
        std::string name;
        std::size_t first = 0, channels = 1;  ///< in the values of a texel
        double low = 0, high = 1;             ///< of the factor's share, or of the map
        bool factor = false;
        std::size_t node = 0;  ///< if not
    };
    std::string specification(const std::vector<double>& values) const;
    std::vector<double> middle() const;
    void classify(const ParameterMaps& maps);
    void findCorners();
    std::vector<double> intervalErrors(const std::string& model, std::size_t node) const;
    void findNodes();
    /// Factors of terms [term of the lobe, then the smooth part][channel][column].
    std::vector<double> columns(const std::vector<float>& values, std::size_t width) const;
    struct ColumnRatio;
    std::vector<ColumnRatio> columnRatios(const ItemRange& rows, const Listener& listener);
    void findEqualColumns(Processes& processes, const Listener& listener);
    std::size_t columnCount() const { return (lobeTerms_ + 1) * channels_; }

    ParameterMaps& maps_;
    std::string common_;
    std::vector<Varying> varying_;
    std::vector<std::size_t> factors_;  ///< indices into `varying_`
    std::vector<LobeNodes> nodes_;
    double nodeError_ = 0;
    std::size_t channels_ = 1, lobeTerms_ = 0;
    double turn_ = 0;                           ///< of the lobe's axes in the model's
    std::vector<std::vector<double>> corners_;  ///< [corner][term of the lobe, then smooth]
    std::unique_ptr<FacetLobes> lobes_;
    std::vector<std::vector<LobeWeight>> terms_;
    std::vector<std::size_t> columnOfWeight_;
    int albedos_ = 0;
};

}  // namespace hshfit::jobs
