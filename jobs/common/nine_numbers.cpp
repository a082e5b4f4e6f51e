#include "nine_numbers.h"

#include <hshfit/bases/sh.h>
#include <hshfit/error.h>
#include <hshfit/irradiance/nine_numbers.h>
#include <hshfit/light/coefficient_light.h>
#include <hshfit/light/light_projection.h>
#include <hshfit/light/placement.h>

#include <fmt/format.h>

#include <filesystem>
#include <fstream>

namespace hshfit::jobs {
namespace {

constexpr std::size_t longestText = std::size_t{1} << 16;

std::string textOf(const std::string& path) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) return {};
    std::ifstream file(path, std::ios::binary);
    std::string text(longestText, '\0');
    file.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(file.gcount()));
    return text;
}

}  // namespace

std::optional<LightCoefficients> nineNumbers(const std::string& specification) {
    std::string_view key = ":convention=";
    std::size_t at = specification.rfind(key);
    const bool imported = at == std::string::npos && specification.rfind(":for=") != at;
    if (imported) key = ":for=", at = specification.rfind(key);
    const std::string path = specification.substr(0, at);
    const std::string text = textOf(path);
    std::string name(conventionOfText(text));
    if (at != std::string::npos) name = specification.substr(at + key.size());
    if (name.empty()) return {};
    if (text.empty())
        throw InputError(
            fmt::format("{}: no such file, or an empty one; expected the numbers of "
                        "nine coefficients",
                        path));
    if (text.size() >= longestText)
        throw InputError(fmt::format(
            "{}: is no text of nine coefficients, but longer than {} bytes", path, longestText));
    const auto chosen = selectConventions(name);
    if (chosen.size() != 1)
        throw UsageError(fmt::format("{}{}{} is not one of them", path, key, name));
    const NineRgb nine = radianceFromEngine(*chosen.front(), numbersOfText(text, path), path);
    LightCoefficients light{.basis = "sh", .order = 3};
    for (std::size_t c = 0; c < 3; ++c)
        for (const Rgb& each : nine) light.values.push_back(each[c]);
    Light series = coefficientLight(light, path);
    if (imported) series = turned(std::move(series), -radians(chosen.front()->turn));
    light = projectLight({&series, 1}, *bases::makeSh(3, {}));
    light.source = specification;
    return light;
}

std::vector<Light> lightsOf(const std::vector<std::string>& specifications) {
    std::vector<Light> lights;
    for (const std::string& specification : specifications) {
        if (auto nine = nineNumbers(specification)) {
            lights.emplace_back(coefficientLight(std::move(*nine), specification));
            continue;
        }
        for (Light& light : parseLights(specification).lights) lights.push_back(std::move(light));
    }
    return lights;
}

}  // namespace hshfit::jobs
