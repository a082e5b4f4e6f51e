#include "answers.h"
#include "arrays.h"
#include "job_options.h"
#include "watched.h"

#include <hshfit/error.h>
#include <hshfit/pages/pair_summary_json.h>
#include <hshfit/pages/report.h>

#include <jobs/source/picture.h>
#include <jobs/studies/compare.h>
#include <jobs/studies/report.h>

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <nlohmann/json.hpp>

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace hshfit::python {
namespace {

/// A column of the points of a curve.
template <class Value, class Member>
py::array_t<Value> column(const ReportCurve& curve, Member member) {
    py::array_t<Value> values(Shape{static_cast<py::ssize_t>(curve.points.size())});
    for (std::size_t k = 0; k < curve.points.size(); ++k)
        values.mutable_data()[k] = member(curve.points[k]);
    return values;
}

py::object firstOf(const ReportCurve& curve, double accuracy) {
    const auto point = firstReaching(curve, accuracy);
    if (!point) return py::none();
    return py::cast(std::pair(point->order, point->coefficients));
}

std::shared_ptr<Report> curvesOf(const py::object& brdf, const py::kwargs& keywords) {
    jobs::ReportOptions options;
    const py::object progress = optionsFrom(keywords, boundOptions(jobs::reportOptions(), options));
    Source source(brdf, options.rgb);
    auto report = std::make_shared<Report>();
    Source* const sources[] = {&source};
    watched(progress, sources, [&](const jobs::Listener& listener) {
        report->reports.push_back(jobs::reportOf(source.brdf(), options, listener));
    });
    return report;
}

void bindCurves(py::module_& module) {
    py::class_<ReportCurve>(module, "Curve", "Captured energy of one basis by order.")
        .def_readonly("basis", &ReportCurve::basis)
        .def_readonly("best_terms", &ReportCurve::bestTerms,
                      "Points keep the largest coefficients instead of the first.")
        .def_property_readonly("orders",
                               [](const ReportCurve& c) {
                                   return column<int>(c,
                                                      [](const ReportPoint& p) { return p.order; });
                               })
        .def_property_readonly(
            "coefficients",
            [](const ReportCurve& c) {
                return column<int>(c, [](const ReportPoint& p) { return p.coefficients; });
            },
            "Functions that can be non-zero, by order.")
        .def_property_readonly(
            "accuracy",
            [](const ReportCurve& c) {
                return column<double>(c, [](const ReportPoint& p) { return orNaN(p.accuracy); });
            },
            "Captured share of the energy (Gautron et al. 2004, Eq. 15), by\n"
            "order; NaN where the energy does not exist.")
        .def("reaching", firstOf, py::arg("accuracy"),
             "(order, coefficients) of the first point with that accuracy, or None.")
        .def("__repr__", [](const ReportCurve& c) {
            return fmt::format("<hshfit.Curve {}, {} orders>", c.basis, c.points.size());
        });
    const auto entry = [](const Report& r) -> const ReportEntry& { return r.reports.front(); };
    py::class_<Report, std::shared_ptr<Report>>(module, "Curves",
                                                "What curves() found: a Curve for each basis.")
        .def_property_readonly("brdf", [=](const Report& r) { return entry(r).brdf; })
        .def_property_readonly("quantity",
                               [=](const Report& r) { return quantityName(entry(r).quantity); })
        .def_property_readonly("outgoing", [=](const Report& r) { return entry(r).outgoing; })
        .def_property_readonly(
            "energy", [=](const Report& r) { return energyDict(entry(r).energy); },
            "Over solid angle, channels and outgoing directions summed; with its error.")
        .def_property_readonly(
            "error", [=](const Report& r) { return entry(r).error; },
            "Estimated relative error of quadrature.")
        .def_property_readonly("bases",
                               [=](const Report& r) {
                                   std::vector<std::string> names;
                                   for (const ReportCurve& curve : entry(r).curves)
                                       names.push_back(curve.basis);
                                   return names;
                               })
        .def("__len__", [=](const Report& r) { return entry(r).curves.size(); })
        .def(
            "__iter__",
            [=](const Report& r) {
                return py::make_iterator(entry(r).curves.begin(), entry(r).curves.end());
            },
            py::keep_alive<0, 1>())
        .def(
            "__getitem__",
            [=](const Report& r, const std::string& basis) -> const ReportCurve& {
                for (const ReportCurve& curve : entry(r).curves)
                    if (curve.basis == basis) return curve;
                throw py::key_error(basis);
            },
            py::arg("basis"), py::return_value_policy::reference_internal)
        .def(
            "json", [](const Report& r) { return reportJson(r); },
            "The document of the command report, as text.")
        .def(
            "save",
            [](const Report& r, const py::object& folder) {
                const std::string path = pathOf(folder, "folder");
                const py::gil_scoped_release released;
                writeReport(r, path);
            },
            py::arg("folder"),
            "Write report.html, curves.svg, .pdf, .csv and .gp, and report.json.")
        .def("__repr__", [=](const Report& r) {
            return fmt::format("<hshfit.Curves of {}, {} bases>", entry(r).brdf,
                               entry(r).curves.size());
        });
    jobs::ReportOptions options;
    define(module,
           {"curves", "brdf: BrdfLike", boundOptions(jobs::reportOptions(), options), "Curves",
            R"(The share of the energy that each basis captures, by order (Eq. 15).

bases: "all", names with commas, or a sequence of names. Returns Curves.)"},
           curvesOf, py::arg("brdf"));
}

Options optionsOf(jobs::CompareOptions& options, jobs::FigureArguments& figures) {
    return joined({boundOptions(jobs::compareOptions(), options),
                   boundOptions(jobs::figureOptions(), figures)});
}

std::shared_ptr<jobs::Compared> compared(const py::object& a, const py::object& b,
                                         const py::kwargs& keywords) {
    jobs::CompareOptions options;
    jobs::FigureArguments figures;
    Keywords given(keywords);
    given.set(optionsOf(options, figures));
    const py::object folder = given.take("folder"), progress = given.take("progress");
    given.finish();
    if (!options.sigma.empty() && figures.figures.empty())
        throw UsageError("sigma is for the bars of figures; give figures, their folder");
    options.figures = figures.parsed();
    const auto specified = [](const py::object& source) { return !py::isinstance<Brdf>(source); };
    Source first(a, options.rgb && specified(a), "a"), second(b, options.rgb && specified(b), "b");
    const std::string output = folder.is_none() ? "" : pathOf(folder, "folder");
    std::shared_ptr<jobs::Compared> result;
    Source* const sources[] = {&first, &second};
    watched(progress, sources, [&](const jobs::Listener& listener) {
        result = std::make_shared<jobs::Compared>(
            jobs::compareBrdfs(first.brdf(), second.brdf(), output, options, listener));
    });
    return result;
}

py::object pictureErrorOfPair(const py::object& a, const py::object& b,
                              const py::object& progress) {
    Source first(a, false, "a"), second(b, false, "b");
    std::optional<PictureError> found;
    Source* const sources[] = {&first, &second};
    watched(progress, sources, [&](const jobs::Listener& /*listener*/) {
        found = jobs::pictureErrorOf(first.brdf(), second.brdf());
    });
    return pictureDict(found);
}

void bindPictureError(py::module_& module) {
    module.def(
        "picture_error", pictureErrorOfPair, py::arg("a"), py::arg("b"), py::kw_only(),
        py::arg("progress") = py::none(),
        R"(How far b is from a to the eye (docs/explanation/picture_error.md), each as in compare().

Returns a dict: "flip" and "ciede2000" of lit spheres ("mean", "largest", "light"), "albedo" by
channel to 85 degrees, "last_albedo" from there, "false_dip", "false_peak" and "ridge" ("value" as
a share, "channel", "wi", "wo"). None where one is known for one outgoing direction alone.)");
}

void bindCompare(py::module_& module) {
    py::class_<jobs::Compared, std::shared_ptr<jobs::Compared>>(
        module, "Comparison", "What compare() found: errors of b against a.")
        .def_readonly("a", &jobs::Compared::a)
        .def_readonly("b", &jobs::Compared::b)
        .def_readonly("outgoing", &jobs::Compared::outgoing)
        .def_property_readonly(
            "metrics", [](const jobs::Compared& c) { return metricsDict(c.metrics); },
            "{name: {\"value\", \"error\", \"reason\", \"wi\", \"wo\"}}; catalog(\"metrics\") "
            "explains\n"
            "them. A value that does not exist is NaN, with a reason.")
        .def_property_readonly(
            "pairs",
            [](const jobs::Compared& c) -> py::object {
                if (!c.pairs) return py::none();
                return fromJson(pairSummaryJson(*c.pairs));
            },
            "Errors over both hemispheres, by zones; None where there are none.")
        .def_property_readonly(
            "samples",
            [](const jobs::Compared& c) -> py::object {
                if (!c.samples) return py::none();
                py::dict out;
                out["count"] = c.samples->count;
                out["metrics"] = metricsDict(c.samples->metrics);
                return out;
            },
            "The metrics at the measured pairs of a alone (\"count\", \"metrics\"); None where a "
            "is not\nmade of scattered samples.")
        .def_property_readonly(
            "picture", [](const jobs::Compared& c) { return pictureDict(c.picture); },
            "The picture error of b against a, as picture_error() gives it.")
        .def_readonly("files", &jobs::Compared::files, "Of the page, where a folder was given.")
        .def_property_readonly(
            "figures", [](const jobs::Compared& c) { return c.figures.names; },
            "Files of compare(figures=...), in its folder.")
        .def(
            "__getitem__",
            [](const jobs::Compared& c, const std::string& name) {
                for (const MetricValue& metric : c.metrics)
                    if (metric.metric->name == name) return orNaN(metric.value);
                throw py::key_error(name);
            },
            py::arg("metric"), "The value of a metric.")
        .def("__repr__", [](const jobs::Compared& c) {
            return fmt::format("<hshfit.Comparison of {} against {}>", c.b, c.a);
        });
    jobs::CompareOptions options;
    jobs::FigureArguments figures;
    define(module,
           {"compare",
            "a: BrdfLike, b: BrdfLike",
            optionsOf(options, figures),
            "Comparison",
            R"(Errors of the approximation b against the reference a, each a Brdf, Coefficients, a
Form, a Projection, a Fit, or a specification or path.

folder takes a page with figures and spheres. Returns a Comparison.)",
            {{"folder", "Optional[Path]"}}},
           compared, py::arg("a"), py::arg("b"));
}

}  // namespace

void bindStudies(py::module_& module) {
    bindCurves(module);
    bindPictureError(module);
    bindCompare(module);
}

}  // namespace hshfit::python
