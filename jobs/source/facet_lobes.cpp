#include "facet_lobes.h"

#include <hshfit/brdf/vectors.h>
#include <hshfit/error.h>

#include <brdfs/catalog.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <mutex>

namespace hshfit::jobs {
namespace {

/// The models that are sums of a smooth part and one lobe of microfacets, at any setting of theirs.
template <class Has>
std::vector<std::string_view> modelsWith(const Has& has) {
    std::vector<std::string_view> names;
    for (const brdfs::Model& model : brdfs::models()) {
        for (const char* setting : {"", ":alpha=0.5", ":ax=0.5,ay=0.5"}) {
            try {
                const auto brdf = brdfs::openModel(std::string(model.name) + setting);
                const auto* facets = dynamic_cast<const brdfs::HasFacetNormals*>(brdf.get());
                if (facets == nullptr || !has(facets->facetNormals())) continue;
                names.push_back(model.name);
                break;
            } catch (const UsageError&) {
                continue;  // it has other parameters
            }
        }
    }
    return names;
}

std::vector<std::string_view> facetModels() {
    return modelsWith([](const brdfs::FacetNormals&) { return true; });
}

using Terms = std::array<double, brdfs::TermBatch::maxTerms>;

/// The terms in the axes of D.
Terms termsOf(const FacetLobe& lobe, const Direction& wi, const Direction& wo) {
    Terms terms{};
    const double turn = lobe.normals().turn;
    if (turn == 0)
        lobe.facets->terms(wi, wo, terms.data());
    else
        lobe.facets->terms(rotateAboutZ(wi, turn), rotateAboutZ(wo, turn), terms.data());
    return terms;
}

}  // namespace

std::vector<std::string_view> closedFacetModels() {
    return modelsWith(
        [](const brdfs::FacetNormals& normals) { return !normals.text.terms.empty(); });
}

FacetLobe::FacetLobe(const std::string& specification)
    : brdf(brdfs::openModel(specification)),
      facets(dynamic_cast<const brdfs::HasFacetNormals*>(brdf.get())) {
    if (facets != nullptr) return;
    throw InputError(fmt::format(
        "{} is no smooth part and one lobe of microfacets, which turned and filtered "
        "texels need; models that are: {} (gltf-pbr without clearcoat, sheen and iridescence)",
        specification, fmt::join(facetModels(), ", ")));
}

namespace {

/// The model and its parameters are stated in `file`.
const FacetLobe& firstOf(const FacetLobes& lobes, const std::string& file) {
    try {
        return lobes.at({0, 0});
    } catch (const UsageError& error) {
        throw InputError(file.empty() ? error.what() : fmt::format("{}: {}", file, error.what()));
    }
}

}  // namespace

FacetLobes::FacetLobes(std::string model, std::vector<LobeNodes> nodes, const std::string& file)
    : model_(std::move(model)), nodes_(std::move(nodes)) {
    const brdfs::FacetNormals& normals = firstOf(*this, file).normals();
    for (std::size_t t = 0; t < normals.ofLobe.size(); ++t) {
        if (normals.ofLobe[t]) {
            lobeTerms_.push_back(t);
        } else if (smoothTerm_ < 0) {
            smoothTerm_ = static_cast<int>(t);
        }
    }
}

std::string FacetLobes::specification(const LobePlace& place) const {
    std::string result = model_;
    for (std::size_t k = 0; k < nodes_.size(); ++k) {
        result += fmt::format("{}{}={}", result.find(':') == std::string::npos ? ':' : ',',
                              nodes_[k].name, nodes_[k].valueAt(place[k]));
    }
    return result;
}

const FacetLobe& FacetLobes::at(const LobePlace& place) const {
    {
        const std::shared_lock lock(mutex_);
        const auto found = lobes_.find(place);
        if (found != lobes_.end()) return *found->second;
    }
    auto lobe = std::make_unique<FacetLobe>(specification(place));
    const std::unique_lock lock(mutex_);
    return *lobes_.try_emplace(place, std::move(lobe)).first->second;
}

void FacetLobes::checkTerms(std::size_t stated, const std::string& file) const {
    if (stated != lobeTerms_.size())
        throw InputError(fmt::format("{}: states {} terms; the lobe of {} has {}", file, stated,
                                     model_, lobeTerms_.size()));
}

std::shared_ptr<const LobeTable> FacetLobes::table(int order) const {
    const auto count = [&](std::size_t k) {
        return k < nodes_.size() ? nodes_[k].values.size() : std::size_t{1};
    };
    return std::make_shared<LobeTable>(
        count(0), count(1),
        [this](std::size_t row, std::size_t column) {
            const brdfs::FacetNormals& normals =
                at({static_cast<double>(row), static_cast<double>(column)}).normals();
            return NormalDistribution{normals.density, normals.widthX, normals.widthY};
        },
        LobeTableOptions{std::max(order, 3)});
}

std::vector<StoredLobe> FacetLobes::stored(const LobeTable& table) const {
    std::vector<StoredLobe> lobes;
    for (std::size_t row = 0; row < table.rows(); ++row) {
        for (std::size_t column = 0; column < table.columns(); ++column) {
            const LobePlace place{static_cast<double>(row), static_cast<double>(column)};
            const auto widths = table.widths(place);
            lobes.push_back({widths[0], widths[1], table.gaussians(place)});
        }
    }
    return lobes;
}

FilteredSurface FacetLobes::surface(const std::vector<std::vector<LobeWeight>>& terms,
                                    std::size_t channels, int albedos) const {
    FilteredSurface s;
    s.channels = static_cast<int>(channels);
    s.brdf = [this, terms, albedos](const SurfaceTexel& texel, const Direction& wi,
                                    const Direction& wo, std::span<double> out) {
        const Terms values = termsOf(at(texel.lobe), wi, wo);
        const double smooth = smoothTerm_ < 0 ? 1 : values[static_cast<std::size_t>(smoothTerm_)];
        for (std::size_t c = 0; c < out.size(); ++c) {
            out[c] = albedos == 0 ? 0 : texel.albedos[albedos == 1 ? 0 : c] / pi * smooth;
            for (std::size_t k = 0; k < lobeTerms_.size(); ++k) {
                const LobeWeight& weight = terms[k][c];
                out[c] += values[lobeTerms_[k]] * weight.scale * texel.weights[weight.weight];
            }
        }
    };
    s.rest = [this, terms](const FilteredTexel& texel, const Direction& wi, const Direction& wo,
                           std::span<const double> densities, std::span<double> out) {
        const FacetLobe& lobe = at(texel.lobe());
        const Direction sum = wi + wo;
        const double density = lobe.normals().density(normalised(sum));
        if (!(density > 0)) return;  // too far from the peak for a double
        const Terms values = termsOf(lobe, wi, wo);
        for (std::size_t c = 0; c < out.size(); ++c) {
            for (std::size_t k = 0; k < lobeTerms_.size(); ++k) {
                const LobeWeight& weight = terms[k][c];
                if (weight.scale == 0) continue;
                out[c] += wi.z * values[lobeTerms_[k]] / density * weight.scale *
                          densities[weight.weight];
            }
        }
    };
    if (smoothTerm_ >= 0) {
        s.shape = [this](const FilteredTexel& texel, const Direction& wi, const Direction& wo) {
            return termsOf(at(texel.lobe()), wi, wo)[static_cast<std::size_t>(smoothTerm_)];
        };
    }
    return s;
}

}  // namespace hshfit::jobs
