#include <brdfs/preset.h>

#include <brdfs/catalog.h>
#include <hshfit/error.h>

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include <array>

namespace hshfit::embedded {
extern const std::string_view preset_hsh_phong;
extern const std::string_view preset_hsh_ward;
}  // namespace hshfit::embedded

namespace hshfit::brdfs {
namespace {

using Json = nlohmann::json;

std::string stringField(const Json& preset, const char* name, const std::string& where) {
    const auto found = preset.find(name);
    if (found == preset.end() || !found->is_string())
        throw InputError(fmt::format("{}: '{}' has to be a string", where, name));
    return found->get<std::string>();
}

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

Json parseJson(std::string_view text, const std::string& where) {
    try {
        return Json::parse(text);
    } catch (const Json::parse_error& error) {
        throw InputError(fmt::format("{}: not valid JSON (byte {})", where, error.byte));
    } catch (const Json::exception&) {
        throw InputError(fmt::format("{}: not valid JSON (a number too large)", where));
    }
}

}  // namespace

std::span<const Preset> presets() {
    static const std::array table{
        Preset{"hsh-phong", "Phong lobe of the HSH paper, exponent 22", embedded::preset_hsh_phong},
        Preset{"hsh-ward", "anisotropic Ward BRDF of the HSH paper", embedded::preset_hsh_ward},
    };
    return table;
}

PresetContent parsePreset(std::string_view text, const std::string& where) {
    const Json preset = parseJson(text, where);
    if (!preset.is_object() || preset.value("format", Json()) != "hshfit-preset")
        throw InputError(
            fmt::format("{}: not a preset; \"format\" has to be \"hshfit-preset\"", where));
    if (preset.value("version", Json()) != 1)
        throw InputError(fmt::format("{}: \"version\" has to be 1", where));

    PresetContent content;
    content.spec = stringField(preset, "model", where);
    if (content.spec.find(':') != std::string::npos)
        throw InputError(fmt::format("{}: unknown model '{}'", where, content.spec));
    if (preset.contains("source")) content.source = stringField(preset, "source", where);
    const auto parameters = preset.find("parameters");
    if (parameters == preset.end() || !parameters->is_object())
        throw InputError(fmt::format("{}: 'parameters' has to be an object", where));
    char separator = ':';
    for (const auto& [key, value] : parameters->items()) {
        if (key.find_first_of(",=") != std::string::npos)
            throw InputError(fmt::format("{}: '{}' is no name of a parameter", where, key));
        content.spec += fmt::format("{}{}={}", separator, key, specValue(value, key, where));
        separator = ',';
    }
    return content;
}

std::unique_ptr<Brdf> openPreset(std::string_view text, const std::string& where) {
    const PresetContent content = parsePreset(text, where);
    try {
        return openModel(content.spec);
    } catch (const UsageError& error) {
        throw InputError(fmt::format("{}: {}", where, error.what()));
    }
}

}  // namespace hshfit::brdfs
