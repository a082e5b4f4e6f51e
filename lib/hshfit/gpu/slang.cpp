#include <hshfit/gpu/slang.h>

#include <hshfit/error.h>
#include <hshfit/gpu/shader_text.h>

#include <fmt/format.h>

#include <algorithm>
#include <regex>
#include <stdexcept>
#include <vector>

namespace hshfit::gpu {
namespace {

std::vector<std::string> linesOf(const std::string& text) {
    std::vector<std::string> lines;
    for (std::size_t first = 0; first < text.size();) {
        const std::size_t end = std::min(text.find('\n', first), text.size());
        lines.push_back(text.substr(first, end - first));
        first = end + 1;
    }
    return lines;
}

/// The lines `#ifndef X`, `#define X t0`, `#endif` go, and the places that use X.
std::vector<std::string> withoutRegisters(const std::vector<std::string>& lines) {
    static const std::regex number(R"(#define \w+ [tsb]\d+)"), place(R"( : register\(\w+\))");
    std::vector<std::string> kept;
    for (std::size_t k = 0; k < lines.size(); ++k) {
        if (k + 2 < lines.size() && lines[k].starts_with("#ifndef ") &&
            std::regex_match(lines[k + 1], number) && lines[k + 2] == "#endif") {
            k += 2;
            continue;
        }
        kept.push_back(std::regex_replace(lines[k], place, ""));
    }
    return kept;
}

/// The comment from "HLSL, shader model" to the blank line after it becomes the comment of the
/// module.
std::vector<std::string> withModule(const std::vector<std::string>& lines, std::string_view name) {
    const auto first = std::ranges::find_if(
        lines, [](const std::string& line) { return line.starts_with("// HLSL, shader model"); });
    if (first == lines.end()) throw std::logic_error("no snippet of HLSL");
    const auto last = std::find(first, lines.end(), "");
    std::vector<std::string> result(lines.begin(), first);
    result.push_back(
        fmt::format("// Slang: import \"{}\". Textures and samplers, if there are any, "
                    "are bound by their names.",
                    name));
    result.push_back("");
    result.push_back(fmt::format("module \"{}\";", name));
    result.insert(result.end(), last, lines.end());
    return result;
}

/// Whether any function reads textures or a block.
bool isBound(const std::vector<std::string>& lines) {
    return std::ranges::any_of(lines, [](const std::string& line) {
        const bool code = !line.starts_with("//");
        return code && (line.find("Texture") != line.npos || line.starts_with("cbuffer "));
    });
}

/// The name is a string literal.
void requireName(std::string_view name) {
    const bool fits = std::ranges::none_of(
        name, [](char c) { return c == '"' || c == '\\' || static_cast<unsigned char>(c) < 32; });
    if (!fits)
        throw UsageError(fmt::format(
            "'{}' cannot be the name of a Slang module; expected one without quotes and "
            "backslashes",
            commentText(std::string(name))));
}

/// The beginning of a function at the margin: its result and its name.
bool beginsFunction(const std::string& line, std::smatch& found) {
    static const std::regex function(R"((\w+) (\w+)\(.*\) \{)");
    return std::regex_match(line, found, function);
}

}  // namespace

std::string slangModule(const std::string& hlsl, std::string_view name) {
    static const std::regex structure(R"(struct (\w+) \{ (.*)\};)"), step(R"(\bstep\()"),
        member(R"(\w+ [^;]+;)");
    requireName(name);
    const std::vector<std::string> lines = withModule(withoutRegisters(linesOf(hlsl)), name);
    const bool bound = isBound(lines);
    std::string text;
    bool differentiable = false;
    for (std::string line : lines) {
        std::smatch found;
        if (beginsFunction(line, found)) {
            const std::string result = found[1], called = found[2];
            differentiable =
                !bound && called.ends_with("_eval") && (result == "float" || result == "float3");
            if (differentiable) text += "[Differentiable]\n";
            line.insert(0, "public ");
        } else if (std::regex_match(line, found, structure)) {
            line = fmt::format("public struct {} {{ {}}};", found[1].str(),
                               std::regex_replace(found[2].str(), member, "public $&"));
        } else if (line.starts_with("Texture") || line.starts_with("SamplerState ")) {
            line.insert(0, "public ");
        } else if (line == "}") {
            differentiable = false;
        }
        if (differentiable) line = std::regex_replace(line, step, "no_diff step(");
        text += line + "\n";
    }
    return text;
}

}  // namespace hshfit::gpu
