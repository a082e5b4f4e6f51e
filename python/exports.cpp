#include "answers.h"
#include "arrays.h"
#include "job_options.h"
#include "watched.h"

#include <jobs/exports/export.h>
#include <jobs/exports/export_material.h>
#include <jobs/lighting/lighting.h>

#include <pybind11/stl.h>
#include <nlohmann/json.hpp>

#include <string>

namespace hshfit::python {
namespace {

namespace exports = jobs::exports;

/// Those that are for this kind of exports.
Options onlyFor(unsigned kind, Options all) {
    std::erase_if(
        all, [&](const jobs::BoundOption& option) { return (option.row->inputs & kind) == 0; });
    return all;
}

Options optionsOf(jobs::ExportOptions& options) {
    return onlyFor(exports::coefficients, boundOptions(jobs::exportOptions(), options));
}

/// Options of materials or lighting, with those that they share with coefficients.
template <class Own>
struct SharedOptions {
    jobs::ExportOptions shared = {};
    Own own = {};
};

Options optionsOf(SharedOptions<jobs::MaterialExportOptions>& options) {
    options.shared.targets = options.own.targets;
    return onlyFor(exports::materials,
                   joined({boundOptions(jobs::exportOptions(), options.shared),
                           boundOptions(jobs::materialExportOptions(), options.own)}));
}

Options optionsOf(SharedOptions<jobs::LightingExportOptions>& options) {
    options.shared.targets = options.own.targets;
    return onlyFor(exports::lighting,
                   joined({boundOptions(jobs::exportOptions(), options.shared),
                           boundOptions(jobs::lightingExportOptions(), options.own)}));
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
                  const py::kwargs& keywords) {
    jobs::ExportOptions options;
    const py::object progress = optionsFrom(keywords, optionsOf(options));
    const std::string from = pathOf(coefficients, "coefficients"), to = pathOf(folder, "folder");
    jobs::Exported done;
    watched(progress, {}, [&](const jobs::Listener& listener) {
        done = jobs::exportCoefficients(from, to, options, listener);
    });
    return exportedDict(done);
}

/// The answer of `make`, which exports by options of its own with the shared ones.
template <class Own, class Make>
py::object exportedAs(const py::object& spec, const py::object& folder, const py::kwargs& keywords,
                      const Make& make) {
    SharedOptions<Own> options;
    const py::object progress = optionsFrom(keywords, optionsOf(options));
    const std::string from = pathOf(spec, "spec"), to = pathOf(folder, "folder");
    nlohmann::ordered_json answer;
    watched(progress, {}, [&](const jobs::Listener& listener) {
        answer = make(from, to, withShared(options.shared, options.own), listener);
    });
    return fromJson(answer);
}

py::object exportedMaterial(const py::object& spec, const py::object& folder,
                            const py::kwargs& keywords) {
    return exportedAs<jobs::MaterialExportOptions>(
        spec, folder, keywords,
        [](const auto& from, const auto& to, const auto& options, const auto& listener) {
            return jobs::materialsJson(jobs::exportMaterials(from, to, options, listener), to);
        });
}

py::object exportedLighting(const py::object& spec, const py::object& folder,
                            const py::kwargs& keywords) {
    return exportedAs<jobs::LightingExportOptions>(
        spec, folder, keywords,
        [](const auto& from, const auto& to, const auto& options, const auto& listener) {
            return jobs::lightingJson(jobs::exportLighting(from, to, options, listener), to);
        });
}

}  // namespace

void bindExports(py::module_& module) {
    jobs::ExportOptions options;
    define(module,
           {"export", "coefficients: Path, folder: Path", optionsOf(options), "Row",
            R"(Export a coefficient file to a folder: textures, shaders, a viewer.

Returns a dict: "files" (role, target, path), "fit_error" against the source, "poor". All files are
written, or none.)"},
           exported, py::arg("coefficients"), py::arg("folder"));
    SharedOptions<jobs::MaterialExportOptions> material;
    define(module,
           {"export_material", "spec: Path, folder: Path", optionsOf(material), "Row",
            R"(Write a BRDF or a coefficient file as standard materials: gltf, materialx, usd.

A material of the models gltf-pbr and openpbr is written as it is, anything else is fitted. Returns
the answer of the program as a dict: "files" with "target", "path", "spec", "loss" against the
source. All files are written, or none.)"},
           exportedMaterial, py::arg("spec"), py::arg("folder"));
    SharedOptions<jobs::LightingExportOptions> lighting;
    define(module,
           {"export_lighting", "spec: Path, folder: Path", optionsOf(lighting), "Row",
            R"(Write tables, light and shaders that light a BRDF or a coefficient file in real time.

Returns the answer of the program as a dict: "models" with the bytes of their tables and lights,
"errors" against direct integration on a sphere. All files are written, or none.)"},
           exportedLighting, py::arg("spec"), py::arg("folder"));
}

}  // namespace hshfit::python
