#include "filtered_texel_brdf.h"

#include "facet_lobes.h"

#include <hshfit/brdf/vectors.h>
#include <hshfit/error.h>
#include <hshfit/filtered_maps/filtered_map.h>
#include <hshfit/filtered_maps/plain_texel.h>

#include <fmt/format.h>

#include <algorithm>
#include <functional>

namespace hshfit::jobs {
namespace {

class FilteredTexelBrdf final : public Brdf {
public:
    FilteredTexelBrdf(const FilteredMap& map, std::size_t level, std::size_t column,
                      std::size_t row)
        : name_(fmt::format("{}:x={},y={},level={}", map.file(), column, row, level)),
          channels_(map.sidecar().channels),
          form_(level == 0 ? "one texel" : map.sidecar().form),
          lobes_(map.sidecar().model, map.sidecar().nodes, map.file()),
          numbers_(map.numbers(level, column, row)),
          layout_(map.sidecar().layout) {
        const FilteredSidecar& sidecar = map.sidecar();
        lobes_.checkTerms(sidecar.terms.size(), map.file());
        surface_ = lobes_.surface(sidecar.terms, channels_.count(), layout_.albedos);
        const bool harmonics = level > 0 && sidecar.form == "harmonics";
        use_ = {harmonics ? MipForm::harmonics : MipForm::ellipse};
        table_ = lobes_.table(harmonics ? layout_.order : 3);
        texel_ = std::make_unique<FilteredTexel>(layout_, numbers_, *table_);
        if (level > 0) return;
        base_ = std::make_unique<PlainTexel>(surface_, layout_, *texel_, numbers_);
    }

    std::string name() const override { return name_; }
    const Channels& channels() const override { return channels_; }
    const Laws& laws() const override { return laws_; }

    void eval(const Direction& wo, DirectionBatch wi, double* out) const override {
        double values[3];
        const std::span<double> f(values, channels_.count());
        for (std::size_t k = 0; k < wi.count; ++k) {
            evalOne({wi.x[k], wi.y[k], wi.z[k]}, wo, f);
            for (std::size_t c = 0; c < f.size(); ++c) out[c * wi.count + k] = f[c];
        }
    }

    std::vector<Lobe> lobes(const Direction& wo) const override {
        const Direction& n = texel_->normal();
        const Direction mirror = 2 * dot(n, wo) * n - wo;
        const auto widths = table_->widths(texel_->lobe());
        return {{.about = Lobe::About::axis,
                 .width = std::clamp(std::min(widths[0], widths[1]), 1e-3, 1.0),
                 .axis = mirror}};
    }
    std::vector<Fact> facts() const override {
        const Direction& n = texel_->normal();
        return {{"form", form_},
                {"normal_theta", degrees(polarAngle(n))},
                {"normal_phi", degrees(azimuth(n))},
                {"mean_normal_length", texel_->meanNormalLength()},
                {"model", lobes_.specification(texel_->lobe())}};
    }

private:
    void evalOne(const Direction& wi, const Direction& wo, std::span<double> f) const {
        std::fill(f.begin(), f.end(), 0.0);
        if (!(wi.z > 0) || !(wo.z > 0)) return;
        if (base_)
            base_->reflect(wi, wo, f);
        else
            texel_->reflect(use_, surface_.rest, wi, wo, f, surface_.shape);
        for (double& value : f) value = std::min(value / wi.z, 1e300);
    }

    std::string name_;
    Channels channels_;
    Laws laws_{.nonNegative = true};
    std::string form_;
    FacetLobes lobes_;
    std::vector<double> numbers_;
    MipLayout layout_;
    FilteredSurface surface_;
    MipUse use_;
    std::shared_ptr<const LobeTable> table_;
    std::unique_ptr<FilteredTexel> texel_;
    std::unique_ptr<PlainTexel> base_;  ///< of level 0
};

}  // namespace

std::unique_ptr<Brdf> openFilteredTexel(const std::string& sidecar, std::size_t level,
                                        std::size_t column, std::size_t row) {
    const FilteredMap map(sidecar);
    auto brdf = std::make_unique<FilteredTexelBrdf>(map, level, column, row);
    map.checkIntact();
    return brdf;
}

}  // namespace hshfit::jobs
