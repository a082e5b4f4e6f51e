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

MapReference mapOf(const JsonFields& map, bool colour, const std::string& file) {
    constexpr std::string_view known[] = {"map", "channels", "curve", "scale", "offset", "power"};
    for (const auto& [key, value] : map.json().items()) {
        if (std::ranges::find(known, key) == std::end(known))
            map.fail(fmt::format("unknown; known: {}", joined(known)), key);
    }
    MapReference result{.path =
                            (std::filesystem::path(file).parent_path() / map.word("map")).string()};
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
    constexpr std::string_view known[] = {"format", "version", "model", "parameters", "source"};
    for (const auto& [key, value] : json.items()) {
        if (std::ranges::find(known, key) == std::end(known))
            root.fail(fmt::format("unknown; known: {}", joined(known)), key);
    }
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
    return result;
}

}  // namespace hshfit::jobs
