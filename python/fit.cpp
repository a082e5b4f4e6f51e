#include "answers.h"
#include "arrays.h"
#include "watched.h"

#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>

#include <brdfs/catalog.h>

#include <jobs/fit.h>

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace hshfit::python {
namespace {

Shape square(const brdfs::FitResult& result) {
    const auto n = static_cast<py::ssize_t>(result.parameters.size());
    return {n, n};
}

py::array_t<double> correlationsOf(const jobs::Fitted& fitted) {
    return arrayOf(fitted.result.correlations, square(fitted.result));
}

/// Correlations times both standard errors, NaN where there is none.
py::array_t<double> covarianceOf(const jobs::Fitted& fitted) {
    const brdfs::FitResult& result = fitted.result;
    const std::size_t n = result.parameters.size();
    std::vector<double> values = result.correlations;
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j)
            values[i * n + j] *= orNaN(result.parameters[i].standardError) *
                                 orNaN(result.parameters[j].standardError);
    return arrayOf(std::move(values), square(result));
}

std::shared_ptr<Brdf> brdfOf(const jobs::Fitted& fitted) {
    return brdfs::open(fitted.result.spec);
}

void saveFit(const jobs::Fitted& fitted, const py::object& path) {
    const std::string output = pathOf(path, "path");
    if (!jobs::isPresetPath(output))
        throw UsageError(
            fmt::format("{}: a fit is a preset; give a name that ends with .json", output));
    const py::gil_scoped_release released;
    writeFile(output, jobs::presetText(fitted));
}

jobs::FitOptions optionsFrom(const std::string& model, const std::string& loss,
                             const std::string& robust, double robustScale,
                             const std::string& weights, bool perChannel, double grazingCut,
                             std::size_t samples, int starts, int iterations, std::uint64_t seed,
                             bool accept, const py::object& parts) {
    requireWithin("starts", starts, jobs::bounds::starts);
    requireWithin("iterations", iterations, jobs::bounds::iterations);
    requireWithin("grazing_cut", grazingCut, jobs::bounds::grazingCut);
    requireWithin("robust_scale", robustScale, jobs::bounds::robustScale);
    jobs::FitOptions options;
    options.model = model;
    options.loss = loss;
    options.robust = robust;
    options.robustScale = robustScale;
    options.weights = weights;
    options.perChannel = perChannel;
    options.grazingCut = grazingCut;
    options.samples = samples;
    options.starts = starts;
    options.iterations = iterations;
    options.seed = seed;
    options.accept = accept;
    if (!parts.is_none()) options.parts = listText(parts);
    return options;
}

std::shared_ptr<jobs::Fitted> fitted(const py::object& data, const std::string& model,
                                     const std::string& loss, const std::string& robust,
                                     double robustScale, const std::string& weights,
                                     bool perChannel, double grazingCut, std::size_t samples,
                                     int starts, int iterations, std::uint64_t seed, bool accept,
                                     const py::object& parts, bool rgb,
                                     const py::object& progress) {
    const jobs::FitOptions options =
        optionsFrom(model, loss, robust, robustScale, weights, perChannel, grazingCut, samples,
                    starts, iterations, seed, accept, parts);
    Source source(data, rgb, "data");
    std::shared_ptr<jobs::Fitted> result;
    Source* const sources[] = {&source};
    watched(progress, sources, [&](const jobs::Listener& listener) {
        result = std::make_shared<jobs::Fitted>(
            jobs::fitBrdf(source.brdf(), source.name(), options, listener));
    });
    return result;
}

py::list ranked(const py::object& data, const std::vector<std::string>& models,
                const std::string& loss, int starts, std::size_t samples, std::uint64_t seed,
                bool rgb) {
    requireWithin("starts", starts, jobs::bounds::starts);
    jobs::FitOptions options;
    options.loss = loss;
    options.starts = starts;
    options.samples = samples;
    options.seed = seed;
    Source source(data, rgb, "data");
    std::vector<brdfs::ModelRank> ranks;
    Source* const sources[] = {&source};
    watched(py::none(), sources, [&](const jobs::Listener&) {
        ranks = jobs::rankModels(source.brdf(), models, options).models;
    });
    py::list rows;
    for (const brdfs::ModelRank& rank : ranks) {
        py::dict row;
        row["model"] = rank.model;
        row["failure"] = rank.failure;
        if (rank.failure.empty()) {
            row["spec"] = rank.fit.spec;
            row["parameters"] = rank.fit.parameters.size();
            row["held_out_rms"] = rank.heldOut;
            row["rms"] = rank.fit.loss;
            row["aic"] = rank.fit.aic;
            row["bic"] = rank.fit.bic;
            row["converged"] = rank.fit.converged;
        }
        rows.append(row);
    }
    return rows;
}

void bindResult(py::module_& module) {
    using brdfs::FittedParameter;
    using jobs::Fitted;
    py::class_<FittedParameter>(module, "FittedParameter",
                                "A free parameter after a fit, with its standard error.")
        .def_readonly("name", &FittedParameter::name, "\"ggx.alpha\"")
        .def_readonly("channel", &FittedParameter::channel, "\"R\"; empty: all channels")
        .def_readonly("value", &FittedParameter::value)
        .def_readonly("bound", &FittedParameter::bound,
                      "\"lower\" or \"upper\" where it came to rest there, else empty")
        .def_property_readonly(
            "standard_error", [](const FittedParameter& p) { return orNaN(p.standardError); },
            "NaN at a bound, and where the data do not determine it")
        .def_readonly("linear", &FittedParameter::linear)
        .def("__repr__", [](const FittedParameter& p) {
            return fmt::format("<{} {} = {:.6g} +- {:.2g}>", p.name, p.channel, p.value,
                               orNaN(p.standardError));
        });
    const auto result = [](const Fitted& f) -> const brdfs::FitResult& { return f.result; };
    py::class_<Fitted, std::shared_ptr<Fitted>>(
        module, "Fit", "What fit() found: parameters with covariances, and how good they are.")
        .def_property_readonly("model", [=](const Fitted& f) { return result(f).model; })
        .def_property_readonly(
            "spec", [=](const Fitted& f) { return result(f).spec; },
            "The specification with its values: open(fit.spec).")
        .def_property_readonly("parameters", [=](const Fitted& f) { return result(f).parameters; })
        .def_property_readonly("correlations", correlationsOf,
                               "(n, n), of parameters with a standard error, 0 otherwise.")
        .def_property_readonly(
            "covariance", covarianceOf,
            "(n, n): correlations times standard errors (sandwich estimator, White\n"
            "1980); NaN where there is none.")
        .def_property_readonly(
            "ambiguous", [=](const Fitted& f) { return result(f).ambiguous; },
            "Sets of parameters that the data do not tell apart.")
        .def_property_readonly("converged", [=](const Fitted& f) { return result(f).converged; })
        .def_property_readonly(
            "message", [=](const Fitted& f) { return result(f).message; },
            "Of Ceres, about the last search.")
        .def_property_readonly(
            "rms", [=](const Fitted& f) { return result(f).loss; },
            "Root of the weighted mean square of g(f) - g(data).")
        .def_property_readonly("aic", [=](const Fitted& f) { return result(f).aic; })
        .def_property_readonly("bic", [=](const Fitted& f) { return result(f).bic; })
        .def_property_readonly("samples", [=](const Fitted& f) { return result(f).samples; })
        .def_readonly("explained", &Fitted::explained,
                      "1 - (rms / rms of a black surface)^2; of the loss picture, of the spread\n"
                      "of the data about their mean.")
        .def_property_readonly("poor", [](const Fitted& f) { return poorDict(f.poor); })
        .def_property_readonly(
            "preset", [](const Fitted& f) { return fromJson(f.preset); },
            "The document of the command fit (docs/schemas/fit.schema.json).")
        .def("brdf", brdfOf, "The fit as a Brdf.")
        .def("save", saveFit, py::arg("path"), "Write the preset, .json, that open() takes.")
        .def("__repr__",
             [=](const Fitted& f) { return fmt::format("<hshfit.Fit {}>", result(f).spec); });
}

}  // namespace

void bindFit(py::module_& module) {
    bindResult(module);
    const jobs::FitOptions options;
    module.def("fit", fitted, py::arg("data"), py::arg("model"), py::kw_only(),
               py::arg("loss") = options.loss, py::arg("robust") = options.robust,
               py::arg("robust_scale") = options.robustScale, py::arg("weights") = options.weights,
               py::arg("per_channel") = options.perChannel,
               py::arg("grazing_cut") = options.grazingCut, py::arg("samples") = options.samples,
               py::arg("starts") = options.starts, py::arg("iterations") = options.iterations,
               py::arg("seed") = options.seed, py::arg("accept") = options.accept,
               py::arg("parts") = py::none(), py::arg("rgb") = options.rgb,
               py::arg("progress") = py::none(),
               R"(Fit a model to a Brdf, or to a specification or path.

model     "MODEL[:key=value,...][+MODEL...]": parameters with a value are held fixed
loss      "picture" (default for functions and tables), "l2", "cosine" (default for scattered
          samples), "log", "cube-root" or "log-relative"
robust    "none", "huber" or "cauchy", from `robust_scale` on (0: from the residuals' spread)
weights   "auto", "equal" or "solid-angle"
samples   to draw; 0: all
starts, iterations, seed  of the search
accept    take a fit that did not converge, which raises NumericError otherwise
parts     of models with optional parts: "auto", "none", "all" or names

Returns a Fit. The same numbers as by the command fit.)");
    module.def(
        "rank_models", ranked, py::arg("data"), py::arg("models"), py::kw_only(),
        py::arg("loss") = options.loss, py::arg("starts") = options.starts,
        py::arg("samples") = options.samples, py::arg("seed") = options.seed,
        py::arg("rgb") = options.rgb,
        R"(Fit every model to the same data and rank them by the error at held-out directions: a
list of dicts with "model", "spec", "held_out_rms", "rms", "aic", "bic", "converged" and
"failure".)");
}

}  // namespace hshfit::python
