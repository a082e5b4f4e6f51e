#pragma once

#include <brdfs/analytic/term_brdf.h>

#include <vector>

namespace hshfit::brdfs {

/// F0, fresnel, ior and k: the reflectance of a microfacet model's facets.
///     schlick     F0 + (1 - F0)(1 - cos)^5
///     dielectric  Fresnel's equations for the index ior; below 1, with total reflection
///     conductor   the same for ior + i k
/// Each of F0, ior and k is one value or r/g/b.
std::vector<Parameter> facetFresnelParameters();

/// Index of refraction ior + i k.
template <class N>
struct FacetIndex {
    N ior, k;
};

/// F as a sum of terms that all channels share, for TermBrdf: sum_t weight_{t,c} F_t(cos).
class FacetFresnel {
public:
    /// Throws UsageError for a key that the chosen form does not use, and for a missing key.
    FacetFresnel(const Model& model, const Parameters& parameters);

    /// The weights of the terms, at most three of them, times a scale per channel.
    std::vector<Colour> weights(const Colour& scale) const;

    /// The indices of the terms F_t (facet_terms.h). Empty for Schlick's form.
    const std::vector<FacetIndex<double>>& indices() const { return indices_; }

private:
    std::vector<FacetIndex<double>> indices_;
    std::vector<Colour> weights_;
};

}  // namespace hshfit::brdfs
