#include <hshfit/pages/picture_error_json.h>

#include <hshfit/brdf/directions.h>

#include <nlohmann/json.hpp>

namespace hshfit::inline pages {
namespace {

using Json = nlohmann::ordered_json;

Json placeJson(const Direction& d) {
    return {{"theta", degrees(polarAngle(d))}, {"phi", degrees(azimuth(d))}};
}

/// The value, and its place if there is a difference.
Json differenceJson(const SeenDifference& difference) {
    Json json = {{"value", difference.value}};
    if (!(difference.value > 0)) return json;
    json["channel"] = difference.channel;
    json["wi"] = placeJson(difference.at.wi);
    json["wo"] = placeJson(difference.at.wo);
    return json;
}

OverLights overLightsFrom(const Json& json) {
    return {json["mean"], json["largest"], json["light"]};
}

Direction placeFrom(const Json& json) {
    return directionFromAngles(radians(json["theta"]), radians(json["phi"]));
}

SeenDifference differenceFrom(const Json& json) {
    SeenDifference difference{.value = json["value"]};
    if (!json.contains("channel")) return difference;
    difference.channel = json["channel"];
    difference.at = {placeFrom(json["wi"]), placeFrom(json["wo"])};
    return difference;
}

}  // namespace

Json overLightsJson(const OverLights& all) {
    return {{"mean", all.mean}, {"largest", all.largest}, {"light", all.light}};
}

PictureError pictureErrorFrom(const Json& json) {
    return {.channels = json["channels"],
            .flip = overLightsFrom(json["flip"]),
            .colour = overLightsFrom(json["ciede2000"]),
            .albedo = json["albedo"],
            .lastAlbedo = json["last_albedo"],
            .dip = differenceFrom(json["false_dip"]),
            .peak = differenceFrom(json["false_peak"]),
            .ridge = differenceFrom(json["ridge"])};
}

Json pictureErrorJson(const PictureError& error) {
    return {{"flip", overLightsJson(error.flip)},
            {"ciede2000", overLightsJson(error.colour)},
            {"channels", error.channels},
            {"albedo", error.albedo},
            {"last_albedo", error.lastAlbedo},
            {"false_dip", differenceJson(error.dip)},
            {"false_peak", differenceJson(error.peak)},
            {"ridge", differenceJson(error.ridge)}};
}

}  // namespace hshfit::inline pages
