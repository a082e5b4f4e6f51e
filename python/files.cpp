#include "answers.h"
#include "arrays.h"
#include "watched.h"

#include <hshfit/coefficient_files/coefficient_file.h>
#include <hshfit/coefficient_files/light_file.h>
#include <hshfit/coefficient_files/representation_file.h>
#include <hshfit/error.h>
#include <hshfit/files/json_fields.h>

#include <jobs/exports/export.h>
#include <jobs/exports/sample.h>
#include <jobs/studies/convert.h>
#include <jobs/studies/import.h>
#include <jobs/studies/info.h>

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <nlohmann/json.hpp>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace hshfit::python {
namespace {

bool isPlain(const Representation& form) {
    return form.steps.empty() && form.added.empty() && form.as<CoefficientArray>();
}

/// Coefficients, a form, light or a BRDF, by the content of the file.
py::object readFile(const py::object& path) {
    const std::string file = pathOf(path, "path");
    std::optional<Representation> form;
    bool light = false;
    {
        const py::gil_scoped_release released;
        light = isLightFile(file);
        if (!light && looksLikeCoefficients(file)) form = readRepresentation(file);
    }
    const py::module_ module = py::module_::import("hshfit._hshfit");
    if (light) return module.attr("_read_light")(file);
    if (!form) return module.attr("open")(file);
    if (isPlain(*form)) return py::cast(std::make_shared<Coefficients>(decoded(*form)));
    return py::cast(std::make_shared<Representation>(std::move(*form)));
}

py::dict converted(const py::object& input, const py::object& output, const std::string& format,
                   const std::string& repairs, const py::object& outgoing, bool measureLoss,
                   bool rgb, bool force, const py::object& progress) {
    const jobs::ConvertOptions options{.format = format,
                                       .repairs = repairs,
                                       .outgoing = outgoingText(outgoing),
                                       .rgb = rgb,
                                       .measureLoss = measureLoss,
                                       .force = force};
    const std::string from = pathOf(input, "input"), to = pathOf(output, "output");
    jobs::Converted done;
    watched(progress, {}, [&](const jobs::Listener& listener) {
        done = jobs::convert(from, to, options, listener);
    });
    return convertedDict(done);
}

/// The options of an export as words.
struct ExportWords {
    std::string number, storage, packing;
    bool chroma = false;
};

void apply(const ExportWords& words, jobs::ExportOptions& options) {
    if (!words.number.empty()) options.number = gpu::parseNumber(words.number);
    options.storage = gpu::parseStorage(words.storage);
    if (words.packing != "coef4" && words.packing != "rgb")
        throw UsageError(fmt::format("packing: 'coef4' or 'rgb', not '{}'", words.packing));
    options.pack.packing = words.packing == "rgb" ? gpu::Packing::rgb : gpu::Packing::coef4;
    options.pack.luminanceChroma = words.chroma || options.pack.chromaOrder > 0;
}

py::dict exportedDict(const jobs::Exported& done) {
    py::dict out;
    py::list files;
    const auto add = [&](const std::string& role, const std::string& target,
                         const std::string& path) {
        py::dict file;
        file["role"] = role;
        file["target"] = target;
        file["path"] = path;
        files.append(file);
    };
    for (const gpu::ExportedFile& file : done.textures)
        add(std::string(gpu::roleName(file.role)), std::string(file.container), file.path);
    for (const jobs::ExportedText& file : done.texts) add(file.role, file.target, file.path);
    out["name"] = done.name;
    out["sidecar"] = done.sidecar;
    out["files"] = files;
    out["fit_error"] = fromJson(jobs::errorJson(done.error));
    out["poor"] = poorDict(done.poor);
    return out;
}

py::dict exported(const py::object& coefficients, const py::object& folder,
                  const py::object& targets, const std::string& name, const py::object& source,
                  const py::object& outgoing, const std::string& basis, int order,
                  const std::vector<std::string>& lights, const std::string& number,
                  const std::string& storage, const std::string& packing, bool chroma,
                  int chromaOrder, int basisTextures, int environmentOrder,
                  const std::string& prefix, const std::optional<bool>& sampling, bool measureError,
                  bool allowLoss, bool zstd, bool force, const py::object& progress) {
    jobs::ExportOptions options;
    options.targets = listText(targets);
    options.name = name;
    if (!source.is_none()) options.source = pathOf(source, "source");
    options.outgoing = outgoingText(outgoing);
    options.basis = basis;
    options.order = order;
    options.lights = lights;
    options.pack.chromaOrder = chromaOrder;
    options.pack.basisSize = basisTextures;
    options.shader.environmentOrder = environmentOrder;
    options.shader.prefix = prefix;
    options.sampling = sampling;
    options.measureError = measureError;
    options.allowLoss = allowLoss;
    options.zstd = zstd;
    options.force = force;
    apply({.number = number, .storage = storage, .packing = packing, .chroma = chroma}, options);
    const std::string from = pathOf(coefficients, "coefficients"), to = pathOf(folder, "folder");
    jobs::Exported done;
    watched(progress, {}, [&](const jobs::Listener& listener) {
        done = jobs::exportCoefficients(from, to, options, listener);
    });
    return exportedDict(done);
}

void imported(const py::object& input, const py::object& output, bool force) {
    const std::string from = pathOf(input, "input"), to = pathOf(output, "output");
    const py::gil_scoped_release released;
    jobs::importCoefficients(from, to, {.force = force});
}

py::dict healthOf(const Health& measured) {
    py::dict health;
    health["pairs"] = measured.pairs;
    health["coverage"] = measured.coverage;
    health["values"] = measured.values;
    health["negative"] = measured.negative;
    health["not_finite"] = measured.notFinite;
    health["reciprocity_defect"] = measured.reciprocityDefect;
    health["largest_reflectance"] = measured.largestReflectance();
    health["largest_albedo"] = measured.largestAlbedo();
    return health;
}

py::dict described(const py::object& spec, bool rgb, const py::object& progress) {
    const std::string source = pathOf(spec, "spec");
    jobs::BrdfInfo info;
    watched(progress, {}, [&](const jobs::Listener& listener) {
        info = jobs::describeSource(source, rgb, listener);
    });
    py::dict out;
    out["brdf"] = std::shared_ptr<Brdf>(std::move(info.brdf));
    out["min"] = info.least;
    out["max"] = info.greatest;
    out["warnings"] = info.warnings;
    out["health"] = info.health ? py::object(healthOf(*info.health)) : py::none();
    py::dict repairs;
    for (const auto& repair : info.repairs)
        repairs[py::str(std::string(repair.name))] = repair.reason;
    out["repairs"] = repairs;
    return out;
}

py::dict sampled(const py::object& spec, const py::object& outgoing, std::size_t count,
                 std::uint64_t seed, const std::string& method) {
    requireWithin("count", count, jobs::bounds::sampleCount);
    const std::string source = pathOf(spec, "spec");
    const std::vector<Direction> wo = directionsIn(vectorsOf(outgoing, "wo"), "wo");
    if (wo.size() != 1) throw UsageError("wo: one direction, of shape (3,)");
    const jobs::SampleOptions options{.method = jobs::sampleMethod(method),
                                      .outgoing = wo.front(),
                                      .count = count,
                                      .seed = seed,
                                      .elevations = 0};
    jobs::Sampled done;
    watched(py::none(), {},
            [&](const jobs::Listener&) { done = jobs::sample(source, "", options); });
    std::vector<Direction> drawn;
    std::vector<double> densities, weights;
    for (const jobs::DrawnDirection& one : done.drawn) {
        drawn.push_back(one.wi);
        densities.push_back(one.pdf);
        weights.insert(weights.end(), one.weights.begin(), one.weights.end());
    }
    const auto n = static_cast<py::ssize_t>(drawn.size());
    py::dict out;
    out["wi"] = arrayOf(drawn);
    out["pdf"] = arrayOf(std::move(densities), {n});
    out["weights"] =
        arrayOf(std::move(weights), {n, static_cast<py::ssize_t>(done.channels.size())});
    out["parts"] = done.parts;
    return out;
}

void bindExport(py::module_& module) {
    const jobs::ExportOptions options;
    module.def("export", exported, py::arg("coefficients"), py::arg("folder"), py::kw_only(),
               py::arg("targets") = options.targets, py::arg("name") = options.name,
               py::arg("source") = py::none(), py::arg("outgoing") = py::none(),
               py::arg("basis") = options.basis, py::arg("order") = options.order,
               py::arg("lights") = options.lights, py::arg("number") = "",
               py::arg("storage") = "auto", py::arg("packing") = "coef4",
               py::arg("chroma") = options.pack.luminanceChroma,
               py::arg("chroma_order") = options.pack.chromaOrder,
               py::arg("basis_textures") = options.pack.basisSize,
               py::arg("environment_order") = options.shader.environmentOrder,
               py::arg("prefix") = options.shader.prefix, py::arg("sampling") = options.sampling,
               py::arg("measure_error") = options.measureError,
               py::arg("allow_loss") = options.allowLoss, py::arg("zstd") = options.zstd,
               py::arg("force") = options.force, py::arg("progress") = py::none(),
               R"(Export a coefficient file to a folder: textures, shaders, a viewer.

targets: "all", or containers, shader languages and renderers with commas, or a sequence; the page
export.md of the documents lists them with the other options. Returns a dict: "files" (role,
target, path), "fit_error" against the source, "poor". All files are written, or none.)");
    module.def("import_coefficients", imported, py::arg("input"), py::arg("output"), py::kw_only(),
               py::arg("force") = false,
               "Write the coefficients of a file of an export to .json or .exr.");
}

}  // namespace

void bindFiles(py::module_& module) {
    module.def(
        "read", readFile, py::arg("path"),
        R"(Read a file by its content: Coefficients, a Form, Light, or, for everything else that
open() takes, a Brdf. Raises InputError that names the file and the field.)");
    const jobs::ConvertOptions options;
    module.def("convert", converted, py::arg("input"), py::arg("output"), py::kw_only(),
               py::arg("format") = options.format, py::arg("repairs") = options.repairs,
               py::arg("outgoing") = py::none(), py::arg("measure_loss") = options.measureLoss,
               py::arg("rgb") = options.rgb, py::arg("force") = options.force,
               py::arg("progress") = py::none(),
               R"(Write the BRDF of a specification or path in the format of other programs
(catalog("writers")). repairs: "all" or names with commas. Returns a dict as Brdf.write() does.)");
    bindExport(module);
    module.def("describe", described, py::arg("spec"), py::kw_only(), py::arg("rgb") = false,
               py::arg("progress") = py::none(),
               R"(The health of a BRDF, measured by evaluating it: a dict with "brdf", "min", "max",
"warnings", "health" (coverage, negative values, reciprocity, largest reflectance over wo,
largest albedo over wi) and "repairs".)");
    const jobs::SampleOptions samples;
    module.def(
        "sample", sampled, py::arg("spec"), py::arg("wo"), py::kw_only(),
        py::arg("count") = samples.count, py::arg("seed") = samples.seed,
        py::arg("method") = "auto",
        R"(Draw incident directions in proportion to f cos(theta_i) for the outgoing direction wo
(3,). Returns a dict: "wi" (n, 3), "pdf" (n,) in 1/sr, "weights" (n, channels) = f cos(theta_i) /
pdf, "parts". method: "auto", "table", "proposal", "stored" or "cosine".)");
}

}  // namespace hshfit::python
