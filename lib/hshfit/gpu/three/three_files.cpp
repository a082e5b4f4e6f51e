#include <hshfit/gpu/three/three_files.h>

#include <hshfit/error.h>
#include <hshfit/files/checksum.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/files/printable.h>
#include <hshfit/files/template_text.h>
#include <hshfit/gpu/shader_data.h>
#include <hshfit/gpu/shader_text.h>
#include <hshfit/gpu/three/internal/three_input.h>
#include <hshfit/gpu/viewer_light.h>
#include <hshfit/light/catalog.h>
#include <hshfit/pages/page_figures.h>
#include <hshfit/version.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cctype>
#include <cmath>

namespace hshfit::embedded {
extern const std::string_view three_data, three_fragment, three_light, three_look_ups,
    three_map_setter, three_material, three_nodes, three_package, three_page, three_response,
    three_surface, three_surroundings, three_types, three_vertex;
extern const std::string_view viewer_harmonics;
}  // namespace hshfit::embedded

namespace hshfit::gpu::inline three {
namespace {

using Json = nlohmann::ordered_json;
using kainjow::mustache::data;

/// Bands of the light that comes with materials whose shader looks it up.
constexpr int lookedUpBands = 10;

/// Omitted sections leave blank lines behind; one is kept.
std::string rendered(std::string_view text, const data& page) {
    std::string result = filledText(text, page);
    for (std::size_t at = result.find("\n\n\n"); at != result.npos; at = result.find("\n\n\n", at))
        result.erase(at, 1);
    return result;
}

/// Text of an element of the page.
std::string escaped(const std::string& text) {
    std::string result;
    for (const char c : text) {
        if (c == '<')
            result += "&lt;";
        else if (c == '&')
            result += "&amp;";
        else
            result += c;
    }
    return result;
}

/// Text of a comment of either kind.
std::string remark(const std::string& text) {
    std::string result = commentText(text);
    std::ranges::replace(result, '*', '?');
    return result;
}

std::string packageName(const std::string& name) {
    std::string result;
    for (const char c : name) {
        const auto code = static_cast<unsigned char>(c);
        result += std::isalnum(code) && code < 128 ? static_cast<char>(std::tolower(code)) : '-';
    }
    return "hshfit-" + result;
}

std::string scriptText(const Json& value) {
    return scriptSafe(jsonText(value));
}

int bandsOf(const ThreeInput& input, const ThreeOptions& options) {
    return input.shade ? options.shader.environmentOrder : lookedUpBands;
}

/// The slots l(l+1)+m of those m.
template <class Wanted>
data slotsWhere(int slots, const Wanted& wanted) {
    data rows{data::type::list};
    for (int j = 0; j < slots; ++j) {
        const int l = static_cast<int>(std::sqrt(j + 0.5));
        if (!wanted(j - l * (l + 1))) continue;
        data row;
        row.set("slot", std::to_string(j));
        rows.push_back(row);
    }
    return rows;
}

std::string listed(const std::vector<double>& values) {
    std::string text;
    for (const double value : values) text += (text.empty() ? "" : ", ") + shaderNumber(value);
    return text;
}

/// Numbers in JavaScript, and their type in three.js.
struct ArrayWords {
    const char *array, *type;
};
ArrayWords arrayWords(Number number) {
    if (number == Number::float16) return {"Uint16Array", "HalfFloatType"};
    if (number == Number::unorm8) return {"Uint8Array", "UnsignedByteType"};
    return {"Float32Array", "FloatType"};
}

void setLookUps(const ThreeOptions& options, const std::string& prefix, data& page) {
    const ThreeLookUps& lookUps = options.lookUps;
    std::string upper = prefix;
    for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    page.set("lookUps", lookUps.glsl);
    if (!lookUps.wgsl.empty()) {
        const LookUpNode node = lookUpNode(lookUps.wgsl, prefix);
        page.set("lookUpMain", node.main);
        page.set("lookUpFunctions", node.functions);
    }
    page.set("lightMacro", upper + "_PREFILTERED_LIGHT");
    page.set("along", lookUps.along);
    page.set("levels", std::to_string(lookUps.first.size()));
    page.set("lastLevel", std::to_string(std::max<std::size_t>(1, lookUps.first.size()) - 1));
    page.set("firstBand", listed(lookUps.first));
    page.set("secondBand", listed(lookUps.second));
    const Texels& few = lookUps.texels.front();
    const ArrayWords words = arrayWords(few.number);
    page.set("lookUpArray", words.array);
    page.set("lookUpType", words.type);
    page.set("lookUpWidth", std::to_string(few.width));
    page.set("lookUpHeight", std::to_string(few.height));
    page.set("lookUpBase64", base64(few.bytes));
    page.set("finerLookUpBase64", base64(lookUps.texels.back().bytes));
}

/// The textures and the number of a material that the shader's functions take first: as WGSL
/// declares them, as it passes them on, and as the module names them.
void setOwn(const ThreeInput& input, data& page) {
    std::string declared, called, own;
    const auto add = [&](const char* name, const char* type, const char* value) {
        declared += fmt::format("{}: {}, ", name, type);
        called += fmt::format("{}, ", name);
        own += fmt::format("{}{}: {}", own.empty() ? "" : ", ", name, value);
    };
    constexpr const char *array = "texture_2d_array<f32>", *sampler = "sampler";
    if (input.texels) add("texels", array, "texels");
    if (input.texels && input.filtered) add("texelSampler", sampler, "sampler(texels)");
    if (input.table) {
        add("tableSampler", sampler, "sampler(table)");
        add("table", array, "table");
    }
    if (!input.materials.empty()) add("number", "i32", "number");
    page.set("ownDeclared", declared);
    page.set("ownCalled", called);
    page.set("own", own);
}

/// The words of all templates.
data wordsOf(const ThreeInput& input, const ThreeOptions& options) {
    const int bands = bandsOf(input, options), slots = bands * bands;
    data page;
    page.set("title", remark(input.title));
    page.set("generator", std::string("hshfit ") + version);
    page.set("file", options.name);
    page.set("prefix", input.prefix);
    page.set("sampler", input.prefix + "_coefficients");
    page.set("cosine", input.cosine);
    page.set("shade", input.shade);
    page.set("bands", std::to_string(bands));
    page.set("slots", std::to_string(slots));
    page.set("probeSlots", std::to_string(std::min(slots, 9)));
    page.set("texels", input.texels.has_value());
    page.set("evaluation", input.prefix + (input.materials.empty() ? "_eval" : "_material"));
    page.set("materials", !input.materials.empty());
    page.set("lastMaterial", std::to_string(std::max<std::size_t>(1, input.materials.size()) - 1));
    page.set("table", input.table.has_value());
    page.set("tableSampler", input.prefix + "_basis");
    setOwn(input, page);
    page.set("odd", slotsWhere(slots, [&](int m) { return input.oddSign && m % 2 != 0; }));
    page.set("sines", slotsWhere(slots, [](int m) { return m < 0; }));
    setLookUps(options, input.prefix, page);
    page.set("lookUpScript", rendered(embedded::three_look_ups, page));
    page.set("surfaceScript", rendered(embedded::three_surface, page));
    page.set("mapSetter", rendered(embedded::three_map_setter, page));
    return page;
}

std::string environmentOf(const ThreeInput& input, const ThreeOptions& options) {
    const std::string lookUps = "lookups in the scene's environment, which three.js prefilters";
    if (!input.shade) return lookUps;
    return fmt::format("{}; of coefficients of light {} bands of spherical harmonics", lookUps,
                       options.shader.environmentOrder);
}

Json factsOf(const ThreeInput& input, const ThreeOptions& options) {
    return {{"name", input.title},
            {"form", input.form},
            {"number", input.number},
            {"bytes", input.bytes},
            {"channels", input.channels},
            {"environment", environmentOf(input, options)},
            {"error", options.fitError.empty() ? Json() : Json::parse(options.fitError)}};
}

data textureRow(const char* name, const char* what, const Texels& texels, bool filtered) {
    data row;
    row.set("name", name);
    row.set("remark", what);
    row.set("base64", base64(texels.bytes));
    row.set("width", std::to_string(texels.width));
    row.set("height", std::to_string(texels.height));
    row.set("layers", std::to_string(texels.layers));
    row.set("filter", filtered ? "LinearFilter" : "NearestFilter");
    const ArrayWords words = arrayWords(texels.number);
    row.set("array", words.array);
    row.set("type", words.type);
    return row;
}

std::string dataModule(const ThreeInput& input, const ThreeOptions& options) {
    data page = wordsOf(input, options);
    page.set("facts", jsonText(factsOf(input, options), 2));
    data textures{data::type::list};
    if (input.texels)
        textures.push_back(textureRow("texel", "The texture that the shader reads", *input.texels,
                                      input.filtered));
    if (input.table)
        textures.push_back(textureRow("table", "The functions of the library", *input.table, true));
    page.set("textures", textures);
    page.set("names", jsonText(Json(input.materials), 2));
    const int bands = bandsOf(input, options);
    const ViewerLight light =
        viewerLight(parseLights(std::string(studioKind().name)), std::max(bands, 2), 8);
    std::string numbers;
    for (std::size_t j = 0; j < static_cast<std::size_t>(bands * bands); ++j) {
        for (std::size_t c = 0; c < 3; ++c)
            numbers += fmt::format("{:.7g},{}", light.coefficients.at(c)[j], c == 2 ? "\n  " : " ");
    }
    page.set("studio", numbers);
    page.set("functions",
             std::string(embedded::viewer_harmonics) + std::string(embedded::three_light));
    return rendered(embedded::three_data, page);
}

std::string materialModule(const ThreeInput& input, const ThreeOptions& options) {
    data page = wordsOf(input, options);
    page.set("snippet", input.glsl);
    page.set("fragment", backquoted(rendered(embedded::three_fragment, page)));
    page.set("vertex", rendered(embedded::three_vertex, page));
    return rendered(embedded::three_material, page);
}

std::string nodeModule(const ThreeInput& input, const ThreeOptions& options) {
    data page = wordsOf(input, options);
    page.set("snippet", backquoted(input.wgsl));
    page.set("response", rendered(embedded::three_response, page));
    page.set("surroundings", rendered(embedded::three_surroundings, page));
    return rendered(embedded::three_nodes, page);
}

std::string typesOf(const ThreeInput& input, const ThreeOptions& options, bool nodes) {
    data page = wordsOf(input, options);
    page.set("shader", !nodes);
    page.set("suffix", nodes ? "_webgpu" : "");
    page.set("class", nodes ? "HshfitNodeMaterial" : "HshfitMaterial");
    page.set("base", nodes ? "NodeMaterial" : "ShaderMaterial");
    return rendered(embedded::three_types, page);
}

std::string errorText(const ThreeOptions& options) {
    if (options.fitError.empty()) return "The error was not measured.";
    const Json error = Json::parse(options.fitError);
    if (error.contains("largest")) {
        return fmt::format("The table of the functions changes ln(f + 0.001) by {:.2g} at most.",
                           error["largest"].get<double>());
    }
    if (error.contains("file")) {
        return fmt::format("Mean log error against the source: {:.3g} ({:.3g} in the file).",
                           error["mean_log"].get<double>(), error["file"].get<double>());
    }
    return fmt::format("Error against the source: {:.3g} % (r.m.s.), mean log {:.3g}.",
                       100 * error["total"].get<double>(), error["mean_log"].get<double>());
}

std::string pageText(const ThreeInput& input, const ThreeOptions& options) {
    data page = wordsOf(input, options);
    page.set("title", escaped(input.title));
    page.set("library", escaped(options.library));
    for (const auto& [word, file] : {std::pair{"libraryModule", "/build/three.module.js"},
                                     std::pair{"libraryWebgpu", "/build/three.webgpu.js"},
                                     std::pair{"libraryTsl", "/build/three.tsl.js"},
                                     std::pair{"libraryAddons", "/examples/jsm/"}})
        page.set(word, scriptText(options.library + file));
    page.set("summary", fmt::format("{}, {} numbers, {} bytes", escaped(input.form), input.number,
                                    input.bytes));
    page.set("note", fmt::format("{} Light from all around: {}.", errorText(options),
                                 environmentOf(input, options)));
    return printableLines(rendered(embedded::three_page, page));
}

std::string packageText(const ThreeInput& input, const ThreeOptions& options) {
    data page;
    const auto text = [](const std::string& value) { return jsonText(Json(value)); };
    const std::string file = "./" + options.name + "_three";
    page.set("package", text(packageName(options.name)));
    page.set("description", text(input.title + " as a material for three.js"));
    page.set("types", text(file + ".d.ts"));
    page.set("module", text(file + ".js"));
    page.set("nodeTypes", text(file + "_webgpu.d.ts"));
    page.set("nodes", text(file + "_webgpu.js"));
    return rendered(embedded::three_package, page);
}

std::vector<TextFile> filesOf(const ThreeInput& input, const ThreeOptions& options) {
    checkThree(options.name);
    const std::string file = options.name + "_three";
    return {{file + ".js", materialModule(input, options)},
            {file + ".d.ts", typesOf(input, options, false)},
            {file + "_webgpu.js", nodeModule(input, options)},
            {file + "_webgpu.d.ts", typesOf(input, options, true)},
            {file + "_data.js", dataModule(input, options)},
            {file + ".html", pageText(input, options)},
            {"package.json", packageText(input, options)}};
}

}  // namespace

void checkThree(const std::string& name, std::size_t materials) {
    const auto isPlain = [](unsigned char c) {
        return std::isalnum(c) || c == '_' || c == '-' || c == '.';
    };
    if (name.empty() || !std::ranges::all_of(name, isPlain)) {
        throw UsageError(fmt::format(
            "'{}' as the name of a module; letters, digits, '_', '-' and '.' are safe in imports",
            name));
    }
    constexpr std::size_t most = 2048;
    if (materials > most)
        throw UsageError(fmt::format(
            "a module of three.js holds {} materials at most, and {} has {}: make libraries of "
            "fewer",
            most, name, materials));
}

std::vector<TextFile> threeFiles(const Payload& payload, const ThreeOptions& options) {
    return filesOf(threeInput(payload, options), options);
}

std::vector<TextFile> threeFiles(const FormPayload& payload, const ThreeOptions& options) {
    return filesOf(threeInput(payload, options), options);
}

std::vector<TextFile> threeFiles(const SharedSums& library, const std::vector<std::string>& names,
                                 const ThreeOptions& options) {
    checkThree(options.name, names.size());
    return filesOf(threeInput(library, names, options), options);
}

}  // namespace hshfit::gpu::inline three
