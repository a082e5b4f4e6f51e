#include <hshfit/choice/row_json.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/pages/pair_summary_json.h>
#include <hshfit/pages/picture_error_json.h>
#include <hshfit/tradeoff/tradeoff_files.h>
#include <hshfit/version.h>
#include <hshfit/wavelets/slices.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace hshfit::tradeoff {
namespace {

using Json = nlohmann::ordered_json;

Json metricsJson(const PairErrors& errors) {
    Json json = Json::object();
    for (std::size_t m = 0; m < errors.values.size(); ++m) {
        json[std::string(metricCatalog()[m].name)] = finiteOrNull(errors.values[m]);
    }
    return json;
}

/// The picture error of a form, and why it is poor.
void addPicture(const Tradeoff& trade, std::size_t k, Json& json) {
    json["picture"] = pictureErrorJson(*trade.forms[k].picture);
    if (const auto reason = trade.poorReasonOf(k)) json["poor"] = *reason;
}

Json formJson(const Tradeoff& trade, std::size_t k) {
    const Measured& form = trade.forms[k];
    Json bands = Json::array(), steps = Json::array();
    for (std::size_t b = 0; b < bandCount; ++b)
        bands.push_back(finiteOrNull(trade.bandErrorOf(k, b)));
    for (const RepresentationStep& step : form.steps) {
        steps.push_back({{"what", step.what}, {"change", finiteOrNull(step.change)}});
    }
    Json json = {{"options", form.options},
                 {"kind", kindName(form.form.kind)},
                 {"bytes", form.bytes},
                 {"entropy_bytes", form.entropyBytes},
                 {"numbers", form.numbers},
                 {"error", finiteOrNull(trade.errorOf(k))},
                 {"uncertainty", finiteOrNull(trade.uncertaintyOf(trade.forms[k].errors))},
                 {"band_errors", bands},
                 {"metrics", metricsJson(form.errors)},
                 {"pairs", pairSummaryJson(form.summary)},
                 {"steps", steps}};
    // The front over time differs from run to run: its pictures are with the times.
    if (trade.metric == "picture" || std::ranges::count(trade.byteFront, k) > 0)
        addPicture(trade, k, json);
    return json;
}

Json frontJson(const Tradeoff& trade) {
    Json front = Json::array();
    for (const std::size_t k : trade.byteFront) {
        Json bands = Json::array();
        for (const PairErrors& band : trade.forms[k].bands) bands.push_back(metricsJson(band));
        front.push_back({{"form", k}, {"command", commandOf(trade, k)}, {"bands", bands}});
        if (const auto& cost = trade.forms[k].cost) front.back()["cost"] = choice::costJson(*cost);
    }
    return front;
}

Json formulasJson(const Tradeoff& trade) {
    Json list = Json::array();
    for (std::size_t k = 0; k < trade.formulas.size(); ++k) {
        const MeasuredFormula& formula = trade.formulas[k];
        Json row = choice::rowJson(formula.row);
        row["error"] = finiteOrNull(trade.formulaErrorOf(k));
        row["metrics"] = metricsJson(formula.errors);
        if (formula.row.cost) row["cost"] = choice::costJson(*formula.row.cost);
        list.push_back(row);
    }
    return list;
}

Json leftOutJson(const Tradeoff& trade) {
    Json list = Json::array();
    for (const LeftOut& line : trade.leftOut) {
        list.push_back({{"reason", line.reason}, {"forms", line.forms}, {"example", line.example}});
    }
    return list;
}

Json waveletsJson(const Tradeoff& trade) {
    Json list = Json::array();
    for (std::size_t k = 0; k < trade.wavelets.size(); ++k) {
        const MeasuredWavelets& form = trade.wavelets[k];
        list.push_back({{"basis", wavelets::sohoName},
                        {"selection", "best_terms"},
                        {"outgoing", form.outgoing},
                        {"terms", form.terms},
                        {"value_bytes", form.valueBytes},
                        {"bytes", form.bytes},
                        {"error", finiteOrNull(trade.waveletErrorOf(k))},
                        {"metrics", metricsJson(form.errors)}});
    }
    return list;
}

Json tradeJson(const Tradeoff& trade) {
    Json forms = Json::array();
    for (std::size_t k = 0; k < trade.forms.size(); ++k) forms.push_back(formJson(trade, k));
    Json json = {{"brdf", trade.brdf},
                 {"channels", trade.channels.names()},
                 {"isotropic", trade.laws.isotropic},
                 {"pairs", trade.pairs},
                 {"no_squares", trade.noSquares.empty() ? Json(nullptr) : Json(trade.noSquares)},
                 {"slice_bound",
                  {{"outgoing", trade.sliceOutgoing}, {"relative_l2_by_rank", trade.sliceErrors}}},
                 {"front", frontJson(trade)},
                 {"knee", trade.byteKnee ? Json(*trade.byteKnee) : Json(nullptr)},
                 {"forms", forms},
                 {"left_out", leftOutJson(trade)},
                 {"beyond_max_bytes", trade.beyondBytes}};
    if (!trade.wavelets.empty()) json["wavelets"] = waveletsJson(trade);
    if (!trade.formulas.empty()) json["formulas"] = formulasJson(trade);
    if (trade.costs) json["costs"] = choice::scaleJson(*trade.costs);
    return json;
}

Json pairTimeJson(const PairTime& time) {
    return {{"median", time.median}, {"low", time.low}, {"high", time.high}};
}

Json shaderTimeJson(const gpu::ShaderTime& time) {
    return {{"median", time.median}, {"low", time.low}, {"high", time.high}};
}

Json shadersJson(const MeasuredShaders& shaders) {
    Json forms = Json::array();
    for (const MeasuredShader& form : shaders.forms) {
        forms.push_back(
            {{"form", form.form},
             {"ns_per_million_pixels", form.time ? shaderTimeJson(*form.time) : Json(nullptr)},
             {"reason", form.reason.empty() ? Json(nullptr) : Json(form.reason)}});
    }
    return {{"device", shaders.device},
            {"software", shaders.software},
            {"bare_ns_per_million_pixels", shaderTimeJson(shaders.bare)},
            {"forms", forms}};
}

Json tradeTimingJson(const Tradeoff& trade) {
    Json forms = Json::array(), front = Json::array();
    for (std::size_t k = 0; k < trade.times.size(); ++k) {
        const MeasuredTime& time = trade.times[k];
        forms.push_back({{"options", trade.forms[k].options},
                         {"batch_ns", pairTimeJson(time.evaluation.batch)},
                         {"single_ns", pairTimeJson(time.evaluation.single)},
                         {"projection_s", time.projectionSeconds},
                         {"derivation_s", time.derivationSeconds}});
    }
    for (const std::size_t k : trade.timeFront) {
        front.push_back({{"form", k}, {"command", commandOf(trade, k)}});
        addPicture(trade, k, front.back());
        if (const auto& cost = trade.forms[k].cost) front.back()["cost"] = choice::costJson(*cost);
    }
    Json json = {{"brdf", trade.brdf},
                 {"front", front},
                 {"knee", trade.timeKnee ? Json(*trade.timeKnee) : Json(nullptr)},
                 {"forms", forms}};
    if (trade.shaders) json["gpu"] = shadersJson(*trade.shaders);
    return json;
}

Json timingDocument(std::span<const Tradeoff> trades) {
    Json list = Json::array();
    for (const Tradeoff& trade : trades) list.push_back(tradeTimingJson(trade));
    return {{"format", "hshfit-tradeoff-timing"},
            {"version", 1},
            {"generator", std::string("hshfit ") + version},
            {"tradeoffs", list}};
}

bool isTimed(std::span<const Tradeoff> trades) {
    return !trades.empty() && !trades[0].times.empty();
}

}  // namespace

std::string tradeoffJson(std::span<const Tradeoff> trades, bool timing) {
    Json list = Json::array();
    for (const Tradeoff& trade : trades) list.push_back(tradeJson(trade));
    Json document = {{"format", "hshfit-tradeoff"},
                     {"version", 1},
                     {"generator", std::string("hshfit ") + version},
                     {"metric", trades.empty() ? "" : trades[0].metric},
                     {"band_edges", bandEdges},
                     {"tradeoffs", list}};
    if (timing && isTimed(trades)) document["timing"] = timingDocument(trades);
    return jsonText(document, 2) + "\n";
}

std::string timingJson(std::span<const Tradeoff> trades) {
    return jsonText(timingDocument(trades), 2) + "\n";
}

}  // namespace hshfit::tradeoff
