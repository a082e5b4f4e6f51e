#include <hshfit/scene/internal/scene_fields.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

namespace hshfit::scene {

void onlyKeys(const JsonFields& fields, const Keys& valid) {
    for (const auto& [key, value] : fields.json().items()) {
        if (std::find(valid.begin(), valid.end(), key) != valid.end()) continue;
        fields.fail(fmt::format("is not known; valid: {}", fmt::join(valid, ", ")),
                    key.substr(0, 40));
    }
}

double numberIn(const JsonFields& fields, const char* key, double low, double high) {
    const double value = fields.number(key);
    if (!(value >= low && value <= high)) {
        fields.fail(fmt::format("is {:g}; it has to be from {:g} to {:g}", value, low, high), key);
    }
    return value;
}
double angle(const JsonFields& fields, const char* key, double low, double high) {
    return radians(numberIn(fields, key, low, high));
}
double angleOr0(const JsonFields& fields, const char* key, double low, double high) {
    return fields.has(key) ? angle(fields, key, low, high) : 0;
}

Rgb colour(const JsonFields& fields, const char* key) {
    Rgb rgb{};
    if (fields.at(key).is_number()) {
        rgb.fill(fields.number(key));
    } else {
        const std::vector<double> values = fields.numbers(key, 3);
        std::copy(values.begin(), values.end(), rgb.begin());
    }
    for (double value : rgb) {
        if (!(value >= 0 && value <= brightest)) {
            fields.fail(fmt::format("holds {:g}; it has to be from 0 to {:g}", value, brightest),
                        key);
        }
    }
    return rgb;
}

[[noreturn]] void failWord(const JsonFields& fields, const char* key, const Keys& valid) {
    fields.fail(
        fmt::format("is '{}'; valid: {}", fields.word(key).substr(0, 40), fmt::join(valid, ", ")),
        key);
}

std::vector<JsonFields> elements(const JsonFields& fields, const char* key) {
    std::vector<JsonFields> result = fields.objects(key);
    if (result.empty()) fields.fail("has to hold at least one", key);
    return result;
}

std::string nameOf(const JsonFields& fields) {
    std::string name = fields.word("name");
    const auto plain = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
               c == '-' || c == '_' || c == '.';
    };
    if (name.empty() || name.size() > 100 || name[0] == '.' || !std::ranges::all_of(name, plain))
        fields.fail("names files: letters, digits, '-', '_' and '.', up to 100", "name");
    return name;
}

std::string placeOf(const std::string& file, const std::string& scene) {
    const std::filesystem::path path = file;
    if (path.is_absolute()) return file;
    return (std::filesystem::path(scene).parent_path() / path).string();
}

}  // namespace hshfit::scene
