#include <brdfs/fit/fit_json.h>
#include <brdfs/fit/held_values.h>

#include <brdfs/fit/budget_json.h>
#include <brdfs/fit/dispersion_json.h>
#include <brdfs/fit/instrument/instrument_json.h>
#include <brdfs/fit/uncertainty_json.h>
#include <hshfit/accuracy/metrics.h>
#include <hshfit/version.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace hshfit::brdfs {
namespace {

using Json = nlohmann::ordered_json;

Json parametersJson(const FitResult& result) {
    Json list = Json::array();
    for (const FittedParameter& parameter : result.parameters) {
        Json json = {{"name", parameter.name}};
        if (!parameter.channel.empty()) json["channel"] = parameter.channel;
        json["value"] = parameter.value;
        json["standard_error"] = parameter.standardError ? Json(*parameter.standardError) : Json();
        if (!parameter.bound.empty()) json["at_bound"] = parameter.bound;
        json["linear"] = parameter.linear;
        if (parameter.instrument) json["instrument"] = true;
        list.push_back(std::move(json));
    }
    return list;
}

Json correlationsJson(const FitResult& result) {
    const std::size_t n = result.parameters.size();
    Json rows = Json::array();
    for (std::size_t i = 0; i < n; ++i) {
        Json row = Json::array();
        for (std::size_t j = 0; j < n; ++j) row.push_back(result.correlations[i * n + j]);
        rows.push_back(std::move(row));
    }
    return rows;
}

Json metricsJson(const FitReport& report) {
    const FitSamples& samples = *report.ofMetrics;
    const std::vector<double> own = predictedValues(report.result, samples);
    Json metrics = Json::array();
    for (const MetricValue& value :
         compareSamples(samples.values, own, samples.wiZ, samples.weights)) {
        Json json = {{"name", value.metric->name},
                     {"value", value.value ? Json(*value.value) : Json()}};
        if (!value.reason.empty()) json["reason"] = value.reason;
        metrics.push_back(std::move(json));
    }
    return metrics;
}

std::string_view weightsOf(const FitSamples& samples) {
    if (!samples.sigmas.empty()) return "sigma";
    if (samples.origin == SampleOrigin::pixels) return "area";
    return samples.solidAngles ? "solid-angle" : "equal";
}

Json spectrumJson(const std::vector<FittedWavelength>& spectrum) {
    Json list = Json::array();
    for (const FittedWavelength& own : spectrum)
        list.push_back({{"wavelength", own.nanometres}, {"spec", own.spec}});
    return list;
}

Json heldJson(const FitResult& result, const FitSamples& samples) {
    Json list = Json::array();
    for (const HeldValue& held : heldValues(result.model, samples.isotropic)) {
        Json value = held.numbers.size() == 1 ? Json(held.numbers[0]) : Json(held.numbers);
        list.push_back({{"name", held.name},
                        {"value", held.numbers.empty() ? Json(held.word) : std::move(value)}});
        if (held.isDefault) list.back()["default"] = true;
        if (held.isStated) list.back()["stated"] = true;
    }
    return list;
}

}  // namespace

Json fitPreset(const FitReport& report) {
    const FitResult& result = report.result;
    const FitOptions& options = report.options;
    const FitSamples& samples = *report.samples;
    const Masked& masked = samples.masked;
    Json fit = {
        {"data", report.data},
        {"model", result.model},
        {"loss", lossName(options.loss)},
        {"robust", robustName(options.robust)},
        {"weights", weightsOf(samples)},
        {"samples", result.samples},
        {"samples_of", nameOf(samples.origin)},
        {"values", result.values},
        {"masked",
         {{"below_horizon", masked.belowHorizon},
          {"invalid", masked.invalid},
          {"not_finite", masked.notFinite},
          {"grazing", masked.grazing},
          {"not_drawn", masked.notDrawn}}},
        {"per_channel", options.perChannel},
        {"converged", result.converged},
        {"ceres", result.message},
        {"iterations", result.iterations},
        {"evaluations", result.evaluations},
        {"starts", result.startCount},
        {"seed", result.seed},
        {"rms", result.loss},
        {"projected_gradient", result.projectedGradient},
        {"aic", result.aic},
        {"bic", result.bic},
        {"parameters", parametersJson(result)},
        {"held", heldJson(result, samples)},
        {"correlations", correlationsJson(result)},
        {"ambiguous", result.ambiguous},
        {"metrics", metricsJson(report)},
    };
    if (!result.laws.empty()) fit["dispersion"] = dispersionJson(result);
    if (options.robust != Robust::none) fit["robust_scale"] = result.robustScale;
    if (result.instrument) fit["instrument"] = instrumentJson(*result.instrument);
    if (result.budget) fit["budget"] = budgetJson(*result.budget);
    if (result.uncertainty) {
        fit["uncertainty"] = uncertaintyJson(report);
        fit["influence"] = influenceJson(samples, *result.uncertainty);
    }
    Json preset = {{"format", "hshfit-preset"}, {"version", 1}};
    if (result.spectrum.empty())
        preset["spec"] = result.spec;
    else
        preset["spectrum"] = spectrumJson(result.spectrum);
    preset["source"] = fmt::format("fit of {} to {}", result.model, report.data);
    preset["generator"] = fmt::format("hshfit {}", version);
    preset["fit"] = std::move(fit);
    return preset;
}

Json searchJson(const PartSearch& search) {
    Json trials = Json::array(), held = Json::array();
    for (const HeldParameter& own : search.held)
        held.push_back({{"name", own.name}, {"value", own.value}, {"rms", own.loss}});
    for (const PartTrial& trial : search.trials) {
        trials.push_back({{"parts", trial.parts}, {"taken", trial.taken}});
        if (!trial.failure.empty()) {
            trials.back()["failure"] = trial.failure;
            continue;
        }
        trials.back()["rms"] = trial.loss;
        if (trial.heldOut) trials.back()["held_out_rms"] = *trial.heldOut;
    }
    return {{"chosen", search.parts},
            {"least_gain", PartOptions{}.leastGain},
            {"held", held},
            {"trials", trials}};
}

}  // namespace hshfit::brdfs
