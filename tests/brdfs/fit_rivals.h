#pragma once

#include <brdfs/catalog.h>
#include <brdfs/fit/fit.h>
#include <brdfs/presets/preset_collection.h>

#include <array>
#include <chrono>
#include <optional>
#include <string>
#include <string_view>

namespace hshfit::brdfs {

/// A collection of published fits, the same model with free parameters, and the loss of both.
struct Rival {
    std::string_view collection;
    std::string_view model;
    Loss::Kind loss;
    bool perChannel = false;
    int starts = 16;
};

/// Ngan et al. 2005 and E1 of Löw et al. 2012 minimise squares of errors of f cos(theta_i), E2 of
/// Löw et al. squares of errors of ln(1 + f cos(theta_i)). Bagher et al. 2012 are held to the
/// squares for f cos(theta_i). There are no published parameters of GGX for these materials; the
/// fits of Cook and Torrance's model take their place.
inline constexpr std::array rivals{
    Rival{"ngan-ward", "ward:variant=1992", Loss::Kind::cosine},
    Rival{"ngan-ward-duer", "ward:variant=duer", Loss::Kind::cosine},
    Rival{"ngan-cook-torrance", "cook-torrance:norm=pi2,fresnel=schlick", Loss::Kind::cosine},
    Rival{"low-cook-torrance-e1", "cook-torrance", Loss::Kind::cosine},
    Rival{"low-cook-torrance-e2", "cook-torrance", Loss::Kind::log},
    Rival{"low-abc-smooth-e2", "abc:variant=smooth", Loss::Kind::log},
    Rival{"low-abc-microfacet-e2", "abc:variant=microfacet", Loss::Kind::log},
    Rival{"bagher-sgd", "sgd", Loss::Kind::cosine, true, 8},
    Rival{"ngan-cook-torrance", "ggx", Loss::Kind::cosine},
    Rival{"low-cook-torrance-e2", "ggx", Loss::Kind::log},
};

/// The samples that both sides are measured on: the cells of a slice with both directions within 80
/// degrees of the normal (Ngan et al. 2005 leave out the rest), weighted by solid angle; of a whole
/// table so many that are drawn evenly.
inline FitSamples samplesOfSlice(const std::string& path, double grazingCut = 80) {
    constexpr std::size_t mostOfTable = 20000;
    return gatherSamples(*open(path), {.weights = SampleWeights::solidAngle,
                                       .places = SamplePlaces::cells,
                                       .grazingCut = grazingCut,
                                       .most = path.ends_with(".binary") ? mostOfTable : 0});
}

struct Duel {
    std::optional<double> published;  ///< FitResult::loss; none if the collection lacks it
    double ours = 0;
    FitResult fit;
    double seconds = 0;
    double ratio() const { return ours / published.value(); }
};

/// Our loss is evaluated like the published one, by opening the specification of the fit.
inline Duel duel(const Rival& rival, const std::string& material, const FitSamples& samples) {
    const auto start = std::chrono::steady_clock::now();
    Duel result;
    result.fit = fit(samples, {.model = std::string(rival.model),
                               .loss = rival.loss,
                               .perChannel = rival.perChannel,
                               .starts = rival.starts});
    result.ours = lossOf(*open(result.fit.spec), samples, rival.loss);
    result.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const PresetCollection& collection = presetCollection(*findPresetCollection(rival.collection));
    if (const PresetCollection::Material* published = findMaterial(collection, material))
        result.published = lossOf(*open(published->spec), samples, rival.loss);
    return result;
}

}  // namespace hshfit::brdfs
