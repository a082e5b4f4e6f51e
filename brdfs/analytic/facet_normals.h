#pragma once

#include <brdfs/analytic/facet_text.h>
#include <brdfs/analytic/ggx_shape.h>
#include <brdfs/analytic/term_brdf.h>

#include <algorithm>
#include <functional>
#include <utility>
#include <vector>

namespace hshfit::brdfs {

/// A BRDF as a smooth part and one lobe of microfacets,
///     f_c = constant_c + sum_t weight_{t,c} T_t(wi, wo),
/// in which the terms of the lobe are D(h) times a factor that varies slowly, and the others have
/// no peak.
struct FacetNormals {
    /// D in 1/sr, in axes that are turned about the normal; 1 = integral of D cos.
    std::function<double(const Direction& h)> density;
    double widthX = 0, widthY = 0;  ///< alpha of GGX or Beckmann along these axes
    double turn = 0;                ///< of the axes, radians
    TermWeights weights = {};
    std::vector<bool> ofLobe = {};  ///< [term]
    FacetText text = {};            ///< without templates: the lobe has no closed form in shaders
};

/// A model whose lobe is one of microfacets.
class HasFacetNormals {
public:
    virtual ~HasFacetNormals() = default;
    virtual const FacetNormals& facetNormals() const = 0;
    /// out[term] = T_t(wi, wo); 0 where wi.z <= 0 or wo.z <= 0.
    virtual void terms(const Direction& wi, const Direction& wo, double* out) const = 0;
};

/// A TermBrdf with these facets.
template <class Base>
class WithFacetNormals final : public Base, public HasFacetNormals {
public:
    template <class... Arguments>
    explicit WithFacetNormals(FacetNormals facets, Arguments&&... arguments)
        : Base(std::forward<Arguments>(arguments)...), facets_(std::move(facets)) {}

    const FacetNormals& facetNormals() const override { return facets_; }
    void terms(const Direction& wi, const Direction& wo, double* out) const override {
        // As channels in which one term has the weight 1.
        constexpr std::size_t together = TermBatch::maxChannels;
        const std::size_t count = facets_.ofLobe.size();
        const double constant[together] = {};
        for (std::size_t first = 0; first < count; first += together) {
            const std::size_t channels = std::min(together, count - first);
            double weights[together * TermBatch::maxTerms] = {};
            for (std::size_t c = 0; c < channels; ++c) weights[c * count + first + c] = 1;
            if (wo.z > 0) {
                this->evalBatch({wo,
                                 {&wi.x, &wi.y, &wi.z, 1},
                                 out + first,
                                 channels,
                                 count,
                                 constant,
                                 weights});
            } else {
                std::fill_n(out + first, channels, 0.0);
            }
        }
    }

private:
    FacetNormals facets_;
};

/// D of GGX (Walter et al. 2007, Eq. 33; Heitz 2014 for two widths).
std::function<double(const Direction& h)> ggxNormals(double ax, double ay);
/// D of Beckmann (Walter et al. 2007, Eq. 25), a Gaussian of slopes.
std::function<double(const Direction& h)> beckmannNormals(double ax, double ay);
/// The normals of a model of microfacet.h with this D, a Gaussian of slopes or not.
FacetNormals microfacetNormals(const Model& model, const Parameters& p,
                               std::function<double(const Direction& h)> density,
                               const RoughnessOf<double>& roughness, bool gaussian);

}  // namespace hshfit::brdfs
