#include <hshfit/plan/plan.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/plan/internal/material_search.h>
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

MaterialPlan planMaterial(const Scene& scene, const Material& material, const BrdfOpener& open,
                          const PlanOptions& options, const gpu::ShaderCosts* costs,
                          const TimeLimit& limit) {
    try {
        return MaterialSearch(scene, material, open, options, costs, limit).run();
    } catch (const Error& error) {
        const std::string_view message = error.what();
        if (message.find(scene.file) != std::string_view::npos) throw;
        throw Error(error.code(),
                    fmt::format("{}: material '{}': {}", scene.file, material.name, message));
    }
}

}  // namespace

Plan planScene(const Scene& given, const BrdfOpener& open, const PlanOptions& options) {
    requireUsable(options.bases);
    Plan plan{.scene = given, .materials = {}};
    std::optional<gpu::ShaderCosts> costs;
    if (options.costs) plan.costs = {costs.emplace().device(), costs->ggx()};
    Scene& scene = plan.scene;
    const bool cameras = options.seen.size() == scene.materials.size();
    if (cameras) takeSeen(scene, options.seen);
    Scene own = scene;
    const TimeLimit limit(options.seconds);
    for (std::size_t m = 0; m < scene.materials.size(); ++m) {
        const Material& material = scene.materials[m];
        own.views = material.views.value_or(scene.views);
        const double left = static_cast<double>(scene.materials.size() - m);
        plan.materials.push_back(planMaterial(own, material, open, options,
                                              costs ? &*costs : nullptr, limit.share(left)));
        if (cameras) plan.materials.back().seen = options.seen[m];
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
