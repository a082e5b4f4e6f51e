#include "map_answers.h"

#include <jobs/common/direction_json.h>

#include <nlohmann/json.hpp>

namespace hshfit::jobs {
namespace {

using Json = nlohmann::ordered_json;

Json jsonOf(const TexelPairErrors& errors) {
    return {{"texels", errors.texels},
            {"log_error",
             {{"mean", errors.meanLog},
              {"uncertainty", errors.uncertainty},
              {"mirror", errors.mirror},
              {"maximum", errors.worstLog},
              {"column", errors.worstAt.column},
              {"row", errors.worstAt.row}}},
            {"largest_difference",
             {{"value", errors.largest},
              {"incoming", directionJson(errors.pair.wi)},
              {"outgoing", directionJson(errors.pair.wo)},
              {"column", errors.largestAt.column},
              {"row", errors.largestAt.row}}},
            {"albedo",
             {{"error", errors.albedo},
              {"uncertainty", errors.albedoUncertainty},
              {"column", errors.albedoAt.column},
              {"row", errors.albedoAt.row}}}};
}

Json jsonOf(const MapChoice& choice) {
    Json json = {{"form", choice.form},
                 {"count", choice.count},
                 {"bytes_per_texel", choice.bytesOfTexel},
                 {"shared_bytes", choice.sharedBytes}};
    if (choice.errors) {
        json["error"] = {{"mean", choice.errors->mean},
                         {"percentile_99", choice.errors->percentile99},
                         {"maximum", choice.errors->maximum}};
    }
    if (choice.pairs) json["against_brdfs"] = jsonOf(*choice.pairs);
    return json;
}

Json jsonOf(const MapLibrary& library) {
    Json json = {{"given", library.given.empty() ? Json(nullptr) : Json(library.given)},
                 {"materials", library.materials}};
    if (library.pictures > 0)
        json["flip"] = {{"texels", library.pictures},
                        {"mean", library.flip},
                        {"maximum", library.worstFlip},
                        {"column", library.worstAt.column},
                        {"row", library.worstAt.row}};
    json["poor"] = library.poor.empty() ? Json(nullptr) : Json(library.poor);
    return json;
}

Json levelsJson(const Svbrdf& done) {
    Json levels = Json::array();
    for (std::size_t level = 0; level < done.levels.size(); ++level) {
        const LevelErrors& errors = done.errors[level];
        Json json = {{"width", done.levels[level].width},
                     {"height", done.levels[level].height},
                     {"error",
                      {{"mean", errors.mean},
                       {"maximum", errors.maximum},
                       {"column", errors.column},
                       {"row", errors.row}}}};
        for (const LevelCheck& check : done.checks) {
            if (check.level != level) continue;
            json["against_samples"] = {
                {"texels", check.texels},
                {"stored", {{"mean", check.stored}, {"maximum", check.storedMaximum}}},
                {"parameters", {{"mean", check.parameters}, {"maximum", check.parametersMaximum}}}};
        }
        if (level < done.levelPairs.size()) json["against_brdfs"] = jsonOf(done.levelPairs[level]);
        levels.push_back(std::move(json));
    }
    return levels;
}

Json jsonOf(const FilteredError& error) {
    return {{"relative", error.relative},
            {"mean", error.mean},
            {"maximum", error.maximum},
            {"column", error.column},
            {"row", error.row},
            {"largest_difference",
             {{"value", error.largest},
              {"incoming", directionJson(error.wi)},
              {"outgoing", directionJson(error.wo)}}},
            {"albedo", error.albedo},
            {"worst_albedo", error.worstAlbedo}};
}

Json jsonOf(const FilteredLevel& level) {
    Json json = {{"width", level.size.width}, {"height", level.size.height}};
    if (level.texels > 0) {
        json["against_samples"] = {{"texels", level.texels},
                                   {"noise", level.noise},
                                   {"stored", jsonOf(level.stored)},
                                   {"parameters", jsonOf(level.parameters)}};
    }
    return json;
}

}  // namespace

nlohmann::ordered_json svbrdfJson(const Svbrdf& done) {
    Json choices = Json::array();
    for (const MapChoice& choice : done.choices) choices.push_back(jsonOf(choice));
    Json json = {
        {"format", "hshfit-svbrdf-answer"},
        {"version", 1},
        {"description", done.description},
        {"model", done.model},
        {"width", done.width},
        {"height", done.height},
        {"isotropic", done.isotropic},
        {"outgoing", done.outgoing},
        {"lobes", done.lobes},
        {"table", {{"axes", done.axes}, {"nodes", done.tableNodes}, {"error", done.tableError}}},
        {"captured", {{"least", done.captured}, {"brdf", done.leastCaptured}}},
        {"form", done.form},
        {"count", done.count},
        {"choices", choices},
        {"levels", levelsJson(done)},
        {"bytes", done.bytes},
        {"processes", done.processes},
        {"writes", done.pastPageCache ? "direct" : "cached"},
        {"seconds", {{"preparation", done.tableSeconds}, {"writing", done.seconds}}},
        {"texels_per_second", {{"written", done.rate}, {"kernel", done.kernelRate}}},
        {"files", done.files}};
    if (done.timeIsOver) json["time_over"] = true;
    if (done.library) {
        // The library has no coefficients of a basis over directions.
        for (const char* key : {"outgoing", "lobes", "table", "captured"}) json.erase(key);
        json["texels_per_second"].erase("kernel");
        json["library"] = jsonOf(*done.library);
    }
    if (done.fit.texels > 0) {
        json["fit"] = {{"texels", done.fit.texels},
                       {"mean", done.fit.mean},
                       {"maximum", done.fit.maximum},
                       {"column", done.fit.column},
                       {"row", done.fit.row}};
    }
    return json;
}

nlohmann::ordered_json filteredMapJson(const FilteredMapAnswer& done) {
    Json choices = Json::array(), levels = Json::array();
    for (const FilteredChoice& choice : done.choices) {
        choices.push_back({{"form", choice.form},
                           {"order", choice.order},
                           {"numbers", choice.numbers},
                           {"bytes_per_texel", choice.bytesOfTexel},
                           {"error", choice.error},
                           {"level", choice.level},
                           {"maximum",
                            {{"error", choice.maximum},
                             {"level", choice.maximumLevel},
                             {"column", choice.column},
                             {"row", choice.row}}}});
    }
    for (const FilteredLevel& level : done.levels) levels.push_back(jsonOf(level));
    return {{"format", "hshfit-filtered-map-answer"},
            {"version", 1},
            {"description", done.description},
            {"model", done.model},
            {"width", done.width},
            {"height", done.height},
            {"renormalised", done.renormalised},
            {"parameters", done.parameters},
            {"nodes", done.nodes},
            {"node_error", done.nodeError},
            {"form", done.form},
            {"order", done.order},
            {"numbers", done.numbers},
            {"weights", done.weights},
            {"albedos", done.albedos},
            {"choices", choices},
            {"levels", levels},
            {"bytes", done.bytes},
            {"processes", done.processes},
            {"seconds", done.seconds},
            {"texels_per_second", done.rate},
            {"files", done.files}};
}

}  // namespace hshfit::jobs
