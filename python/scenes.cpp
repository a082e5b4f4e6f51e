#include "arrays.h"
#include "job_options.h"
#include "watched.h"

#include <hshfit/error.h>
#include <hshfit/plan/plan_files.h>

#include <jobs/scenes/illuminate.h>
#include <jobs/scenes/plan.h>
#include <jobs/scenes/transfer.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <string>

namespace hshfit::python {
namespace {

Options optionsOf(jobs::IlluminateOptions& options) {
    return joined({boundOptions(jobs::illuminateOptions(), options),
                   boundOptions(jobs::cacheOptions(), options)});
}

py::object illuminated(const py::object& scene, const py::object& folder,
                       const py::kwargs& keywords) {
    jobs::IlluminateOptions options;
    Keywords given(keywords);
    given.dropNone();
    given.set(optionsOf(options));
    const py::object progress = given.take("progress");
    given.finish();
    if (const jobs::OptionRow* row = given.misplaced(jobs::illuminateBit(options.method)))
        throw UsageError(fmt::format("{} is for the method radiance-cache, not {}", keywordOf(*row),
                                     nameOf(options.method)));
    const std::string path = pathOf(scene, "scene"), output = pathOf(folder, "folder");
    nlohmann::ordered_json answer;
    watched(progress, {}, [&](const jobs::Listener& listener) {
        answer = jobs::illuminateJson(jobs::illuminate(path, output, options, listener));
    });
    return fromJson(answer);
}

py::object transferred(const py::object& scene, const py::object& folder,
                       const py::kwargs& keywords) {
    jobs::TransferOptions options;
    const py::object progress =
        optionsFrom(keywords, boundOptions(jobs::transferOptions(), options));
    const std::string path = pathOf(scene, "scene"), output = pathOf(folder, "folder");
    nlohmann::ordered_json answer;
    watched(progress, {}, [&](const jobs::Listener& listener) {
        answer = jobs::transferJson(jobs::transfer(path, output, options, listener), true);
    });
    return fromJson(answer);
}

py::object planned(const py::object& scene, const py::object& folder, const py::kwargs& keywords) {
    plan::PlanOptions options;
    const py::object progress = optionsFrom(keywords, boundOptions(jobs::planOptions(), options));
    const std::string path = pathOf(scene, "scene"), output = pathOf(folder, "folder");
    nlohmann::ordered_json answer;
    watched(progress, {}, [&](const jobs::Listener& listener) {
        answer = nlohmann::ordered_json::parse(
            plan::planJson(jobs::planScene(path, output, options, listener)));
    });
    return fromJson(answer);
}

void bindIlluminate(py::module_& module) {
    jobs::IlluminateOptions options;
    define(module,
           {"illuminate", "scene: Path, folder: Path", optionsOf(options), "Row",
            R"(Pictures with global illumination: CAMERA.exr with standard errors, and CAMERA.png.

scene: a scene file (JSON: materials, objects, lights, cameras). method "path": path tracing;
"radiance-cache": records of incident light as coefficients (Krivanek et al. 2005), to which alone
records and the options from basis on belong. None stands for what is not given.

Radiance is in W/(m^2 sr) for lights so given. Returns the answer of the command: of each camera
seconds, rays, records, mean and its standard errors; relative_mse against `reference` (an EXR).)"},
           illuminated, py::arg("scene"), py::arg("folder"));
}

void bindTransfer(py::module_& module) {
    jobs::TransferOptions options;
    define(
        module,
        {"transfer", "scene: Path, folder: Path", boundOptions(jobs::transferOptions(), options),
         "Row",
         R"(Precomputed transfer of a scene (Sloan et al. 2002): how light from all around reaches
each vertex.

Writes transfer.tensor, transfer.json and a page. Returns the answer of the command: vertices, rays,
energy by pass, bytes, errors.)"},
        transferred, py::arg("scene"), py::arg("folder"));
}

}  // namespace

void bindScenes(py::module_& module) {
    bindIlluminate(module);
    bindTransfer(module);
    plan::PlanOptions options;
    define(module,
           {"plan", "scene: Path, folder: Path", boundOptions(jobs::planOptions(), options), "Row",
            R"(The cheapest coefficient file for each material of a scene, checked in its own light.

scene: a scene file with lights and a budget. Writes the files and plan.json, plan.csv and plan.html
to folder. Returns the answer of the command: of each material its form, bytes, error and verified
error, or why it has no plan.)"},
           planned, py::arg("scene"), py::arg("folder"));
}

}  // namespace hshfit::python
