#include "answers.h"
#include "arrays.h"
#include "job_options.h"
#include "watched.h"

#include <hshfit/coefficient_files/coefficient_file.h>
#include <hshfit/coefficient_files/light_file.h>
#include <hshfit/coefficient_files/representation_file.h>
#include <hshfit/error.h>
#include <hshfit/files/json_fields.h>

#include <jobs/exports/sample.h>
#include <jobs/studies/convert.h>
#include <jobs/studies/import.h>
#include <jobs/studies/info.h>

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <nlohmann/json.hpp>

#include <algorithm>
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

py::dict converted(const py::object& input, const py::object& output, const py::kwargs& keywords) {
    jobs::ConvertOptions options;
    const py::object progress =
        optionsFrom(keywords, boundOptions(jobs::convertOptions(), options));
    const std::string from = pathOf(input, "input"), to = pathOf(output, "output");
    jobs::Converted done;
    watched(progress, {}, [&](const jobs::Listener& listener) {
        done = jobs::convert(from, to, options, listener);
    });
    return convertedDict(done);
}

void imported(const py::object& input, const py::object& output, const py::kwargs& keywords) {
    jobs::ImportOptions options;
    Keywords given(keywords);
    given.set(boundOptions(jobs::importOptions(), options));
    given.finish();
    const std::string from = pathOf(input, "input"), to = pathOf(output, "output");
    const py::gil_scoped_release released;
    jobs::importCoefficients(from, to, options);
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

py::dict described(const py::object& spec, const py::kwargs& keywords) {
    jobs::InfoOptions options;
    const py::object progress = optionsFrom(keywords, boundOptions(jobs::infoOptions(), options));
    const std::string source = pathOf(spec, "spec");
    jobs::BrdfInfo info;
    watched(progress, {}, [&](const jobs::Listener& listener) {
        info = jobs::describeSource(source, options, listener);
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

/// The options of sample(); it makes no report.
Options optionsOf(jobs::SampleOptions& options) {
    return only(boundOptions(jobs::sampleOptions(), options), {"count", "method", "seed"});
}

py::dict sampled(const py::object& spec, const py::object& outgoing, const py::kwargs& keywords) {
    jobs::SampleOptions options{.elevations = 0};
    const py::object progress = optionsFrom(keywords, optionsOf(options));
    const std::string source = pathOf(spec, "spec");
    const std::vector<Direction> wo = directionsIn(vectorsOf(outgoing, "wo"), "wo");
    if (wo.size() != 1) throw UsageError("wo: one direction, of shape (3,)");
    options.outgoing = wo.front();
    jobs::Sampled done;
    watched(progress, {}, [&](const jobs::Listener&) { done = jobs::sample(source, "", options); });
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

void bindImport(py::module_& module) {
    jobs::ImportOptions imports;
    define(module,
           {"import_coefficients",
            "input: Path, output: Path",
            boundOptions(jobs::importOptions(), imports),
            "None",
            "Write the coefficients of a file of an export to .json or .exr.",
            {},
            false},
           imported, py::arg("input"), py::arg("output"));
}

}  // namespace

void bindFiles(py::module_& module) {
    module.def(
        "read", readFile, py::arg("path"),
        R"(Read a file by its content: Coefficients, a Form, Light, or, for everything else that
open() takes, a Brdf. Raises InputError that names the file and the field.)");
    jobs::ConvertOptions options;
    define(module,
           {"convert", "input: Path, output: Path", boundOptions(jobs::convertOptions(), options),
            "Row",
            R"(Write the BRDF of a specification or path in the format of other programs
(catalog("writers")). Returns a dict as Brdf.write() does.)"},
           converted, py::arg("input"), py::arg("output"));
    bindImport(module);
    jobs::InfoOptions info;
    define(module,
           {"describe", "spec: Path", boundOptions(jobs::infoOptions(), info), "Row",
            R"(The health of a BRDF, measured by evaluating it: a dict with "brdf", "min", "max",
"warnings", "health" (coverage, negative values, reciprocity, largest reflectance over wo,
largest albedo over wi) and "repairs".)"},
           described, py::arg("spec"));
    jobs::SampleOptions samples;
    define(
        module,
        {"sample", "spec: Path, wo: ArrayLike", optionsOf(samples), "Row",
         R"(Draw incident directions in proportion to f cos(theta_i) for the outgoing direction wo
(3,). Returns a dict: "wi" (n, 3), "pdf" (n,) in 1/sr, "weights" (n, channels) = f cos(theta_i) /
pdf, "parts".)"},
        sampled, py::arg("spec"), py::arg("wo"));
}

}  // namespace hshfit::python
