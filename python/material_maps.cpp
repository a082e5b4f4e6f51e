#include "arrays.h"
#include "watched.h"

#include <hshfit/error.h>
#include <hshfit/representation/forms/form.h>

#include <jobs/maps/map_answers.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pybind11/stl.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <initializer_list>
#include <iterator>
#include <optional>
#include <string>
#include <utility>

namespace hshfit::python {
namespace {

namespace bounds = jobs::bounds;

using Given = std::initializer_list<std::pair<const char*, bool>>;

/// Throws UsageError for an argument that was given, but belongs to other forms.
void refuseArguments(const std::string& form, const Given& arguments) {
    for (const auto& [name, given] : arguments)
        if (given) throw UsageError(fmt::format("{} does not belong to the form {}", name, form));
}

struct MapArguments {
    std::optional<std::string> basis, outgoing, halfway;
    std::optional<int> order, rank, clusters, harmonics, memory;
    std::optional<double> tolerance, error;
    bool cosine = false, mips = true, direct = true, force = false;
    std::string precision = "half";
    int checks = 16;
};

std::string storedPrecision(const std::string& name) {
    if (name == "half" || name == "float16") return "float16";
    if (name == "float32") return name;
    throw UsageError(fmt::format("precision: '{}' is none of half, float32", name));
}

template <class Number, class Bound>
void take(const char* name, const std::optional<Number>& value, const jobs::Bounds<Bound>& bounds,
          auto& into) {
    if (!value) return;
    requireWithin(name, *value, bounds);
    into = static_cast<std::remove_reference_t<decltype(into)>>(*value);
}

jobs::SvbrdfOptions optionsOf(const MapArguments& given, const std::string& form) {
    refuseArguments(form, {{"harmonics", given.harmonics.has_value()},
                           {"halfway", given.halfway && form != "halfway"},
                           {"rank", given.rank && form == "outgoing"}});
    jobs::SvbrdfOptions options;
    options.form = form;
    options.cosine = given.cosine;
    options.precision = storedPrecision(given.precision);
    options.mips = given.mips;
    options.force = given.force;
    options.pastPageCache = given.direct;
    options.checks = static_cast<std::size_t>(given.checks);
    if (given.basis) options.basis = *given.basis;
    if (given.outgoing) options.outgoing = *given.outgoing;
    if (given.halfway) options.halfway = parseHalfway(*given.halfway);
    take("order", given.order, bounds::mapOrder, options.order);
    take("rank", given.rank, bounds::mapRank, options.rank);
    take("clusters", given.clusters, bounds::mapClusters, options.clusters);
    take("tolerance", given.tolerance, bounds::mapTolerance, options.tolerance);
    take("error", given.error, bounds::mapError, options.error);
    take("memory", given.memory, bounds::mapMemory, options.memory);
    if (given.memory) options.memory <<= 20;
    return options;
}

jobs::FilteredMapOptions filteredOptionsOf(const MapArguments& given, const std::string& form) {
    refuseArguments(form, {{"basis", given.basis.has_value()},
                           {"order", given.order.has_value()},
                           {"outgoing", given.outgoing.has_value()},
                           {"cosine", given.cosine},
                           {"tolerance", given.tolerance.has_value()},
                           {"rank", given.rank.has_value()},
                           {"clusters", given.clusters.has_value()},
                           {"halfway", given.halfway.has_value()},
                           {"memory", given.memory.has_value()},
                           {"direct", !given.direct},
                           {"harmonics", given.harmonics && form == "ellipse"}});
    jobs::FilteredMapOptions options{.form = form,
                                     .precision = storedPrecision(given.precision),
                                     .mips = given.mips,
                                     .force = given.force,
                                     .checks = given.checks};
    take("harmonics", given.harmonics, bounds::mapHarmonics, options.harmonics);
    take("error", given.error, bounds::mapError, options.error);
    return options;
}

nlohmann::ordered_json mapAnswer(const std::string& description, const std::string& folder,
                                 std::string form, const MapArguments& given,
                                 const jobs::Listener& listener) {
    if (form.empty()) form = jobs::turnsTexels(description) ? "filtered" : "outgoing";
    if (jobs::isFilteredForm(form))
        return jobs::filteredMapJson(
            jobs::filteredMap(description, folder, filteredOptionsOf(given, form), listener));
    return jobs::svbrdfJson(jobs::svbrdf(description, folder, optionsOf(given, form), listener));
}

using Text = std::optional<std::string>;
using Count = std::optional<int>;
using Share = std::optional<double>;

py::object mapped(const py::object& description, const py::object& folder, const Text& form,
                  const Text& basis, const Count& order, const Text& outgoing, bool cosine,
                  const std::string& precision, const Share& tolerance, const Count& rank,
                  const Share& error, const Count& harmonics, const Text& halfway,
                  const Count& clusters, bool mips, int checks, const Count& memory, bool direct,
                  bool force, const py::object& progress) {
    requireWithin("checks", checks, bounds::mapChecks);
    if (form && std::ranges::find(jobs::mapForms, *form) == std::end(jobs::mapForms))
        throw UsageError(
            fmt::format("form: '{}' is none of {}", *form, fmt::join(jobs::mapForms, ", ")));
    const MapArguments given{.basis = basis,
                             .outgoing = outgoing,
                             .halfway = halfway,
                             .order = order,
                             .rank = rank,
                             .clusters = clusters,
                             .harmonics = harmonics,
                             .memory = memory,
                             .tolerance = tolerance,
                             .error = error,
                             .cosine = cosine,
                             .mips = mips,
                             .direct = direct,
                             .force = force,
                             .precision = precision,
                             .checks = checks};
    const std::string path = pathOf(description, "description"), output = pathOf(folder, "folder");
    nlohmann::ordered_json answer;
    watched(progress, {}, [&](const jobs::Listener& listener) {
        answer = mapAnswer(path, output, form.value_or(""), given, listener);
    });
    return fromJson(answer);
}

}  // namespace

void bindMaterialMaps(py::module_& module) {
    const jobs::SvbrdfOptions options;
    const py::none none;
    const std::string doc = fmt::format(
        R"(Maps of materials as a texture of coefficients with mip levels.

description  a file (JSON) of a model and its parameters: numbers or pictures
form         "outgoing": all coefficients; "low-rank": weights of shared shapes; "clusters": the
             index of a shared material; "halfway": likewise, in the halfway form. Of texels that
             are turned by normals or directions: "ellipse" or "harmonics" of the distribution of
             normals; "filtered": the cheaper one within `error`. None: "filtered" where texels are
             turned, else "outgoing"
basis        over incoming directions ({}), with bands ({}); outgoing: "N" elevations or "WxH"
             ({} where all texels are isotropic, else {}); cosine: f cos(theta_i) instead of f
precision    "half" or "float32"
tolerance    relative error of lobes between the nodes of their table ({:g})
rank         of shared shapes; None: as many as the relative `error` ({:g}) of sampled texels takes
clusters     shared materials of each level ({}); halfway: their orders ("{},{},{}")
harmonics    order of the form "harmonics", odd; error: of a level against samples ({:g})
mips         levels of averaged reflectance; checks: texels of each level that are measured
memory       MiB that bands of the map may take ({}); direct: texels go past the page cache

Writes material.ktx2, material.json and errors.png to folder, and the shared materials of the form
"halfway". Returns the answer of the command: choices with bytes and errors, levels with their
errors against samples, rates and files. The files are those of the program, byte for byte.)",
        options.basis, options.order, 8, "8x8", options.tolerance, options.error, options.clusters,
        options.halfway.half, options.halfway.difference, options.halfway.azimuth,
        jobs::FilteredMapOptions{}.error, options.memory >> 20);
    module.def("svbrdf", mapped, py::arg("description"), py::arg("folder"), py::kw_only(),
               py::arg("form") = none, py::arg("basis") = none, py::arg("order") = none,
               py::arg("outgoing") = none, py::arg("cosine") = options.cosine,
               py::arg("precision") = "half", py::arg("tolerance") = none, py::arg("rank") = none,
               py::arg("error") = none, py::arg("harmonics") = none, py::arg("halfway") = none,
               py::arg("clusters") = none, py::arg("mips") = options.mips,
               py::arg("checks") = options.checks, py::arg("memory") = none,
               py::arg("direct") = options.pastPageCache, py::arg("force") = options.force,
               py::arg("progress") = none, doc.c_str());
}

}  // namespace hshfit::python
