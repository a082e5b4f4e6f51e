#include "wording.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <string>
#include <string_view>

namespace hshfit::python {
namespace {

/// "nonNegative" as "non_negative".
std::string snakeCase(std::string_view name) {
    std::string text;
    for (const char c : name) {
        const auto letter = static_cast<unsigned char>(c);
        if (std::isupper(letter) != 0) text += '_';
        text += static_cast<char>(std::tolower(letter));
    }
    return text;
}

/// Members whose argument has another name.
struct Renamed {
    std::string_view member, argument;
};
constexpr Renamed renamed[] = {
    {"Form::kind", "form"},
    {"FileSet::force", "force"},
    {"ProjectionOptions::quantity", "cosine"},
    {"Form::quantity", "cosine"},
    {"output", "path"},
};

std::string argumentOf(std::string_view member) {
    const auto* row = std::ranges::find(renamed, member, &Renamed::member);
    if (row != std::end(renamed)) return std::string(row->argument);
    const std::size_t colons = member.rfind("::");
    return snakeCase(colons == std::string_view::npos ? member : member.substr(colons + 2));
}

bool isNumber(const std::string& text) {
    double value = 0;
    const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
    return read.ec == std::errc() && read.ptr == text.data() + text.size();
}

std::string quoted(const std::string& text) {
    std::string out = "'";
    for (const char c : text) {
        if (c == '\'' || c == '\\') out += '\\';
        out += c;
    }
    return out + "'";
}

std::string settingOf(const Setting& setting) {
    const std::string argument = argumentOf(setting.member);
    if (argument == "cosine" || setting.value == "true") return argument + "=True";
    if (setting.value == "false") return argument + "=False";
    if (setting.value.empty()) return argument;
    return argument + "=" + (isNumber(setting.value) ? setting.value : quoted(setting.value));
}

/// Functions of the library and their names in Python.
struct Function {
    std::string_view name, python;
};
constexpr Function functions[] = {
    {"represent", "project"},
    {"writeRepresentation", "project"},
    {"exportCoefficients", "export"},
    {"fit", "fit"},
    {"formats", "catalog('formats')"},
    {"writers", "catalog('writers')"},
    {"metricCatalog", "catalog('metrics')"},
    {"asRgb", "open(…, rgb=True)"},
    {"learn", "Library.learn"},
    {"linearlyTransformedCosines", "the command ltc of the program"},
};

std::string callOf(const Call& call) {
    const auto* row = std::ranges::find(functions, call.function, &Function::name);
    if (row == std::end(functions)) return asFunction(call);
    if (row->python.find(' ') != std::string_view::npos && call.function != "asRgb")
        return std::string(row->python);
    std::string text = "hshfit." + std::string(row->python);
    if (text.ends_with(')')) return text;
    std::string arguments;
    const auto add = [&](const std::string& argument) {
        arguments += (arguments.empty() ? "" : ", ") + argument;
    };
    if (!call.subject.empty()) add(quoted(call.subject));
    for (const Setting& setting : call.settings) add(settingOf(setting));
    if (call.function == "fit" && call.settings.empty()) add("model='ggx'");
    return text + "(" + arguments + ")";
}

}  // namespace

Wording pythonWording() {
    return {.setting = settingOf, .call = callOf};
}

}  // namespace hshfit::python
