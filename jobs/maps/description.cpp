#include "description.h"

#include <hshfit/error.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/files/mapped_file.h>
#include <hshfit/light/picture_reader.h>
#include <hshfit/specification/parameters.h>

#include <brdfs/catalog.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

namespace hshfit::jobs {
namespace {

const brdfs::Model& modelOf(const JsonFields& root) {
    const std::string name = root.word("model");
    std::vector<std::string_view> known;
    for (const brdfs::Model& model : brdfs::models()) {
        const bool through =
            std::ranges::find(model.parameters, "side", &Parameter::name) != model.parameters.end();
        if (model.name == name && through)
            root.fail(fmt::format("is '{}', a model of transmission; material maps take those of "
                                  "reflection",
                                  name),
                      "model");
        if (model.name == name) return model;
        known.push_back(model.name);
    }
    root.fail(fmt::format("unknown model '{}'{}; known: {}", name, suggestion(name, known),
                          joined(known)),
              "model");
}

const Parameter& parameterOf(const brdfs::Model& model, const std::string& name,
                             const JsonFields& parameters) {
    std::vector<std::string_view> known;
    for (const Parameter& parameter : model.parameters) {
        if (parameter.name == name) return parameter;
        known.push_back(parameter.name);
    }
    parameters.fail(fmt::format("{} has no parameter '{}'{}; known: {}", model.name, name,
                                suggestion(name, known), joined(known)));
}

TransferCurve curveOf(const JsonFields& map) {
    if (!map.has("curve")) return TransferCurve::linear;
    const std::string name = map.word("curve");
    std::vector<std::string_view> known;
    for (const CurveName& curve : curveNames()) {
        if (curve.name == name) return curve.curve;
        known.push_back(curve.name);
    }
    map.fail(fmt::format("unknown curve '{}'; known: {}", name, joined(known)), "curve");
}

void requireKnown(const JsonFields& map, std::span<const std::string_view> known) {
    for (const auto& [key, value] : map.json().items()) {
        if (std::ranges::find(known, key) == known.end())
            map.fail(fmt::format("unknown; known: {}", fmt::join(known, ", ")), key);
    }
}

std::string pathOf(const JsonFields& map, const char* key, const std::string& file) {
    return (std::filesystem::path(file).parent_path() / map.word(key)).string();
}

/// One of some words, the first where there is none.
std::size_t choiceOf(const JsonFields& map, const char* key,
                     std::span<const std::string_view> words) {
    if (!map.has(key)) return 0;
    const std::string word = map.word(key);
    const auto found = std::ranges::find(words, word);
    if (found == words.end())
        map.fail(fmt::format("is '{}'; valid: {}", word, fmt::join(words, ", ")), key);
    return static_cast<std::size_t>(found - words.begin());
}

VectorCodes codesOf(const JsonFields& map) {
    constexpr std::string_view words[] = {"automatic", "unsigned", "signed"};
    return static_cast<VectorCodes>(choiceOf(map, "encoding", words));
}
bool yDownOf(const JsonFields& map) {
    constexpr std::string_view words[] = {"up", "down"};
    return choiceOf(map, "y", words) == 1;
}

NormalReference normalOf(const JsonFields& map, const std::string& file) {
    constexpr std::string_view known[] = {"map", "channels", "encoding", "y", "scale", "lengths"};
    constexpr std::string_view lengths[] = {"refuse", "renormalise"};
    requireKnown(map, known);
    NormalReference result{.path = pathOf(map, "map", file),
                           .codes = codesOf(map),
                           .yDown = yDownOf(map),
                           .renormalise = choiceOf(map, "lengths", lengths) == 1};
    if (map.has("channels")) {
        result.channels = map.words("channels");
        if (result.channels.size() != 3 && result.channels.size() != 2)
            map.fail("has to name three channels, or two of which z follows", "channels");
    }
    if (map.has("scale")) result.scale = map.number("scale", 0, 1e6);
    return result;
}

DirectionReference directionOf(const JsonFields& root, const std::string& file) {
    constexpr double most = 1e12;
    if (!root.at("direction").is_object())
        return {.degrees = root.number("direction", -most, most)};
    const JsonFields map = root.object("direction");
    constexpr std::string_view known[] = {"map",   "channels", "unit", "encoding",
                                          "scale", "offset",   "y"};
    constexpr std::string_view units[] = {"degrees", "turns", "radians", "vector"};
    requireKnown(map, known);
    DirectionReference result{.path = pathOf(map, "map", file),
                              .unit = static_cast<DirectionUnit>(choiceOf(map, "unit", units)),
                              .codes = codesOf(map),
                              .yDown = yDownOf(map)};
    const bool vector = result.unit == DirectionUnit::vector;
    if (map.has("channels")) {
        result.channels = map.words("channels");
        if (result.channels.size() != (vector ? 2 : 1))
            map.fail(vector ? "has to name two channels" : "has to name one channel", "channels");
    }
    if (!vector && map.has("encoding")) map.fail("belongs to a vector", "encoding");
    for (const char* key : {"scale", "offset"})
        if (vector && map.has(key)) map.fail("belongs to an angle", key);
    if (map.has("scale")) result.scale = map.number("scale", -most, most);
    if (map.has("offset")) result.offset = map.number("offset", -most, most);
    return result;
}

MapReference mapOf(const JsonFields& map, bool colour, const std::string& file) {
    constexpr std::string_view known[] = {"map", "channels", "curve", "scale", "offset", "power"};
    requireKnown(map, known);
    MapReference result{.path = pathOf(map, "map", file)};
    if (map.has("channels")) result.channels = map.words("channels");
    const std::size_t count = result.channels.size();
    if (map.has("channels") && count != 1 && !(colour && count == 3))
        map.fail(colour ? "has to name one channel or three" : "has to name one channel",
                 "channels");
    result.curve = curveOf(map);
    constexpr double most = 1e12;
    if (map.has("scale")) result.scale = map.number("scale", -most, most);
    if (map.has("offset")) result.offset = map.number("offset", -most, most);
    if (map.has("power")) result.power = map.number("power", 1e-3, 1e3);
    return result;
}

std::vector<double> valuesOf(const JsonFields& parameters, const Parameter& parameter) {
    const std::string key(parameter.name);
    const nlohmann::json& json = parameters.at(key.c_str());
    std::vector<double> values = json.is_array() ? parameters.numbers(key.c_str())
                                                 : std::vector{parameters.number(key.c_str())};
    const bool colour = parameter.kind == Parameter::Kind::colour;
    if (values.size() != 1 && !(colour && values.size() == 3)) {
        parameters.fail(
            colour ? "has to be a number, three numbers or a map" : "has to be a number or a map",
            key);
    }
    for (const double value : values) {
        if (value < parameter.min || value > parameter.max) {
            parameters.fail(fmt::format("is {:g}; valid: {}", value, validValues(parameter)), key);
        }
    }
    return values;
}

}  // namespace

MaterialDescription readMaterialDescription(const std::string& file) {
    constexpr std::size_t mostBytes = std::size_t{1} << 24;
    const MappedFile mapped(file);
    if (mapped.size() > mostBytes)
        throw InputError(fmt::format("{}: is too large for a description", file));
    const nlohmann::json json = parseJson(
        std::string_view(reinterpret_cast<const char*>(mapped.data()), mapped.size()), file, 8);
    const JsonFields root(json, "", file);
    if (root.word("format") != "hshfit-svbrdf") root.fail("has to be hshfit-svbrdf", "format");
    if (root.integer("version", 1, 1 << 20) != 1) root.fail("has to be 1", "version");
    constexpr std::string_view known[] = {"format",     "version",   "model",
                                          "parameters", "normal",    "direction",
                                          "texels",     "isotropic", "source"};
    requireKnown(root, known);
    if (root.has("texels")) {
        for (const char* key : {"model", "parameters", "normal", "direction"})
            if (root.has(key)) root.fail("does not go with texels", key);
        return {.file = file,
                .model = "measured",
                .texels = pathOf(root, "texels", file),
                .isotropic = root.has("isotropic") && root.flag("isotropic")};
    }
    if (root.has("isotropic")) root.fail("belongs to texels", "isotropic");
    const brdfs::Model& model = modelOf(root);
    MaterialDescription result{.file = file, .model = std::string(model.name)};
    const JsonFields parameters = root.object("parameters");
    for (const auto& [name, value] : parameters.json().items()) {
        const Parameter& parameter = parameterOf(model, name, parameters);
        const bool number =
            parameter.kind == Parameter::Kind::number || parameter.kind == Parameter::Kind::colour;
        if (!number) {
            result.words[name] = value.is_boolean() ? (value.get<bool>() ? "true" : "false")
                                                    : parameters.word(name.c_str());
        } else if (value.is_object()) {
            const bool colour = parameter.kind == Parameter::Kind::colour;
            const JsonFields map = parameters.object(name.c_str());
            result.parameters.push_back({.name = name, .map = mapOf(map, colour, file)});
        } else {
            result.parameters.push_back({.name = name, .values = valuesOf(parameters, parameter)});
        }
    }
    if (root.has("normal")) result.normal = normalOf(root.object("normal"), file);
    if (root.has("direction")) result.direction = directionOf(root, file);
    return result;
}

}  // namespace hshfit::jobs
