#include "info_light.h"

#include "health.h"

#include <hshfit/files/json_fields.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace hshfit::cli {
namespace {

using Json = nlohmann::ordered_json;

Json placeJson(const Direction& d) {
    return {{"elevation", 90 - degrees(polarAngle(d))}, {"azimuth", degrees(azimuth(d))}};
}

Json rgbJson(const Rgb& rgb) {
    return {finiteOrNull(rgb[0]), finiteOrNull(rgb[1]), finiteOrNull(rgb[2])};
}

/// The members of one light beside its kind.
struct LightJson {
    Json operator()(const DiscLight& light) const {
        return {{"direction", placeJson(light.towards)},
                {"angular_diameter", degrees(2 * light.radius)}};
    }
    Json operator()(const PanelLight& light) const {
        return {{"direction", placeJson(light.towards)},
                {"width", degrees(light.width)},
                {"height", degrees(light.height)}};
    }
    Json operator()(const SkyLight& light) const {
        constexpr const char* models[] = {"uniform", "overcast", "cie", "preetham", "hosek-wilkie"};
        const auto model = static_cast<std::size_t>(light.model);
        Json json = {{"model", models[model]}};
        if (model >= 2) json["sun"] = placeJson(light.sun);
        return json;
    }
    Json operator()(const PictureLight& light) const {
        const PictureGeometry file = fileGeometryOf(light);
        const PictureFacts facts = PictureReader(light.file, optionsOf(light)).facts();
        Json json = {{"file", light.file},
                     {"layout", layoutName(light.fileLayout)},
                     {"width", file.width},
                     {"height", facts.fileHeight},
                     {"held_width", light.width},
                     {"held_height", light.height},
                     {"curve", curveName(light.curve)}};
        json["parts"] = Json::array();
        for (const PicturePart& part : facts.parts)
            json["parts"].push_back({{"name", part.name}, {"channels", part.channels}});
        json["part"] = facts.part + 1;
        if (!facts.layer.empty()) json["layer"] = facts.layer;
        if (facts.colour.primaries) json["primaries"] = *facts.colour.primaries;
        if (facts.colour.exposure != 1) json["exposure"] = facts.colour.exposure;
        if (facts.colour.correction != std::array<double, 3>{1, 1, 1})
            json["colour_correction"] = facts.colour.correction;
        return json;
    }
    Json operator()(const DirectionalLight& light) const {
        return {{"direction", placeJson(light.towards)}};
    }
    Json operator()(const CoefficientLight& light) const {
        const LightCoefficients& c = *light.coefficients;
        const bool sphere = c.domain == LightCoefficients::Domain::sphere;
        Json json = {{"file", light.file},
                     {"basis", c.basis},
                     {"order", c.order},
                     {"domain", sphere ? "sphere" : "hemisphere"}};
        if (!sphere) json["normal"] = placeJson(light.normal);
        json["signs_of_odd_m"] = c.condonShortley ? "-" : "+";
        if (std::isfinite(c.error)) json["error"] = c.error;
        if (c.energy.finite) json["energy"] = c.energy.value;
        const bool curve = !c.curves.empty() && !c.curves.front().points.empty();
        if (curve && std::isfinite(c.curves.front().points.back().accuracy))
            json["captured"] = c.curves.front().points.back().accuracy;
        json["source"] = c.source;
        return json;
    }
};

std::string colourText(const Json& rgb) {
    const auto one = [](const Json& value) {
        return value.is_null() ? std::string("inf") : fmt::format("{:.4g}", value.get<double>());
    };
    return one(rgb[0]) + " " + one(rgb[1]) + " " + one(rgb[2]);
}

std::string placeText(const Json& place) {
    return fmt::format("elevation {:.1f}, azimuth {:.1f}", place["elevation"].get<double>(),
                       place["azimuth"].get<double>());
}

/// "channels R, G, B", or of several parts "part 2 of 3: 1 'depth' Z; 2 'rgba' R, G, B; …".
std::string partsText(const Json& parts, std::size_t chosen) {
    const auto names = [](const Json& part) {
        std::string text;
        for (const Json& name : part["channels"])
            text += (text.empty() ? "" : ", ") + name.get<std::string>();
        return text;
    };
    if (parts.size() == 1) return "channels " + names(parts[0]);
    std::string text = fmt::format("part {} of {}:", chosen, parts.size());
    for (std::size_t k = 0; k < parts.size(); ++k)
        text += fmt::format("{} {} '{}' {}", k > 0 ? ";" : "", k + 1,
                            parts[k]["name"].get<std::string>(), names(parts[k]));
    return text;
}

/// The use of a file's primaries; eight zeros state none.
std::string primariesText(const Json& xy) {
    constexpr double rec709[] = {.64, .33, .30, .60, .15, .06, .3127, .3290};
    bool none = true, same = true;
    for (std::size_t k = 0; k < std::size(rec709); ++k) {
        const double value = xy[k];
        none = none && value == 0;
        same = same && std::abs(value - rec709[k]) < 1e-3;
    }
    return none ? ", which state none" : same ? ", Rec. 709" : ", converted to Rec. 709";
}

std::string lightLine(const Json& light) {
    std::string text;
    for (const auto& [key, value] : light.items()) {
        if (key == "kind" || key.starts_with("held_") || key == "part") continue;
        if (key == "parts") {
            text += "; " + partsText(value, light["part"].get<std::size_t>());
        } else if (value.is_array()) {
            text += fmt::format("; {} ", key);
            for (const Json& number : value) text += fmt::format("{:g} ", number.get<double>());
            text.pop_back();
            text += key == "primaries" ? primariesText(value) : ", divided out";
        } else if (key == "exposure") {
            text += fmt::format("; exposure {:g}, divided out", value.get<double>());
        } else if (value.is_object()) {
            text += (text.empty() ? "" : "; ") + placeText(value);
        } else if (value.is_string()) {
            text += (text.empty() ? "" : ", ") + value.get<std::string>();
        } else {
            text += fmt::format("{}{} {:g}", text.empty() ? "" : ", ", key, value.get<double>());
        }
    }
    if (light.contains("held_width") && light["held_width"] != light["width"])
        text += fmt::format(", held as {} x {}", light["held_width"].get<std::size_t>(),
                            light["held_height"].get<std::size_t>());
    return text;
}

}  // namespace

Json lightAnswer(const std::string& spec, const jobs::LightInfo& info) {
    Json document = {
        {"format", "hshfit-info"},     {"version", 1},           {"kind", "light"}, {"name", spec},
        {"channels", {"R", "G", "B"}}, {"lights", Json::array()}};
    for (const Light& light : info.lights) {
        Json json = {{"kind", kindOf(light)}};
        json.update(std::visit(LightJson{}, light));
        document["lights"].push_back(json);
    }
    const LightHealth& health = info.health;
    document["light_health"] = {{"mean", rgbJson(health.mean)},
                                {"peak", rgbJson(health.peak)},
                                {"peak_direction", placeJson(health.peakDirection)},
                                {"brightest_share", health.brightestShare},
                                {"dynamic_range", finiteOrNull(health.dynamicRange)},
                                {"black_share", health.blackShare},
                                {"negative_share", health.negativeShare},
                                {"least_negative", health.leastNegative},
                                {"clipped_by_half", health.clippedByHalf},
                                {"black_in_half", health.blackInHalf},
                                {"invalid",
                                 {{"negative", health.invalid.negative},
                                  {"nan", health.invalid.notANumber},
                                  {"infinite", health.invalid.infinite}}}};
    if (!info.warnings.empty()) document["warnings"] = info.warnings;
    return document;
}

std::string lightText(const Json& document) {
    std::string out = fmt::format("light: {}\n", document["name"].get<std::string>());
    for (const Json& light : document["lights"])
        out += factLine(light["kind"].get<std::string>(), lightLine(light));
    const Json& health = document["light_health"];
    out += factLine("mean radiance", colourText(health["mean"]));
    out += factLine("peak radiance", colourText(health["peak"]));
    out += factLine("peak towards", placeText(health["peak_direction"]));
    out += factLine("flux in the brightest 0.1 % of the sphere",
                    fmt::format("{:.3g} %", 100 * health["brightest_share"].get<double>()));
    const Json& range = health["dynamic_range"];
    if (range != 0)
        out +=
            factLine("dynamic range",
                     range.is_null() ? "infinite" : fmt::format("{:.3g} : 1", range.get<double>()));
    if (health["black_share"] > 0)
        out += factLine("black", fmt::format("{:.3g} % of the sphere",
                                             100 * health["black_share"].get<double>()));
    if (health["negative_share"] > 0)
        out += factLine("below 0", fmt::format("{:.3g} % of the sphere, down to {:.3g}",
                                               100 * health["negative_share"].get<double>(),
                                               health["least_negative"].get<double>()));
    out += factLine("fits a 16-bit float", health["clipped_by_half"] ? "no: above 65504"
                                           : health["black_in_half"] ? "no: all of it rounds to 0"
                                                                     : "yes");
    const Json& lights = document["lights"];
    const Json& invalid = health["invalid"];
    if (std::ranges::any_of(lights, [](const Json& light) { return light["kind"] == "picture"; }))
        out += factLine(
            "pixels below 0, NaN, infinite",
            fmt::format("{}, {}, {}", invalid["negative"].get<std::size_t>(),
                        invalid["nan"].get<std::size_t>(), invalid["infinite"].get<std::size_t>()));
    for (const Json& warning : document.value("warnings", Json::array()))
        out += factLine("WARNING", warning.get<std::string>());
    return out;
}

}  // namespace hshfit::cli
