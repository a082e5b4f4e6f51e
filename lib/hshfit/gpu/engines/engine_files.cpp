#include <hshfit/gpu/engines/engine_files.h>

#include <hshfit/error.h>
#include <hshfit/files/checksum.h>
#include <hshfit/files/template_text.h>
#include <hshfit/gpu/shader_data.h>
#include <hshfit/gpu/shader_text.h>
#include <hshfit/version.h>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>

namespace hshfit::embedded {
extern const std::string_view engine_babylon, engine_playcanvas, engine_filament, engine_godot,
    engine_unity, engine_unity_graph, engine_unreal;
}  // namespace hshfit::embedded

namespace hshfit::gpu::inline engines {
namespace {

using kainjow::mustache::data;

constexpr EngineFile table[] = {
    {"babylon", "_babylon.js", Language::glslEs, "babylon", true},
    {"playcanvas", "_playcanvas.js", Language::glslEs, "playcanvas", true},
    {"filament", ".mat", Language::glslEs, "filament", false, false},
    {"godot", ".gdshader", Language::glslEs},
    {"godot3", "_godot3.shader", Language::glslEs, {}, false, false},
    {"unity", ".shader", Language::hlsl, "unity"},
    {"unity", "_graph.hlsl", Language::hlsl},
    {"unreal", "_unreal.ush", Language::hlsl},
};

std::string_view templateOf(const EngineFile& row) {
    static const std::map<std::string_view, std::string_view> texts = {
        {"_babylon.js", embedded::engine_babylon}, {"_playcanvas.js", embedded::engine_playcanvas},
        {".gdshader", embedded::engine_godot},     {"_godot3.shader", embedded::engine_godot},
        {".shader", embedded::engine_unity},       {"_graph.hlsl", embedded::engine_unity_graph},
        {"_unreal.ush", embedded::engine_unreal},  {".mat", embedded::engine_filament},
    };
    return texts.at(row.suffix);
}

/// Text of a comment of any language, and of a string.
std::string remark(const std::string& text) {
    std::string result = commentText(text);
    for (char& c : result)
        if (c == '*' || c == '"' || c == '\\' || c == '`' || c == '$') c = '?';
    return result;
}

/// Engines state the precision themselves, and refuse the statement in their own shaders.
std::string withoutPrecision(const std::string& text) {
    std::string result;
    for (std::size_t first = 0; first < text.size();) {
        const std::size_t end = std::min(text.find('\n', first), text.size());
        const std::string line = text.substr(first, end - first);
        first = end + 1;
        if (!line.starts_with("precision ")) result += line + '\n';
    }
    return result;
}

void setTexels(const EngineMaterial& material, data& page) {
    data row;
    const Texels& texels = *material.texels;
    row.set("base64", base64(texels.bytes));
    row.set("width", std::to_string(texels.width));
    row.set("height", std::to_string(texels.height));
    row.set("layers", std::to_string(texels.layers));
    const bool half = texels.number == Number::float16, whole = texels.number == Number::unorm8;
    row.set("half", half);
    row.set("whole", whole);
    row.set("single", !half && !whole);
    row.set("array", half ? "Uint16Array" : whole ? "Uint8Array" : "Float32Array");
    page.set("texels", row);
}

void setLookUps(const EngineMaterial& material, bool script, data& page) {
    data row;
    const std::string text = withoutPrecision(material.lookUps);
    row.set("text", script ? backquoted(text) : text);
    row.set("width", std::to_string(material.lookUpWidth));
    row.set("height", std::to_string(material.lookUpHeight));
    row.set("base64", base64(std::as_bytes(std::span(material.lookUpTexels))));
    row.set("along", material.along);
    row.set("count", std::to_string(material.lookUpTexels.size() / 4));
    std::string numbers;
    for (std::size_t k = 0; k + 3 < material.lookUpTexels.size(); k += 4) {
        const float* texel = material.lookUpTexels.data() + k;
        numbers +=
            fmt::format("        float4({}, {}, {}, {}),\n", shaderNumber(texel[0]),
                        shaderNumber(texel[1]), shaderNumber(texel[2]), shaderNumber(texel[3]));
    }
    row.set("numbers", numbers);
    page.set("lookUps", row);
}

}  // namespace

std::span<const EngineFile> engineFiles() {
    return table;
}

std::string engineFile(const EngineFile& row, const EngineMaterial& material) {
    const auto isPlain = [](unsigned char c) {
        return std::isalnum(c) || c == '_' || c == '-' || c == '.';
    };
    if (material.name.empty() || !std::ranges::all_of(material.name, isPlain)) {
        throw UsageError(fmt::format(
            "'{}' as the name of a material; expected letters, digits, '_', '-' and '.'",
            material.name));
    }
    if (material.texels && !row.textures) {
        throw UsageError(fmt::format(
            "{}{}: this engine's file takes numbers as constants; this material has a texture of "
            "{} layers: project it with the form halfway, of 4096 numbers at most",
            material.name, row.suffix, material.texels->layers));
    }
    std::string upper = material.prefix;
    for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    const std::string snippet = withoutPrecision(material.snippet);
    data page;
    page.set("title", remark(material.title));
    page.set("generator", std::string("hshfit ") + version);
    page.set("file", material.name);
    page.set("prefix", material.prefix);
    page.set("upper", upper);
    page.set("snippet", row.script ? backquoted(snippet) : snippet);
    page.set("cosine", material.cosine);
    page.set("fetched", material.fetched);
    page.set("three", row.target == "godot3");
    if (material.texels) setTexels(material, page);
    if (!material.lookUps.empty()) setLookUps(material, row.script, page);
    std::string result = filledText(templateOf(row), page);
    for (std::size_t at = result.find("\n\n\n"); at != result.npos; at = result.find("\n\n\n", at))
        result.erase(at, 1);
    return result;
}

}  // namespace hshfit::gpu::inline engines
