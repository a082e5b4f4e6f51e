#include <hshfit/plan/plan.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/plan/material_search.h>
#include <hshfit/wording.h>

#include <fmt/format.h>

namespace hshfit::plan {
namespace {

void requireUsable(const std::vector<std::string>& names) {
    for (const std::string& name : names) {
        if (bases::find(name).orthonormal) continue;
        throw UsageError(fmt::format(
            "{}: {} is not orthonormal; the planner cuts projections to lower orders, which needs "
            "bases that are",
            Setting{"PlanOptions::bases"}, name));
    }
}

}  // namespace

Plan planScene(const Scene& scene, const BrdfOpener& open, const PlanOptions& options) {
    requireUsable(options.bases);
    Plan plan{.scene = scene, .materials = {}};
    for (const Material& material : scene.materials) {
        MaterialSearch search(scene, material, open, options);
        plan.materials.push_back(search.run());
        if (options.progress) options.progress(plan.materials.size(), scene.materials.size());
    }
    return plan;
}

std::string commandOf(const Choice& choice, const std::string& file) {
    Call call{.function = "represent",
              .subject = choice.spec,
              .settings = settingsOf(choice.form),
              .output = file};
    if (choice.tolerance > 0) {
        call.settings.push_back(
            {"ProjectionOptions::tolerance", fmt::format("{:g}", choice.tolerance)});
    }
    return fmt::format("{}", call);
}

}  // namespace hshfit::plan
