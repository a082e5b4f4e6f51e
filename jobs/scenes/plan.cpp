#include "plan.h"

#include <jobs/exports/formula_candidates.h>
#include <jobs/exports/projection_cache.h>
#include <jobs/source/source.h>
#include "scene_surfaces.h"

#include <hshfit/error.h>
#include <hshfit/files/output_rule.h>
#include <hshfit/plan/plan_files.h>
#include <hshfit/wording.h>

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

namespace hshfit::jobs {
namespace {

std::vector<plan::SeenMaterial> seenIn(const scene::Scene& read) {
    std::vector<SurfaceMaterial> names;
    for (const scene::Material& material : read.materials)
        names.push_back({material.name, nullptr, nullptr});
    std::size_t degenerate = 0;
    return plan::seenMaterials({std::move(names), objectsOf(read, degenerate), {}}, read.cameras);
}

}  // namespace

plan::Plan planScene(const std::string& path, const std::string& output,
                     const plan::PlanOptions& options, const Listener& listener) {
    requireFormulaKinds(options.formulas);
    const scene::Scene read = scene::readScene(path, scene::Purpose::plan);
    if (read.limits.nanoseconds && !options.byTime) {
        listener.say(
            fmt::format("the limit in nanoseconds counts with {} only: no times were taken",
                        Setting{"PlanOptions::byTime"}));
    }
    plan::PlanOptions how = options;
    useCache(how.folder, listener, std::filesystem::path(read.file).parent_path());
    if (!read.objects.empty() && !read.cameras.empty()) how.seen = seenIn(read);
    how.makeFormulas = [](const Brdf& brdf, const scene::Material& material,
                          const std::vector<std::string>& kinds) {
        return formulaCandidates({brdf, material.brdf, material.name}, kinds);
    };
    how.progress = listener.part("plan");
    how.found = [&](const scene::Material& material, const plan::Choice& choice) {
        listener.say(fmt::format("{}: so far {} bytes, error {:.3g} of {:g}", material.name,
                                 choice.bytes, choice.error, material.budget.error));
    };
    plan::Plan result = plan::planScene(
        read, [](const std::string& spec) { return openBrdf(spec); }, how);
    const auto hasPlan = [](const plan::MaterialPlan& each) { return each.accepted.has_value(); };
    if (!std::ranges::all_of(result.materials, hasPlan))
        stateExitCode(static_cast<int>(ExitCode::numeric));
    plan::writePlan(result, output);
    return result;
}

}  // namespace hshfit::jobs
