#include <hshfit/plan/plan.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/plan/material_search.h>

#include <fmt/format.h>

namespace hshfit::plan {
namespace {

void requireUsable(const std::vector<std::string>& names) {
    for (const std::string& name : names) {
        if (bases::find(name).orthonormal) continue;
        throw UsageError(fmt::format(
            "--bases: {} is not orthonormal; the planner cuts projections to lower orders, which "
            "needs bases that are",
            name));
    }
}

/// Quoted for a shell.
std::string quoted(const std::string& text) {
    std::string out(1, '\'');
    for (char c : text) {
        if (c == '\'') out += "'\\'";
        out += c;
    }
    out += '\'';
    return out;
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
    const std::string tolerance =
        choice.tolerance > 0 ? fmt::format(" --tolerance {:g}", choice.tolerance) : "";
    return fmt::format("hshfit project {} {}{} -o {}", quoted(choice.spec), optionsOf(choice.form),
                       tolerance, file);
}

}  // namespace hshfit::plan
