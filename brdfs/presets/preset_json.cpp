#include <brdfs/presets/preset_json.h>

#include <hshfit/error.h>

#include <fmt/format.h>

#include <limits>

namespace hshfit::brdfs {
namespace {

/// A parameter value as it is written in a specification.
std::string specValue(const Json& value, const std::string& key, const std::string& where) {
    if (value.is_number()) return fmt::format("{}", value.get<double>());
    if (value.is_boolean()) return value.get<bool>() ? "true" : "false";
    if (value.is_string()) {
        const std::string text = value.get<std::string>();
        if (text.find_first_of(",=") == std::string::npos && !text.empty()) return text;
    }
    if (value.is_array() && value.size() == 3 && value[0].is_number() && value[1].is_number() &&
        value[2].is_number())
        return fmt::format("{}/{}/{}", value[0].get<double>(), value[1].get<double>(),
                           value[2].get<double>());
    throw InputError(fmt::format(
        "{}: parameter '{}' has to be a number, an array of three numbers, true, false or a word",
        where, key));
}

constexpr int deepest = std::numeric_limits<int>::max();  // the sizes of presets are bounded

}  // namespace

Json parsePresetJson(std::string_view text, const std::string& format, const std::string& where) {
    Json json = parseJson(text, where, deepest);
    if (!json.is_object() || json.value("format", Json()) != format)
        throw InputError(
            fmt::format("{}: not a preset; \"format\" has to be \"{}\"", where, format));
    if (json.value("version", Json()) != 1)
        throw InputError(fmt::format("{}: \"version\" has to be 1", where));
    return json;
}

std::string modelField(const JsonFields& preset) {
    const std::string model = preset.word("model");
    if (model.find(':') != std::string::npos)
        preset.fail(fmt::format("is the unknown model '{}'", model), "model");
    return model;
}

std::string presetSpec(const std::string& model, const Json& parameters, const std::string& where) {
    std::string spec = model;
    char separator = ':';
    for (const auto& [key, value] : parameters.items()) {
        if (key.find_first_of(",=") != std::string::npos)
            throw InputError(fmt::format("{}: '{}' is no name of a parameter", where, key));
        spec += fmt::format("{}{}={}", separator, key, specValue(value, key, where));
        separator = ',';
    }
    return spec;
}

}  // namespace hshfit::brdfs
