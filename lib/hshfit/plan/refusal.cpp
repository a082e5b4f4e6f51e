#include <hshfit/plan/internal/material_search.h>
#include <hshfit/wording.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hshfit::plan {
namespace {

/// The narrowest lobe at 45 degrees, in degrees of wi; none for a diffuse BRDF.
std::optional<double> lobeDegrees(const Brdf& brdf) {
    const std::vector<Lobe> lobes = brdf.lobes(directionFromAngles(pi / 4, 0));
    if (lobes.empty()) return {};
    double width = std::numeric_limits<double>::infinity();
    for (const Lobe& lobe : lobes) {
        // An angle of the half vector moves wi by twice that angle.
        width = std::min(
            width, lobe.about == Lobe::About::halfway ? 2 * std::atan(lobe.width) : lobe.width);
    }
    return degrees(width);
}

bool isModel(const Brdf& brdf) {
    for (const Fact& fact : brdf.facts()) {
        if (fact.first == "model") return true;
    }
    return false;
}

struct LightKinds {
    bool small = false, wide = false;
};
LightKinds kindsOf(const Scene& scene) {
    LightKinds kinds;
    for (const Light& light : scene.lights) {
        const bool small =
            std::holds_alternative<DiscLight>(light) || std::holds_alternative<PanelLight>(light);
        (small ? kinds.small : kinds.wide) = true;
    }
    return kinds;
}

}  // namespace

double MaterialSearch::leastFloor() const {
    double least = std::numeric_limits<double>::infinity();
    for (const Version& version : versions_) {
        for (const auto& [split, part] : version.parts) {
            for (const auto& [basis, floor] : part.floor) {
                for (double error : floor) least = std::min(least, error);
            }
        }
    }
    return least;
}

void MaterialSearch::refuse() {
    const Brdf& brdf = *versions_.front().brdf;
    const std::optional<double> width = lobeDegrees(brdf);
    const Material& material = plan_.material;
    if (!rungs_.empty()) findNeighbours(0);
    if (plan_.refused.empty()) {
        const std::string lobe =
            width ? fmt::format(" Its lobe is about {:.2g}° wide at 45°.", *width) : "";
        if (!light_->converged()) {
            plan_.refused = fmt::format(
                "outgoing radiance still changes by {:.2g} with {} directions of light: no form of "
                "order {} follows what they do not resolve.{}",
                light_->change(), light_->samples(), options_.maxOrder, lobe);
        } else if (plan_.cut) {
            plan_.refused =
                fmt::format("the time was over after {} of {} forms", plan_.tried, rungs_.size());
        } else if (!looksRight_.empty()) {
            plan_.refused = fmt::format(
                "forms within {} bytes and order {} keep to {:g}, but their pictures have a FLIP "
                "above {:g}.{}",
                scene_.limits.bytes, options_.maxOrder, material.budget.error,
                material.budget.flip.value_or(0), lobe);
        } else {
            const std::string tried = plan_.cheaper.empty()
                                          ? ""
                                          : fmt::format(" The best that was tried has {:.2g}.",
                                                        plan_.cheaper.back().error);
            plan_.refused = fmt::format(
                "no form within {} bytes and order {} keeps to {:g}: cutting off higher bands "
                "alone "
                "costs {:.2g} or more.{}{}",
                scene_.limits.bytes, options_.maxOrder, material.budget.error, leastFloor(), tried,
                lobe);
        }
    }
    if (isModel(brdf)) {
        plan_.instead.push_back(fmt::format("the model itself: {}", brdf.name()));
    } else {
        plan_.instead.push_back(fmt::format(
            "an analytic lobe: {}; named as 'lobe' in the scene, it is taken out first and the "
            "remainder planned",
            Call{.function = "fit", .subject = material.brdf}));
    }
    const LightKinds kinds = kindsOf(scene_);
    if (kinds.small) {
        plan_.instead.push_back(fmt::format(
            "for discs and panels: multiple importance sampling of light and lobe, or linearly "
            "transformed cosines ({})",
            Call{.function = "linearlyTransformedCosines"}));
    }
    if (kinds.wide) {
        plan_.instead.emplace_back(
            "for sky and environment: the picture prefiltered by the lobe's width, times the "
            "directional albedo");
    }
}

}  // namespace hshfit::plan
