#include <hshfit/gpu/shader.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/files/template_text.h>
#include <hshfit/gpu/shader_data.h>
#include <hshfit/gpu/shader_text.h>
#include <hshfit/gpu/slang.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>

namespace hshfit::embedded {
extern const std::string_view shader_basis, shader_clamp, shader_ends, shader_eval, shader_header,
    shader_light, shader_shade, shader_shade_world, shader_turn, shader_uv;
extern const std::string_view shader_glsl, shader_glsl_es, shader_glsl_functions, shader_hlsl,
    shader_metal, shader_osl, shader_wgsl;
}  // namespace hshfit::embedded

namespace hshfit::gpu {
namespace {

using kainjow::mustache::data;
using kainjow::mustache::partial;

constexpr std::array table{
    LanguageEntry{Language::glslEs, "glsl-es", "glsl", "GLSL ES 3.00: WebGL2, OpenGL ES 3"},
    LanguageEntry{Language::glsl, "glsl", "glsl", "GLSL 4.50: OpenGL, Vulkan"},
    LanguageEntry{Language::hlsl, "hlsl", "hlsl", "HLSL, shader model 5 and 6: Direct3D, Vulkan"},
    LanguageEntry{Language::slang, "slang", "slang",
                  "Slang: modules for Falcor and neural shading"},
    LanguageEntry{Language::wgsl, "wgsl", "wgsl", "WGSL: WebGPU"},
    LanguageEntry{Language::metal, "metal", "metal", "Metal Shading Language 2"},
    LanguageEntry{Language::osl, "osl", "osl", "Open Shading Language 1.10; experimental"},
};

constexpr int maxEnvironmentOrder = 16;

/// The names in a language of constructs that the templates share.
struct Words {
    std::string let, let2, let3, let4, var;  ///< begin a declaration
    std::string real, vec2, vec3, vec4;      ///< types, which also construct
    std::string dot = "dot";
    std::string environment = "env";  ///< the array of environment coefficients
    std::string light = "light";      ///< the same in the world
    bool macros = true;               ///< texels are looked up by macros, not functions
    bool flat = false;                ///< a spectral environment is an array of numbers
    std::string_view text = {};       ///< the template
};

Words wordsOf(Language language, const std::string& prefix) {
    Words glsl{.let = "float",
               .let2 = "vec2",
               .let3 = "vec3",
               .let4 = "vec4",
               .var = "float",
               .real = "float",
               .vec2 = "vec2",
               .vec3 = "vec3",
               .vec4 = "vec4"};
    Words hlsl{.let = "float",
               .let2 = "float2",
               .let3 = "float3",
               .let4 = "float4",
               .var = "float",
               .real = "float",
               .vec2 = "float2",
               .vec3 = "float3",
               .vec4 = "float4"};
    switch (language) {
        case Language::glslEs:
            glsl.text = embedded::shader_glsl_es;
            return glsl;
        case Language::glsl:
            glsl.text = embedded::shader_glsl;
            return glsl;
        case Language::hlsl:
        case Language::slang:
            hlsl.text = embedded::shader_hlsl;
            return hlsl;
        case Language::metal:
            hlsl.text = embedded::shader_metal;
            hlsl.environment = "env.sh";
            hlsl.light = "light.sh";
            return hlsl;
        case Language::wgsl:
            return {.let = "let",
                    .let2 = "let",
                    .let3 = "let",
                    .let4 = "let",
                    .var = "var",
                    .real = "f32",
                    .vec2 = "vec2<f32>",
                    .vec3 = "vec3<f32>",
                    .vec4 = "vec4<f32>",
                    .macros = false,
                    .text = embedded::shader_wgsl};
        case Language::osl:
            break;
    }
    const std::string two = prefix + "_Two", four = prefix + "_Four";
    return {.let = "float",
            .let2 = two,
            .let3 = "vector",
            .let4 = four,
            .var = "float",
            .real = "float",
            .vec2 = two,
            .vec3 = "vector",
            .vec4 = four,
            .dot = prefix + "_dot",
            .flat = true,
            .text = embedded::shader_osl};
}

void checkOptions(const ShaderOptions& options) {
    checkPrefix(options.prefix);
    if (options.environmentOrder < 0 || options.environmentOrder > maxEnvironmentOrder) {
        throw UsageError(fmt::format("environment of order {}; it has to be 0 (none) to {}",
                                     options.environmentOrder, maxEnvironmentOrder));
    }
}

void checkPayload(Language language, const Payload& payload) {
    if (language != Language::osl) return;
    if (payload.basisTexels) {
        throw UsageError("OSL evaluates the basis itself: export without basis textures");
    }
    if (isNormalised(payload.coefficients.number)) {
        throw UsageError(
            "OSL reads EXR, which holds no normalised integers: use float16 or float32");
    }
}

}  // namespace

void setMap(const OutgoingSet& set, data& page) {
    page.set("single", set.map == OutgoingSet::Map::direction);
    page.set("elevations", false);
    page.set("parabolic", false);
    if (set.map == OutgoingSet::Map::parabolic) {
        data map;
        map.set("scaleX", shaderNumber((set.width - 2) / (2.0 * set.width)));
        map.set("scaleY", shaderNumber((set.height - 2) / (2.0 * set.height)));
        page.set("parabolic", map);
    } else if (set.map == OutgoingSet::Map::elevations) {
        data map;
        map.set("scale", shaderNumber((set.width - 0.5) / set.width));
        map.set("bias", shaderNumber(0.5 / set.width));
        page.set("elevations", map);
    }
}

namespace {

void setLanguageWords(const Words& words, const std::string& prefix, data& page) {
    page.set("let", words.let);
    page.set("let2", words.let2);
    page.set("let3", words.let3);
    page.set("real", words.real);
    page.set("let4", words.let4);
    page.set("var", words.var);
    page.set("vec2", words.vec2);
    page.set("vec3", words.vec3);
    page.set("vec4", words.vec4);
    page.set("env", words.environment);
    page.set("light", words.light);
    page.set("dot", words.dot);
    std::string upper = prefix;
    for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    page.set("prefix", prefix);
    page.set("PREFIX", upper);
    page.set("texel", words.macros ? upper + "_TEXEL" : prefix + "_texel");
    page.set("basisTexel", words.macros ? upper + "_BASIS_TEXEL" : prefix + "_basisTexel");
}

void setWords(const Words& words, const Payload& payload, const std::string& prefix, data& page) {
    const bool grey = payload.head.channels.kind == Channels::Kind::grey;
    const bool spectral = payload.head.channels.kind == Channels::Kind::spectral;
    page.set("grey", grey);
    page.set("colour", !grey && !spectral);
    page.set("spectral", spectral);
    page.set("coef4", payload.packing == Packing::coef4);
    page.set("rgb", payload.packing == Packing::rgb);
    const std::string values = prefix + "_Values", zero3 = words.vec3 + "(0.0, 0.0, 0.0)";
    page.set("type", spectral ? values : grey ? words.real : words.vec3);
    page.set("zero", grey ? "0.0" : zero3);
    page.set("lightType", spectral ? values : words.vec3);
    page.set("lightZero", zero3);
    page.set("environmentType", !spectral ? words.vec3 : words.flat ? words.real : values);
    page.set("letLight", spectral ? words.let : words.let3);
    setLanguageWords(words, prefix, page);
}

void setHeader(const Payload& payload, int environmentOrder, data& page) {
    page.set("generator", commentText(payload.head.generator));
    page.set("source", sourceComment(payload.head.source));
    page.set("basis", payload.head.basis);
    page.set("order", std::to_string(payload.head.order));
    page.set("functionCount", std::to_string(payload.slots.size()));
    page.set("condonShortley", payload.head.condonShortley);
    page.set("channelCount", std::to_string(payload.head.channels.count()));
    page.set("channelNames", fmt::format("{}", fmt::join(payload.head.channels.names(), " ")));
    page.set("packing", packingName(payload.packing));
    page.set("layers", std::to_string(payload.coefficients.layers));
    page.set("number", numberName(payload.coefficients.number));
    page.set("cosine", payload.head.quantity == Quantity::brdfCosine);
    const auto slots = static_cast<std::size_t>(environmentOrder * environmentOrder);
    page.set("environmentCount", std::to_string(slots));
    page.set("environmentNumbers", std::to_string(slots * payload.head.channels.count()));
}

void setCost(const std::string& name, const ShaderCost& cost, data& page) {
    page.set(name + "Fetches", std::to_string(cost.fetches));
    page.set(name + "Products", std::to_string(cost.products));
}

}  // namespace

void setPartials(data& page) {
    const std::pair<const char*, std::string_view> parts[] = {
        {"header", embedded::shader_header},
        {"ends", embedded::shader_ends},
        {"basisBody", embedded::shader_basis},
        {"turnBody", embedded::shader_turn},
        {"uvBody", embedded::shader_uv},
        {"evalBody", embedded::shader_eval},
        {"clampBody", embedded::shader_clamp},
        {"shadeBody", embedded::shader_shade},
        {"lightBody", embedded::shader_light},
        {"worldBody", embedded::shader_shade_world},
        {"glslFunctions", embedded::shader_glsl_functions},
    };
    for (const auto& [name, text] : parts) {
        // The last newline is dropped, because the line that names a partial has one of its own.
        std::string body(text);
        if (body.ends_with('\n')) body.pop_back();
        page.set(name, data(partial([body] { return body; })));
    }
}

std::string rendered(std::string_view text, const data& page) {
    return withoutGaps(filledText(text, page));
}

std::span<const LanguageEntry> languages() {
    return table;
}

std::string fileText(Language language, const std::string& snippets, std::string_view stem) {
    return language == Language::slang ? slangModule(snippets, stem) : snippets;
}

std::string shaderFileName(const std::string& name, const LanguageEntry& language,
                           const std::string& prefix) {
    const bool es = language.language == Language::glslEs;
    return fmt::format("{}_{}.{}{}", name, prefix, es ? "es." : "", language.extension);
}

void setLanguageWords(Language language, const std::string& prefix, data& page) {
    setLanguageWords(wordsOf(language, prefix), prefix, page);
}

void setWords(Language language, const Payload& payload, const std::string& prefix, data& page) {
    setWords(wordsOf(language, prefix), payload, prefix, page);
}

std::string shaderSource(Language language, const Payload& payload, const ShaderOptions& options) {
    checkOptions(options);
    checkPayload(language, payload);
    const Words words = wordsOf(language, options.prefix);
    const auto basis = bases::make(payload.head.basis, payload.head.order,
                                   {.condonShortley = payload.head.condonShortley});
    data page;
    setWords(words, payload, options.prefix, page);
    setHeader(payload, options.environmentOrder, page);
    setMap(payload.head.outgoing, page);
    ShaderCost eval, shade, world;
    setBasis(payload, *basis, page, eval);
    setEvaluation(payload, page, eval);
    page.set("shade", options.environmentOrder > 0);
    if (options.environmentOrder > 0) {
        setShading(payload, *basis, options.environmentOrder, words.flat, page, shade);
        setFrameTurn(payload, options.environmentOrder, words.flat, page, world);
    }
    setCost("eval", eval, page);
    setCost("shade", shade, page);
    setCost("world", world, page);
    setPartials(page);
    return rendered(words.text, page);
}

}  // namespace hshfit::gpu
