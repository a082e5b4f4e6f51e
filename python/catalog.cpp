#include "module.h"

#include <hshfit/accuracy/metrics.h>
#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/light/catalog.h>

#include <brdfs/catalog.h>
#include <brdfs/catalog/preset.h>
#include <brdfs/presets/preset_collection.h>

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <span>
#include <string>
#include <vector>

namespace hshfit::python {
namespace {

py::str text(std::string_view view) {
    return py::str(view.data(), view.size());
}

std::vector<std::string> words(const std::vector<std::string_view>& views) {
    return {views.begin(), views.end()};
}

py::dict row(std::string_view name, std::string_view help) {
    py::dict out;
    out["name"] = text(name);
    out["help"] = text(help);
    return out;
}

py::list parametersOf(const std::vector<Parameter>& parameters) {
    using Kind = Parameter::Kind;
    py::list rows;
    for (const Parameter& parameter : parameters) {
        py::dict one = row(parameter.name, parameter.help);
        const bool worded = parameter.kind == Kind::text || parameter.kind == Kind::choice;
        one["kind"] = parameter.kind == Kind::text     ? "text"
                      : parameter.kind == Kind::choice ? "choice"
                      : parameter.kind == Kind::colour ? "colour"
                                                       : "number";
        if (worded) {
            one["choices"] = words(parameter.choices);
            one["default"] = parameter.kind == Kind::text ? text("") : text(parameter.choices[0]);
        } else {
            const auto fallback = parameter.fallback;
            const bool stated =
                fallback && *fallback >= parameter.min && *fallback <= parameter.max;
            one["default"] = stated ? py::object(py::float_(*fallback)) : py::none();
            one["min"] = parameter.min;
            one["max"] = parameter.max;
        }
        rows.append(one);
    }
    return rows;
}

py::list basesList() {
    py::list rows;
    for (const bases::Entry& basis : bases::catalog()) {
        py::dict one = row(basis.name, basis.help);
        one["source"] = text(basis.source);
        one["max_order"] = basis.maxOrder;
        one["orthonormal"] = basis.orthonormal;
        rows.append(one);
    }
    return rows;
}

py::list modelsList() {
    py::list rows;
    for (const brdfs::Model& model : brdfs::models()) {
        py::dict one = row(model.name, model.help);
        one["source"] = text(model.source);
        one["parameters"] = parametersOf(model.parameters);
        rows.append(one);
    }
    return rows;
}

template <class Row>
py::list fileRows(std::span<const Row> table) {
    py::list rows;
    for (const Row& format : table) {
        py::dict one = row(format.name, format.help);
        one["extension"] = text(format.extension);
        one["parameters"] = parametersOf(format.parameters);
        rows.append(one);
    }
    return rows;
}

py::list formatsList() {
    return fileRows(brdfs::formats());
}

py::list writersList() {
    return fileRows(brdfs::writers());
}

py::list metricsList() {
    py::list rows;
    for (const Metric& metric : metricCatalog()) {
        py::dict one = row(metric.name, metric.help);
        one["source"] = text(metric.source);
        rows.append(one);
    }
    return rows;
}

py::list lightsList() {
    py::list rows;
    const auto add = [&](const LightKind& kind) {
        py::dict one = row(kind.name, kind.help);
        one["source"] = text(kind.source);
        one["example"] = text(kind.example);
        one["parameters"] = parametersOf(kind.parameters);
        rows.append(one);
    };
    for (const LightKind& kind : lightKinds()) add(kind);
    add(studioKind());
    add(pictureKind());
    add(coefficientsKind());
    return rows;
}

py::list presetsList() {
    py::list rows;
    for (const brdfs::Preset& preset : brdfs::presets()) rows.append(row(preset.name, preset.help));
    for (std::size_t k = 0; k < brdfs::presetCollections().size(); ++k) {
        const brdfs::PresetCollection& collection = brdfs::presetCollection(k);
        for (const auto& material : collection.materials)
            rows.append(row(fmt::format("{}/{}", brdfs::presetCollections()[k].name, material.name),
                            material.spec));
    }
    return rows;
}

struct Kind {
    std::string_view name;
    py::list (*list)();
};
constexpr Kind kinds[] = {
    {"bases", basesList},     {"models", modelsList},   {"formats", formatsList},
    {"writers", writersList}, {"metrics", metricsList}, {"lights", lightsList},
    {"presets", presetsList},
};

py::list catalogOf(const std::string& name) {
    std::string known;
    for (const Kind& kind : kinds) {
        if (kind.name == name) return kind.list();
        known += fmt::format("{}{}", known.empty() ? "" : ", ", kind.name);
    }
    throw UsageError(fmt::format("unknown catalog '{}'; known: {}", name, known));
}

}  // namespace

void bindCatalog(py::module_& module) {
    module.def("catalog", catalogOf, py::arg("kind"),
               R"(The rows of a table of the program, each a dict with "name" and "help": "bases",
"models", "formats", "writers", "metrics", "lights" or "presets". Where there are parameters,
"parameters" has their names, kinds, defaults and ranges.)");
}

}  // namespace hshfit::python
