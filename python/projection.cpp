#include "answers.h"
#include "arrays.h"
#include "job_options.h"
#include "watched.h"

#include <hshfit/bases/catalog.h>
#include <hshfit/coefficients/reconstruction.h>
#include <hshfit/error.h>
#include <hshfit/pages/pair_summary_json.h>
#include <hshfit/representation/forms/represented_brdf.h>

#include <jobs/source/source.h>
#include <jobs/studies/project.h>

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

/// A projection with its coefficients where NumPy can look at them.
struct Result {
    jobs::Projected projected;
    std::shared_ptr<Coefficients> coefficients = {};
    std::shared_ptr<Representation> form = {};
};

Result resultOf(jobs::Projected projected) {
    Result result{std::move(projected)};
    Coefficients& c = result.projected.projection.coefficients;
    if (result.projected.kept)
        result.form = std::make_shared<Representation>(*result.projected.kept);
    else
        result.coefficients = std::make_shared<Coefficients>(c);
    return result;
}

Options optionsOf(jobs::ProjectOptions& options) {
    return joined({boundOptions(jobs::projectOptions(), options),
                   boundOptions(jobs::formOptions(), options.form)});
}

std::shared_ptr<Result> projected(const py::object& brdf, const py::kwargs& keywords) {
    jobs::ProjectOptions options;
    const py::object progress = optionsFrom(keywords, optionsOf(options));
    Source source(brdf, options.rgb);
    jobs::Projected done;
    Source* const sources[] = {&source};
    watched(progress, sources, [&](const jobs::Listener& listener) {
        done = jobs::projectBrdf(source.brdf(), options, listener, "projection.json");
    });
    return std::make_shared<Result>(resultOf(std::move(done)));
}

/// Every basis at once, from one quadrature.
py::dict projectedAll(const py::object& brdf, const py::object& names, int order,
                      const py::object& outgoing, bool cosine, bool condonShortley, bool rgb,
                      double tolerance, const py::object& progress) {
    if (tolerance != 0) requireWithin("tolerance", tolerance, jobs::bounds::tolerance);
    std::vector<std::unique_ptr<Basis>> made;
    std::vector<const Basis*> pointers;
    for (const bases::Entry* entry : bases::select(listText(names))) {
        made.push_back(bases::make(entry->name, std::min(order, entry->maxOrder),
                                   {.condonShortley = condonShortley}));
        pointers.push_back(made.back().get());
    }
    const std::string set = outgoingText(outgoing);
    Source source(brdf, rgb);
    std::vector<jobs::Projected> found;
    Source* const sources[] = {&source};
    watched(progress, sources, [&](const jobs::Listener& listener) {
        for (Projection& one : hshfit::project(
                 source.brdf(), pointers, outgoingOf({.outgoing = set}, source.brdf().laws()),
                 {.quantity = cosine ? Quantity::brdfCosine : Quantity::brdf,
                 .tolerance = tolerance,
                 .progress = listener.part("project")})) {
            found.push_back({.projection = std::move(one), .output = {}});
            found.back().captured = jobs::capturedShare(found.back().projection, source.brdf());
        }
    });
    py::dict results;
    for (jobs::Projected& result : found) {
        const std::string name = result.projection.coefficients.basis;
        results[py::str(name)] = std::make_shared<Result>(resultOf(std::move(result)));
    }
    return results;
}

std::shared_ptr<Brdf> brdfOf(const Result& result) {
    const py::gil_scoped_release released;
    if (!result.form) return std::make_shared<Reconstruction>(*result.coefficients);
    return reconstruct(*result.form, jobs::sourceOpener());
}

py::array_t<double> capturedBy(const Result& result) {
    const std::vector<double>& captured = result.projected.projection.captured;
    return arrayOf(captured, {static_cast<py::ssize_t>(captured.size())});
}

void saveResult(const Result& result, const py::object& path) {
    const std::string output = pathOf(path, "path");
    const py::gil_scoped_release released;
    jobs::writeProjected(result.projected, output);
}

std::string reprOf(const Result& result) {
    const CoefficientHead& head = result.projected.projection.coefficients;
    return fmt::format(
        "<hshfit.Projection {} order {} of {}, {}>", head.basis, head.order, head.source,
        result.projected.captured ? fmt::format("{:.6f} of the energy", *result.projected.captured)
                                  : "no captured energy");
}

void bindResult(py::module_& module) {
    py::class_<Result, std::shared_ptr<Result>>(
        module, "Projection",
        "What project() found: coefficients or a form, and how good they are.")
        .def_property_readonly(
            "coefficients", [](const Result& r) { return r.coefficients; },
            "Coefficients, or None for a form.")
        .def_property_readonly(
            "form", [](const Result& r) { return r.form; }, "Form, or None for plain coefficients.")
        .def_property_readonly(
            "captured", capturedBy,
            "(order,): energy that the first n bands capture, element n - 1; empty for a form.")
        .def_property_readonly(
            "accuracy", [](const Result& r) { return orNaN(r.projected.captured); },
            "The captured share of the energy (Gautron et al. 2004, Eq. 15); NaN if not known.")
        .def_property_readonly(
            "energy",
            [](const Result& r) { return energyDict(r.projected.projection.coefficients.energy); })
        .def_property_readonly(
            "error", [](const Result& r) { return r.projected.projection.coefficients.error; },
            "Estimated relative error of quadrature.")
        .def_property_readonly(
            "evaluations", [](const Result& r) { return r.projected.projection.evaluations; },
            "Evaluations of f.")
        .def_property_readonly(
            "errors",
            [](const Result& r) -> py::object {
                if (!r.projected.errors) return py::none();
                return fromJson(pairSummaryJson(*r.projected.errors));
            },
            "Errors over pairs of directions, for the halfway form; else None.")
        .def_property_readonly(
            "poor", [](const Result& r) { return poorDict(r.projected.poor); },
            "None, or {\"reason\", \"better\"} where the result is poor, with \"to_try\" where "
            "the\n"
            "call was not tried\n"
            "(docs/explanation/picture_error.md).")
        .def_property_readonly(
            "picture", [](const Result& r) { return pictureDict(r.projected.picture); },
            "The picture error of the result; None for one outgoing direction.")
        .def("brdf", brdfOf, "The reconstruction as a Brdf.")
        .def("save", saveResult, py::arg("path"),
             "Write .json (exact) or .exr (float32): the bytes of the command project.")
        .def("__repr__", reprOf);
}

void bindProject(py::module_& module) {
    jobs::ProjectOptions options;
    define(module,
           {"project", "brdf: BrdfLike", optionsOf(options), "Projection",
            R"(Project a BRDF over wi onto a basis, for every outgoing direction.

    c_{l,m}(wo) = integral of q(wi, wo) B_{l,m}(wi) d omega_i   (Gautron et al. 2004, Eq. 17)

brdf: a Brdf, or a specification or path as for open(). outgoing: "32x32", 16 (elevations) or
(theta, phi) in degrees. form and the arguments behind it ask for a compressed form. Returns a
Projection: the same numbers as by the command project. Raises NumericError where the coefficients
do not exist or do not converge.)"},
           projected, py::arg("brdf"));
    module.def(
        "project_all", projectedAll, py::arg("brdf"), py::kw_only(), py::arg("bases") = "all",
        py::arg("order") = options.order, py::arg("outgoing") = py::none(),
        py::arg("cosine") = options.cosine, py::arg("condon_shortley") = options.condonShortley,
        py::arg("rgb") = options.rgb, py::arg("tolerance") = options.tolerance,
        py::arg("progress") = py::none(),
        R"(Project onto several bases from one quadrature: {name: Projection}. bases: "all", names
with commas, or a sequence of names; a basis that ends below the order has its largest.)");
}

}  // namespace

void bindProjection(py::module_& module) {
    bindResult(module);
    bindProject(module);
}

}  // namespace hshfit::python
