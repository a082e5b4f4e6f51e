#include "arrays.h"
#include "job_options.h"
#include "watched.h"

#include <hshfit/error.h>
#include <hshfit/plan/plan_files.h>

#include <jobs/scenes/illuminate.h>
#include <jobs/scenes/plan.h>
#include <jobs/scenes/transfer.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pybind11/stl.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::python {
namespace {

namespace bounds = jobs::bounds;

std::string pathOrNone(const py::object& path, const char* name) {
    return path.is_none() ? std::string() : pathOf(path, name);
}

py::object illuminated(const py::object& scene, const py::object& folder, const std::string& method,
                       const std::string& camera, const py::object& samples, int bounces,
                       int fromBounce, std::uint64_t seed, const py::object& reference,
                       const py::object& exposure, const py::object& basis, const py::object& order,
                       const py::object& loss, const py::object& rays, const py::object& accuracy,
                       const py::object& chooseBy, const py::object& records, bool resume,
                       bool force, const py::object& progress) {
    const bool cached = method == "radiance-cache";
    if (!cached && method != "path")
        throw UsageError(fmt::format("method: '{}' is none of path, radiance-cache", method));
    const std::pair<const char*, const py::object&> ofTheCache[] = {
        {"basis", basis},       {"order", order},        {"loss", loss},      {"rays", rays},
        {"accuracy", accuracy}, {"choose_by", chooseBy}, {"records", records}};
    for (const auto& [name, value] : ofTheCache)
        if (!cached && !value.is_none())
            throw UsageError(fmt::format("{} is for the method radiance-cache, not path", name));
    const std::string choice = chooseBy.is_none() ? "cost" : py::str(chooseBy).cast<std::string>();
    if (choice != "cost" && choice != "loss")
        throw UsageError(fmt::format("choose_by: '{}' is none of cost, loss", choice));
    if (cached && resume)
        throw UsageError("resume is for the method path; records are kept by records");
    jobs::IlluminateOptions options{.camera = camera, .force = force, .resume = resume};
    options.path.samples =
        samples.is_none() ? (cached ? 16 : options.path.samples) : samples.cast<int>();
    requireWithin("samples", options.path.samples, bounds::pathSamples);
    requireWithin("bounces", bounces, bounds::mostBounces);
    requireWithin("from_bounce", fromBounce, bounds::fewestBounces);
    options.path.mostBounces = bounces;
    options.path.fewestBounces = fromBounce;
    options.path.seed = seed;
    options.reference = pathOrNone(reference, "reference");
    options.records = pathOrNone(records, "records");
    if (!exposure.is_none()) options.stops = exposure.cast<double>();
    if (cached) {
        CacheOptions cache;
        if (!basis.is_none()) cache.choice.basis = basis.cast<std::string>();
        if (!order.is_none()) cache.choice.order = order.cast<int>();
        if (!loss.is_none()) cache.choice.loss = loss.cast<double>();
        if (!rays.is_none()) cache.rays = rays.cast<int>();
        if (!accuracy.is_none()) cache.accuracy = accuracy.cast<double>();
        requireWithin("loss", cache.choice.loss, bounds::cacheLoss);
        requireWithin("rays", cache.rays, bounds::cacheRays);
        cache.mostBytes = jobs::defaultCacheBytes;
        options.cache = cache;
        options.chooseByCost = choice == "cost";
    }
    const std::string path = pathOf(scene, "scene"), output = pathOf(folder, "folder");
    nlohmann::ordered_json answer;
    watched(progress, {}, [&](const jobs::Listener& listener) {
        answer = jobs::illuminateJson(jobs::illuminate(path, output, options, listener), method);
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
    const jobs::IlluminateOptions options;
    const CacheOptions cache;
    const std::string doc = fmt::format(
        R"(Pictures with global illumination: CAMERA.exr with standard errors, and CAMERA.png.

scene    a scene file (JSON: materials, objects, lights, cameras)
method   "path": path tracing; "radiance-cache": records of incident light as coefficients
         (Krivanek et al. 2005)
samples  paths through a pixel; None: 64, with records 16
bounces, from_bounce: the range of reflections that count
Of the method radiance-cache alone, None for the defaults: basis ("{}") and highest order ({})
of the records, rays ({}) of each, accuracy ({}), loss ({}) of energy above which a material is
sampled, choose_by ("cost", "loss"); records: a file of them to go on from.

Radiance is in W/(m^2 sr) for lights so given. Returns the answer of the command: of each camera
seconds, rays, records, mean and its standard errors; relative_mse against `reference` (an EXR).)",
        cache.choice.basis, cache.choice.order, cache.rays, cache.accuracy, cache.choice.loss);
    module.def("illuminate", illuminated, py::arg("scene"), py::arg("folder"), py::kw_only(),
               py::arg("method") = "path", py::arg("camera") = options.camera,
               py::arg("samples") = py::none(), py::arg("bounces") = options.path.mostBounces,
               py::arg("from_bounce") = options.path.fewestBounces,
               py::arg("seed") = options.path.seed, py::arg("reference") = py::none(),
               py::arg("exposure") = py::none(), py::arg("basis") = py::none(),
               py::arg("order") = py::none(), py::arg("loss") = py::none(),
               py::arg("rays") = py::none(), py::arg("accuracy") = py::none(),
               py::arg("choose_by") = py::none(), py::arg("records") = py::none(),
               py::arg("resume") = options.resume, py::arg("force") = options.force,
               py::arg("progress") = py::none(), doc.c_str());
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
