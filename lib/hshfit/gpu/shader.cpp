#include <hshfit/gpu/shader.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/files/template_text.h>
#include <hshfit/gpu/language_words.h>
#include <hshfit/gpu/shader_data.h>
#include <hshfit/gpu/shader_text.h>
#include <hshfit/gpu/slang.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace hshfit::embedded {
extern const std::string_view shader_basis, shader_clamp, shader_ends, shader_eval, shader_header,
    shader_light, shader_shade, shader_shade_world, shader_turn, shader_uv;
extern const std::string_view shader_glsl, shader_glsl_es, shader_glsl_functions, shader_hlsl,
    shader_metal, shader_osl, shader_wgsl;
}  // namespace hshfit::embedded

namespace hshfit::gpu {
namespace {

using kainjow::mustache::data;

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

void setHeader(const Payload& payload, int environmentOrder, data& page) {
    page.set("generator", commentText(payload.head.generator));
    page.set("source", sourceComment(payload.head.source));
    page.set("basis", payload.head.basis);
    page.set("order", std::to_string(payload.head.order));
    page.set("functionCount", std::to_string(payload.slots.size()));
    page.set("condonShortley", payload.head.condonShortley);
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

void setSharedPartials(data& page) {
    setPartials({{"header", embedded::shader_header},
                 {"ends", embedded::shader_ends},
                 {"basisBody", embedded::shader_basis},
                 {"turnBody", embedded::shader_turn},
                 {"uvBody", embedded::shader_uv},
                 {"evalBody", embedded::shader_eval},
                 {"clampBody", embedded::shader_clamp},
                 {"shadeBody", embedded::shader_shade},
                 {"lightBody", embedded::shader_light},
                 {"worldBody", embedded::shader_shade_world},
                 {"glslFunctions", embedded::shader_glsl_functions}},
                page);
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

void setWords(Language language, const Payload& payload, const std::string& prefix, data& page) {
    setLanguageWords(language, prefix, page);
    setChannelWords(payload.head.channels, page);
    const bool spectral = payload.head.channels.kind == Channels::Kind::spectral;
    const std::string values = prefix + "_Values", vector = wordOf(page, "vec3");
    page.set("coef4", payload.packing == Packing::coef4);
    page.set("rgb", payload.packing == Packing::rgb);
    page.set("lightType", spectral ? values : vector);
    page.set("lightZero", vector + "(0.0, 0.0, 0.0)");
    page.set("environmentType", !spectral                   ? vector
                                : language == Language::osl ? wordOf(page, "real")
                                                            : values);
    page.set("letLight", wordOf(page, spectral ? "let" : "let3"));
}

std::string shaderSource(Language language, const Payload& payload, const ShaderOptions& options) {
    checkOptions(options);
    checkPayload(language, payload);
    const auto basis = bases::make(payload.head.basis, payload.head.order,
                                   {.condonShortley = payload.head.condonShortley});
    data page;
    setWords(language, payload, options.prefix, page);
    setHeader(payload, options.environmentOrder, page);
    setMap(payload.head.outgoing, page);
    ShaderCost eval, shade, world;
    setBasis(payload, *basis, page, eval);
    setEvaluation(payload, page, eval);
    page.set("shade", options.environmentOrder > 0);
    if (options.environmentOrder > 0) {
        const bool flat = language == Language::osl;
        setShading(payload, *basis, options.environmentOrder, flat, page, shade);
        setFrameTurn(payload, options.environmentOrder, flat, page, world);
    }
    setCost("eval", eval, page);
    setCost("shade", shade, page);
    setCost("world", world, page);
    setSharedPartials(page);
    return rendered(
        textOf(language, {embedded::shader_glsl_es, embedded::shader_glsl, embedded::shader_hlsl,
                          embedded::shader_wgsl, embedded::shader_metal, embedded::shader_osl}),
        page);
}

}  // namespace hshfit::gpu
