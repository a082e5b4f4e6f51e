#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/filtered_maps/filtered_sidecar.h>
#include <hshfit/normal_filtering/mip_errors.h>

#include <brdfs/analytic/facet_normals.h>

#include <map>
#include <memory>
#include <shared_mutex>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::jobs {

/// The models of facets whose lobe has a closed form in shaders.
std::vector<std::string_view> closedFacetModels();

/// A model as smooth part and lobe of microfacets, at one setting of its parameters.
struct FacetLobe {
    std::unique_ptr<Brdf> brdf;
    const brdfs::HasFacetNormals* facets = nullptr;

    /// Throws InputError for a model that is no such sum, naming those that are.
    explicit FacetLobe(const std::string& specification);
    const brdfs::FacetNormals& normals() const { return facets->facetNormals(); }
};

/// A model whose lobe has parameters from texel to texel. Safe to use from many threads.
class FacetLobes {
public:
    /// `model` is the specification without the parameters of `nodes`; errors name `file`.
    FacetLobes(std::string model, std::vector<LobeNodes> nodes, const std::string& file = {});

    const std::string& model() const { return model_; }
    const std::vector<LobeNodes>& nodes() const { return nodes_; }
    /// Opened once and kept.
    const FacetLobe& at(const LobePlace& place) const;
    std::string specification(const LobePlace& place) const;
    /// Terms of the lobe, and the smooth one that is not constant; -1: none.
    const std::vector<std::size_t>& lobeTerms() const { return lobeTerms_; }
    int smoothTerm() const { return smoothTerm_; }
    /// Throws InputError, which names the file, if a sidecar states another number of terms.
    void checkTerms(std::size_t stated, const std::string& file) const;

    std::shared_ptr<const LobeTable> table(int order) const;
    /// D at the nodes, for shaders.
    std::vector<StoredLobe> stored(const LobeTable& table) const;

    /// f and its parts for texels with the weights in `terms` (FilteredSidecar). The result keeps a
    /// reference to this object.
    FilteredSurface surface(const std::vector<std::vector<LobeWeight>>& terms, std::size_t channels,
                            int albedos) const;

private:
    std::string model_;
    std::vector<LobeNodes> nodes_;
    std::vector<std::size_t> lobeTerms_;
    int smoothTerm_ = -1;
    mutable std::shared_mutex mutex_;
    mutable std::map<LobePlace, std::unique_ptr<FacetLobe>> lobes_;
};

}  // namespace hshfit::jobs
