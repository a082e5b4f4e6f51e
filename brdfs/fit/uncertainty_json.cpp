#include <brdfs/fit/uncertainty_json.h>

#include <brdfs/fit/band_rows.h>
#include <brdfs/fit/distributions.h>
#include <brdfs/fit/residual_rows.h>
#include <hshfit/files/json_fields.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {
namespace {

using Document = nlohmann::ordered_json;

Document intervalJson(const Interval& interval) {
    return Document::array({finiteOrNull(interval.low), finiteOrNull(interval.high)});
}

Document errorsJson(const FittedParameter& parameter, const ParameterUncertainty& own,
                    bool byScan) {
    Document json = {{"name", parameter.name}};
    if (!parameter.channel.empty()) json["channel"] = parameter.channel;
    json["value"] = parameter.value;
    json["normal"] = finiteOrNull(own.normal);
    json["sandwich"] = finiteOrNull(own.sandwich);
    if (own.correlated) json["correlated"] = *own.correlated;
    if (byScan) json["scans"] = finiteOrNull(own.scans);
    if (own.scanDegrees) {
        const auto within = [&](double outside) {
            const double half = studentBound(outside, *own.scanDegrees) * *own.scans;
            return Document::array({parameter.value - half, parameter.value + half});
        };
        json["scans_student"] = {{"degrees_of_freedom", *own.scanDegrees},
                                 {"interval_68", within(std::erfc(std::sqrt(0.5)))},
                                 {"interval_95", within(0.05)}};
    }
    if (own.bootstrap)
        json["bootstrap"] = {{"standard_error", own.bootstrap->error},
                             {"interval_68", intervalJson(own.bootstrap->within68)},
                             {"interval_95", intervalJson(own.bootstrap->within95)}};
    if (own.profile)
        json["profile"] = {{"interval_68", intervalJson(own.profile->within68)},
                           {"interval_95", intervalJson(own.profile->within95)},
                           {"quadratic", own.profile->quadratic}};
    return json;
}

/// Rows of a matrix; over the roots of its diagonal if `correlations`.
Document matrixJson(const std::vector<double>& matrix, std::size_t n, bool correlations) {
    Document rows = Document::array();
    for (std::size_t i = 0; i < n; ++i) {
        Document row = Document::array();
        for (std::size_t j = 0; j < n; ++j) {
            const double size = std::sqrt(matrix[i * n + i] * matrix[j * n + j]);
            const double value = matrix[i * n + j];
            row.push_back(!correlations ? value : size > 0 ? value / size : 0);
        }
        rows.push_back(std::move(row));
    }
    return rows;
}

Document valuesJson(const FitSamples& samples, const Uncertainty& uncertainty,
                    const std::vector<ValuePlace>& places) {
    Document list = Document::array();
    const std::vector<std::string> names = samples.channels.names();
    for (std::size_t i = 0; i < std::min(places.size(), mostListed); ++i) {
        const ValuePlace& place = places[i];
        const std::size_t v = place.channel * samples.size() + place.sample;
        const ValueInfluence& own = uncertainty.values[v];
        Document json = {{"row", rowOf(samples, place)}};
        if (names.size() > 1) json["channel"] = names[place.channel];
        json["value"] = samples.values[v];
        json["model"] = own.model;
        json["studentised"] = own.studentised;
        json["leverage"] = own.leverage;
        json["cook"] = own.cook;
        list.push_back(std::move(json));
    }
    return list;
}

}  // namespace

Document uncertaintyJson(const FitReport& report) {
    const Uncertainty& own = *report.result.uncertainty;
    Document json = Document::object();
    if (!report.sigma.empty()) json["sigma"] = report.sigma;
    json["chi_square"] = own.stated ? Document(own.chiSquare) : Document();
    json["degrees_of_freedom"] = own.degreesOfFreedom;
    json["reduced_chi_square"] = own.stated ? Document(own.reducedChiSquare()) : Document();
    json["probability"] = finiteOrNull(own.probability);
    json["residual_variance"] = own.reducedChiSquare();
    const SigmaCorrelation& correlation = report.samples->correlation;
    if (correlation.any()) {
        json["correlation"] = {{"used_in", own.whitened ? "fit" : "errors"}};
        if (correlation.blocks) json["correlation"]["file"] = correlation.blocks->path;
        if (correlation.angle > 0) json["correlation"]["angle"] = degrees(correlation.angle);
        if (correlation.wavelength > 0) json["correlation"]["wavelength"] = correlation.wavelength;
    } else if (!report.scans.empty())
        json["scans"] = {{"by", report.scans}, {"count", own.scans}};
    if (own.scans > 0 && !own.scansSuffice())
        json["scans"]["reason"] = fmt::format(
            "{} scans give no errors of {} parameters by scan; those of the stated "
            "uncertainties are taken",
            own.scans, own.scanParameters);
    if (own.bootstrapDraws > 0)
        json["bootstrap"] = {{"draws", own.bootstrapDraws},
                             {"failed", own.bootstrapFailures},
                             {"of", own.scans > 0 ? "scans" : "samples"},
                             {"seed", report.options.seed}};
    if (!report.result.point.channels.empty())
        json["prediction"] = predictionJson(*report.samples, report.result,
                                            predict(report.result, *report.samples, false));
    json["parameters"] = Document::array();
    const std::size_t n = own.parameters.size();
    for (std::size_t i = 0; i < n; ++i)
        json["parameters"].push_back(
            errorsJson(report.result.parameters[i], own.parameters[i], own.scans > 0));
    json["covariance"] = matrixJson(own.covariance, n, false);
    json["correlations"] = matrixJson(own.covariance, n, true);
    return json;
}

Document influenceJson(const FitSamples& samples, const Uncertainty& uncertainty) {
    const std::vector<ValuePlace> outliers = outliersOf(samples, uncertainty);
    return {{"rows", samples.rows.empty() ? "samples" : "lines"},
            {"outlier_bound", uncertainty.outlierBound},
            {"outlier_count", outliers.size()},
            {"outliers", valuesJson(samples, uncertainty, outliers)},
            {"most_influential",
             valuesJson(samples, uncertainty, mostInfluential(samples, uncertainty, mostListed))}};
}

}  // namespace hshfit::brdfs
