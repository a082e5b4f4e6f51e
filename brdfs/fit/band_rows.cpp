#include <brdfs/fit/band_rows.h>

#include <brdfs/fit/residual_rows.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>

namespace hshfit::brdfs {
namespace {

std::string ends(const Interval& interval) {
    return fmt::format(",{},{}", *interval.low, *interval.high);
}

/// The probability of a normal variable within one standard deviation.
const double oneSigma = std::erf(std::sqrt(0.5));

std::string degreesText(double degrees) {
    return std::isfinite(degrees) ? fmt::format("{}", degrees) : "";
}

/// The value that counts most by `size`, with its place.
template <class Size>
nlohmann::ordered_json largest(const FitSamples& samples, const Prediction& prediction,
                               const Size& size) {
    std::size_t most = 0;
    for (std::size_t v = 1; v < prediction.values.size(); ++v)
        if (size(v) > size(most)) most = v;
    const std::vector<std::string> names = samples.channels.names();
    const ValuePlace place{most / samples.size(), most % samples.size()};
    nlohmann::ordered_json json = {{"row", rowOf(samples, place)}};
    if (names.size() > 1) json["channel"] = names[place.channel];
    json["model"] = prediction.values[most];
    json["standard_error"] = prediction.errors[most];
    return json;
}

}  // namespace

void writeBandRows(const Bands& bands, const Channels& channels,
                   const std::function<void(std::string_view)>& write) {
    const Prediction& p = bands.prediction;
    write(fmt::format(
        "pair,wi_x,wi_y,wi_z,wo_x,wo_y,wo_z,channel,f,standard_error,degrees_of_freedom,low_68,"
        "high_68,low_95,high_95,"
        "all_low_95,all_high_95{}\n",
        p.bootstrap ? ",bootstrap_error,bootstrap_low_68,bootstrap_high_68,bootstrap_low_95,"
                      "bootstrap_high_95"
                    : ""));
    const std::vector<std::string> names = columnNames(channels);
    for (std::size_t k = 0; k < p.pairs; ++k)
        for (std::size_t c = 0; c < p.channels; ++c) {
            const std::size_t v = c * p.pairs + k;
            const DirectionPair& pair = bands.pairs[k];
            const double f = p.values[v], e = p.errors[v];
            std::string row = fmt::format("{},{},{},{},{},{},{},{},{},{},{}", k + 1, pair.wi.x,
                                          pair.wi.y, pair.wi.z, pair.wo.x, pair.wo.y, pair.wo.z,
                                          names[c], f, e, degreesText(p.degrees[v]));
            for (const double factor :
                 {Prediction::pointwise(oneSigma, p.degrees[v]),
                  Prediction::pointwise(0.95, p.degrees[v]), bands.simultaneous})
                row += ends({f - factor * e, f + factor * e});
            if (p.bootstrap)
                row += fmt::format(",{}{}{}", p.bootstrap->errors[v],
                                   ends(p.bootstrap->within68[v]), ends(p.bootstrap->within95[v]));
            write(row + "\n");
        }
}

nlohmann::ordered_json bandRowsJson(const Bands& bands, const Channels& channels) {
    const Prediction& p = bands.prediction;
    const std::vector<std::string> names = columnNames(channels);
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (std::size_t k = 0; k < p.pairs; ++k)
        for (std::size_t c = 0; c < p.channels; ++c) {
            const std::size_t v = c * p.pairs + k;
            const Direction &wi = bands.pairs[k].wi, &wo = bands.pairs[k].wo;
            nlohmann::ordered_json row = {
                {"pair", k + 1}, {"wi", {wi.x, wi.y, wi.z}}, {"wo", {wo.x, wo.y, wo.z}}};
            if (!names[c].empty()) row["channel"] = names[c];
            row["f"] = p.values[v];
            row["standard_error"] = p.errors[v];
            if (std::isfinite(p.degrees[v])) row["degrees_of_freedom"] = p.degrees[v];
            if (p.bootstrap) row["bootstrap_error"] = p.bootstrap->errors[v];
            rows.push_back(std::move(row));
        }
    return rows;
}

nlohmann::ordered_json predictionJson(const FitSamples& samples, const FitResult& result,
                                      const Prediction& prediction) {
    const auto relative = [&](std::size_t v) {
        const double f = std::abs(prediction.values[v]);
        return f > 0 ? prediction.errors[v] / f : 0;
    };
    double squares = 0, relativeSquares = 0;
    for (std::size_t v = 0; v < prediction.values.size(); ++v) {
        squares += prediction.errors[v] * prediction.errors[v];
        relativeSquares += relative(v) * relative(v);
    }
    const double count = static_cast<double>(prediction.values.size());
    const Uncertainty none, &own = result.uncertainty ? *result.uncertainty : none;
    return {{"route", own.correlated       ? "correlated"
                      : own.scansSuffice() ? "scans"
                      : own.scans > 0      ? "normal"
                                           : "sandwich"},
            {"rms_error", std::sqrt(squares / count)},
            {"rms_relative_error", std::sqrt(relativeSquares / count)},
            {"largest_error",
             largest(samples, prediction, [&](std::size_t v) { return prediction.errors[v]; })},
            {"largest_relative_error", largest(samples, prediction, relative)}};
}

}  // namespace hshfit::brdfs
