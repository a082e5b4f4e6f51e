#include "command.h"
#include "command_rows.h"
#include "job_options.h"
#include "measured_numbers.h"

#include <hshfit/coefficients/light_coefficients.h>
#include <hshfit/error.h>
#include <hshfit/files/json_fields.h>

#include <jobs/lighting/light.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace hshfit::cli {
namespace {

using Json = nlohmann::ordered_json;

struct LightArguments {
    std::vector<std::string> specs;
    std::string output;
    jobs::LightOptions options;
};

Json energyJson(const Energy& energy) {
    Json json = {{"value", finiteOrNull(energy.finite ? energy.value : NAN)},
                 {"error", finiteOrNull(energy.finite ? energy.error : NAN)},
                 {"finite", energy.finite}};
    if (!energy.finite) json["reason"] = energy.reason;
    return json;
}

Json curveJson(const LightCurve& curve) {
    Json points = Json::array();
    for (const LightCurve::Point& point : curve.points) {
        points.push_back({{"order", point.order},
                          {"coefficients", point.coefficients},
                          {"slots", point.order * point.order},
                          {"accuracy", finiteOrNull(point.accuracy)}});
    }
    return {{"basis", curve.basis}, {"points", points}};
}

std::string splitText(const jobs::SplitLight& split) {
    return fmt::format(
        "{}: the picture without its sun, {} pixels filled\n  sun: {}\n"
        "  sum: '{}'\n  coefficients of the sum differ by {:.1e}\n",
        split.rest, split.split.rest.size(), split.sun, split.specification, split.error);
}

std::string shareName(double share) {
    return fmt::format("{:g}", 100 * share);
}

Json enoughJson(const std::vector<std::optional<int>>& enough) {
    Json json = Json::object();
    for (std::size_t k = 0; k < enough.size(); ++k)
        json[shareName(jobs::lightShares[k])] = enough[k] ? Json(*enough[k]) : Json(nullptr);
    return json;
}

Json answer(const jobs::ProjectedLight& result, const std::string& output) {
    const LightCoefficients& light = result.light;
    Json normal = nullptr;
    if (light.domain == LightCoefficients::Domain::hemisphere) {
        normal = {{"theta", degrees(light.normalTheta)}, {"phi", degrees(light.normalPhi)}};
    }
    Json curves = Json::array({curveJson(light.curves.front())});
    if (result.wavelets) {
        Json curve = curveJson(*result.wavelets);
        curve["selection"] = "best_terms";
        curve["error"] = finiteOrNull(result.waveletError);
        curve["enough"] = enoughJson(result.enoughWavelets);
        curves.push_back(curve);
    }
    Json json = {{"format", "hshfit-light-answer"},
                 {"version", 1},
                 {"light", light.source},
                 {"output", output},
                 {"basis", light.basis},
                 {"order", light.order},
                 {"domain", normal.is_null() ? "sphere" : "hemisphere"},
                 {"normal", normal},
                 {"channels", light.channels.names()},
                 {"energy", energyJson(light.energy)},
                 {"error", finiteOrNull(light.error)},
                 {"bands", result.bands},
                 {"enough", enoughJson(result.enough)},
                 {"curves", curves}};
    if (result.split) json["split"] = jobs::splitJson(*result.split);
    return json;
}

std::string bandsText(int order) {
    return order == 1 ? "1 band (1 slot)"
                      : fmt::format("{} bands ({} slots)", order, order * order);
}

std::string enoughText(const jobs::ProjectedLight& result) {
    std::string text;
    for (std::size_t k = 0; k < result.enough.size(); ++k) {
        const auto& order = result.enough[k];
        text += fmt::format("  {:>5} % of the energy: {}\n", shareName(jobs::lightShares[k]),
                            order ? bandsText(*order)
                                  : fmt::format("more than {} band{}", result.light.order,
                                                result.light.order == 1 ? "" : "s"));
    }
    return text;
}

std::string waveletText(const jobs::ProjectedLight& result) {
    if (!result.wavelets) return "";
    const LightCurve::Point& last = result.wavelets->points.back();
    std::string out = fmt::format("  soho, best {} terms: {:.6f} of the energy, error {:.1e}\n",
                                  last.coefficients, last.accuracy, result.waveletError);
    for (std::size_t k = 0; k < result.enoughWavelets.size(); ++k) {
        const auto& count = result.enoughWavelets[k];
        out += fmt::format("  {:>5} % of the energy: {}\n", shareName(jobs::lightShares[k]),
                           count ? fmt::format("{} terms", *count)
                                 : fmt::format("more than {} terms", last.coefficients));
    }
    return out;
}

std::string text(const jobs::ProjectedLight& result, const std::string& output) {
    const LightCoefficients& light = result.light;
    const bool known = light.energy.finite && light.energy.value > 0;
    return fmt::format("{}: {} order {}, {}, error {:.1e}\n{}{}", output, light.basis, light.order,
                       known ? fmt::format("{:.6f} of the energy captured",
                                           light.curves.front().points.back().accuracy)
                             : std::string(noCapturedEnergy),
                       light.error, known ? enoughText(result) : "", waveletText(result)) +
           (result.split ? splitText(*result.split) : "");
}

void runLight(const LightArguments& arguments, Globals& globals) {
    const jobs::ProjectedLight result =
        jobs::light(arguments.specs, arguments.output, arguments.options);
    for (const std::string& remark : result.remarks) note(globals, remark);
    const Energy& energy = result.light.energy;
    if (!energy.finite) note(globals, "the energy does not exist: " + energy.reason);
    if (globals.json)
        printJson(answer(result, arguments.output));
    else
        printText(text(result, arguments.output));
}

constexpr ArgumentRow lightArguments[] = {
    required("SPEC", at<&LightArguments::specs>,
             "One or more lights, which add up: kind:key=value,…, the path of a picture, or "
             "PATH:convention=NAME of nine numbers (docs/explanation/irradiance.md)",
             lightRead),
    requiredOutput(at<&LightArguments::output>, "File of coefficients, .json", jsonWritten),
};

}  // namespace

CommandRows lightRows() {
    return {lightArguments, {jobs::lightOptions().rows}};
}

void addLight(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<LightArguments>();
    addArguments(command, lightArguments, *arguments);
    addOptions(command, jobs::lightOptions(), arguments->options);
    command.callback([arguments, &globals] { runLight(*arguments, globals); });
}

}  // namespace hshfit::cli
