#include "answers.h"
#include "arrays.h"
#include "job_options.h"
#include "watched.h"

#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>

#include <brdfs/fit/prediction.h>

#include <jobs/fits/fit.h>

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
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
    const py::gil_scoped_release released;
    return brdfs::openFit(fitted.result);
}

void saveFit(const jobs::Fitted& fitted, const py::object& path) {
    const std::string output = pathOf(path, "path");
    if (!jobs::isPresetPath(output))
        throw UsageError(
            fmt::format("{}: a fit is a preset; give a name that ends with .json", output));
    const py::gil_scoped_release released;
    writeFile(output, jobs::presetText(fitted));
}

/// f at pairs with its errors: a dict of arrays (..., channels) and of factors.
py::dict predicted(const jobs::Fitted& fitted, const py::object& wi, const py::object& wo,
                   double probability, std::uint64_t seed) {
    if (!(probability > 0 && probability < 1))
        throw UsageError(fmt::format("probability: {} is not between 0 and 1", probability));
    const auto [in, out] = broadcast(wi, "wi", wo, "wo");
    const std::vector<Direction> from = directionsIn(in, "wi"), to = directionsIn(out, "wo");
    std::vector<DirectionPair> pairs;
    for (std::size_t k = 0; k < from.size(); ++k) {
        if (!(from[k].z > 0 && to[k].z > 0))
            throw InputError(fmt::format(
                "pair {} has a direction below the horizon, where a fit predicts nothing", k));
        pairs.push_back({from[k], to[k]});
    }
    Shape shape = in.shape;
    brdfs::Prediction found;
    double simultaneous = 0;
    watched(py::none(), {}, [&](const jobs::Listener&) {
        found = brdfs::predict(fitted.result, pairs);
        simultaneous = brdfs::simultaneousFactor(fitted.result, pairs, probability, seed);
    });
    shape.push_back(static_cast<py::ssize_t>(found.channels));
    const auto byPair = [&](const std::vector<double>& values) {
        std::vector<double> turned(values.size());
        for (std::size_t c = 0; c < found.channels; ++c)
            for (std::size_t k = 0; k < found.pairs; ++k)
                turned[k * found.channels + c] = values[c * found.pairs + k];
        return arrayOf(std::move(turned), shape);
    };
    py::dict answer;
    answer["f"] = byPair(found.values);
    answer["standard_error"] = byPair(found.errors);
    std::vector<double> widths;
    for (std::size_t v = 0; v < found.errors.size(); ++v)
        widths.push_back(found.errors[v] *
                         brdfs::Prediction::pointwise(probability, found.degrees[v]));
    answer["degrees_of_freedom"] = byPair(found.degrees);
    answer["half_width"] = byPair(widths);
    answer["pointwise"] = found.widest(probability);
    answer["simultaneous"] = simultaneous;
    if (found.bootstrap) answer["bootstrap_error"] = byPair(found.bootstrap->errors);
    return answer;
}

/// The options of fit(), but for the model and the instrument, which are arguments by themselves.
Options optionsOf(jobs::FitOptions& options, jobs::FigureArguments& figures) {
    return joined({without(boundOptions(jobs::fitOptions(), options), {"model"}),
                   boundOptions(jobs::figureOptions(), figures)});
}

/// The instrument of a dict whose keys are the program's options with underscores.
brdfs::InstrumentText instrumentFrom(const py::object& given) {
    brdfs::InstrumentText text;
    if (given.is_none()) return text;
    const Options options = boundOptions(jobs::instrumentOptions(), text);
    Keywords keys{py::dict(given)};
    keys.set(options);
    keys.finish("instrument", options);
    return text;
}

std::shared_ptr<jobs::Fitted> fitted(const py::object& data, const std::string& model,
                                     const py::kwargs& keywords) {
    jobs::FitOptions options{.model = model};
    jobs::FigureArguments figures;
    Keywords given(keywords);
    given.set(optionsOf(options, figures));
    options.instrument = instrumentFrom(given.take("instrument"));
    const py::object progress = given.take("progress");
    given.finish();
    if (options.bands.empty() && !options.bandsTo.empty())
        throw UsageError("bands_to is the file of bands; give bands, their pairs, too");
    if (options.certificate.empty() && !options.certificateFields.empty())
        throw UsageError("certificate_fields is for certificate='OUT.pdf'");
    options.figures = figures.parsed();
    Source source(data, options.rgb, "data");
    std::shared_ptr<jobs::Fitted> result;
    Source* const sources[] = {&source};
    watched(progress, sources, [&](const jobs::Listener& listener) {
        result = std::make_shared<jobs::Fitted>(
            jobs::fitBrdf(source.brdf(), source.name(), options, listener));
    });
    return result;
}

/// The options of fit() that a ranking of models takes.
Options rankOptions(jobs::FitOptions& options) {
    return only(boundOptions(jobs::fitOptions(), options),
                {"loss", "starts", "samples", "seed", "rgb"});
}

py::list ranked(const py::object& data, const std::vector<std::string>& models,
                const py::kwargs& keywords) {
    jobs::FitOptions options;
    const py::object progress = optionsFrom(keywords, rankOptions(options));
    Source source(data, options.rgb, "data");
    std::vector<brdfs::ModelRank> ranks;
    Source* const sources[] = {&source};
    watched(progress, sources, [&](const jobs::Listener&) {
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
        .def_readonly("name", &FittedParameter::name,
                      "\"ggx.alpha\"; \"ggx1.alpha\" where ggx stands twice")
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
            "picture", [](const Fitted& f) { return pictureDict(f.picture); },
            "The picture error against the data; None for scattered samples.")
        .def_property_readonly(
            "preset", [](const Fitted& f) { return fromJson(f.preset); },
            "The document of the command fit (docs/schemas/fit.schema.json).")
        .def_property_readonly(
            "bands",
            [](const Fitted& f) {
                return f.bands.is_null() ? py::list() : py::list(fromJson(f.bands));
            },
            "Rows of the bands that fit(bands=...) asked for: f, its standard error, pointwise "
            "and\n"
            "simultaneous bands; else empty.")
        .def_property_readonly(
            "figures", [](const Fitted& f) { return f.figures.names; },
            "Files of fit(figures=...), in its folder.")
        .def("predict", predicted, py::arg("wi"), py::arg("wo"), py::kw_only(),
             py::arg("probability") = 0.95, py::arg("seed") = 1,
             R"(f of the fit at pairs of directions above the horizon, unit vectors (..., 3), with
its errors by the delta method (Seber & Wild 1989, 5.1): a dict of "f" and "standard_error",
(..., channels) in 1/sr; "degrees_of_freedom" of the variances (inf: so many that they do not
matter) and "half_width" of the band that holds f with `probability` at one pair, by Student's
distribution, likewise; "pointwise", the largest half width over its error, and "simultaneous", the
factor of the errors with which bands hold f at all of these pairs at once. "bootstrap_error" where
the fit has draws. Errors are those of the fitted curve for a true model; readings have noise in
addition.)")
        .def("brdf", brdfOf, "The fit as a Brdf.")
        .def("save", saveFit, py::arg("path"), "Write the preset, .json, that open() takes.")
        .def("__repr__",
             [=](const Fitted& f) { return fmt::format("<hshfit.Fit {}>", result(f).spec); });
}

}  // namespace

void bindFit(py::module_& module) {
    bindResult(module);
    jobs::FitOptions options;
    jobs::FigureArguments figures;
    define(module,
           {"fit",
            "data: BrdfLike, model: str",
            optionsOf(options, figures),
            "Fit",
            R"(Fit a model to a Brdf, or to a specification or path.

model: "MODEL[:key=value,...][+MODEL...]": parameters with a value are held fixed. instrument: what
stands between f and the samples, {"source_aperture": "cone:2", "bandwidth": "gauss:5", "offset":
"fit", ...} with detector_aperture, aperture_tolerance, dark, stray, scan_scale, incidence_zero and
detector_zero. Returns a Fit: the same numbers as by the command fit. A fit that did not converge
raises NumericError, unless it is accepted.)",
            {{"instrument", "Optional[Mapping[str, Any]]"}}},
           fitted, py::arg("data"), py::arg("model"));
    define(
        module,
        {"rank_models", "data: BrdfLike, models: Sequence[str]", rankOptions(options), "List[Row]",
         R"(Fit every model to the same data and rank them by the error at held-out directions: a
list of dicts with "model", "spec", "held_out_rms", "rms", "aic", "bic", "converged" and
"failure".)"},
        ranked, py::arg("data"), py::arg("models"));
}

}  // namespace hshfit::python
