#include <hshfit/lighting/lighting_shader.h>

#include <hshfit/bases/basis.h>
#include <hshfit/error.h>
#include <hshfit/files/template_text.h>
#include <hshfit/gpu/language_words.h>
#include <hshfit/gpu/shader_data.h>
#include <hshfit/gpu/shader_text.h>
#include <hshfit/lighting/harmonics.h>
#include <hshfit/lighting/internal/lobe_taps.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

namespace hshfit::embedded {
extern const std::string_view lighting_snippet, lighting_functions, lighting_row, lighting_axes,
    lighting_coefficients, lighting_split_sum, lighting_edge, lighting_ltc, lighting_prefiltered,
    lighting_level;
}  // namespace hshfit::embedded

namespace hshfit::lighting {
namespace {

using gpu::Language;
using kainjow::mustache::data;

constexpr std::array languages{Language::glslEs, Language::glsl, Language::hlsl, Language::slang,
                               Language::wgsl};

/// A model's function, in the order of Kind, the section of the templates that has it, and its line
/// of comment.
struct FunctionRow {
    const char *name, *summary;
};
constexpr std::array functions{
    FunctionRow{"coefficients", "harmonics by elevation against rotated coefficients of light"},
    FunctionRow{"splitSum", "a split sum with its own lobes"},
    FunctionRow{"ltc", "linearly transformed cosines"},
    FunctionRow{"prefiltered", "lookups in an environment that an engine has prefiltered"},
};

const FunctionRow& functionOf(const LightingShader& shader) {
    return functions[static_cast<std::size_t>(shader.kind)];
}

/// Declarations, whose order of type and name differs between the languages.
void setDeclarations(Language language, const LightingShader& shader, data& page) {
    const bool wgsl = language == Language::wgsl;
    const std::string three = gpu::wordOf(page, "vec3");
    const std::pair<const char*, std::string> types[] = {
        {"", "real"}, {"3", "vec3"}, {"4", "vec4"}, {"Int", "int"}};
    for (const auto& [suffix, word] : types) {
        const std::string type = gpu::wordOf(page, word);
        const auto set = [&, end = suffix](const char* key, const std::string& inWgsl,
                                           const std::string& others) {
            page.set(std::string(key) + end, wgsl ? inWgsl : others);
        };
        set("type", "fn", type);
        set("arg", "", type + " ");
        set("is", ": " + type, "");
        set("to", " -> " + type, "");
    }
    const auto array = [&](const char* name, int count) {
        return wgsl ? fmt::format("{}: array<{}, {}>", name, three, count)
                    : fmt::format("{} {}[{}]", three, name, count);
    };
    const char* variable = wgsl ? "var " : "";
    page.set("corners", variable + array("corner", 4));
    page.set("points", variable + array("above", 6));
    const bool coefficients = shader.kind == LightingShader::Kind::coefficients;
    page.set("environment", variable + array("env", shader.order * shader.order));
    page.set("lightArgument",
             coefficients ? array("light", shader.order * shader.order) : array("irradiance", 9));
}

/// Terms with m >= 0, and with m < 0 where lobes are not their own mirror images.
void setTerms(const LightingShader& shader, data& page) {
    data terms{data::type::list}, sines{data::type::list};
    for (int l = 0; l < shader.order; ++l) {
        for (int m = shader.inPlane ? 0 : -l; m <= l; ++m) {
            data term;
            term.set("plus", m < 0    ? (sines.is_empty_list() ? "" : "\n            + ")
                             : l == 0 ? ""
                                      : "\n        + ");
            term.set("column",
                     std::to_string(shader.inPlane ? harmonicTexel(l, m)
                                                   : static_cast<std::size_t>(slotOf(l, m))));
            term.set("slot", std::to_string(slotOf(l, m)));
            (m < 0 ? sines : terms).push_back(term);
        }
    }
    page.set("terms", terms);
    page.set("sines", sines);
}

/// The parts that tables by azimuth and lobes that are not their own mirror images add.
void setAskew(const LightingShader& shader, data& page) {
    const AzimuthNodes& azimuths = shader.azimuths;
    const auto count = static_cast<double>(azimuths.count);
    const bool around = azimuths.count > 1;
    page.set("around", around);
    page.set("folded", azimuths.folded);
    page.set("askew", !shader.inPlane &&
                          (shader.kind != LightingShader::Kind::coefficients || shader.order > 1));
    page.set("materials", shader.materials);
    page.set("place", around ? "cosine, turn" : shader.materials ? "cosine, material" : "cosine");
    page.set("side", azimuths.folded ? "side" : "b");
    page.set("flip", azimuths.folded ? "flip * " : "");
    page.set("azimuths", std::to_string(azimuths.count));
    page.set("height", std::to_string(azimuths.count * shader.rows.count));
    page.set("lastAzimuth", fmt::format("{}.0", azimuths.count - (azimuths.folded ? 2 : 1)));
    page.set("perRadian",
             gpu::shaderNumber(azimuths.folded ? (count - 1) / (pi / 2) : count / (2 * pi)));
    data list{data::type::list};
    if (shader.taps > 0) {
        const LobeTaps taps(shader.taps);
        for (std::size_t k = 0; k < shader.taps; ++k) {
            data tap;
            tap.set("offset", gpu::shaderNumber(taps.offsets[k]));
            tap.set("weight", gpu::shaderNumber(taps.weights[k]));
            list.push_back(tap);
        }
    }
    page.set("taps", list);
}

/// The lookups of a prefiltered environment.
void setLobes(const LightingShader& shader, data& page) {
    data lobes{data::type::list};
    for (std::size_t k = 0; k < shader.lobes; ++k) {
        data lobe;
        lobe.set("k", std::to_string(k + 1));
        lobe.set("lean", fmt::format("lean{}.{}", k / 4, "xyzw"[k % 4]));
        lobe.set("axis", std::to_string(shader.lobes + 1 + k));
        lobes.push_back(lobe);
    }
    page.set("lobes", lobes);
    data leans{data::type::list};
    for (std::size_t k = 0; k < shader.lobes; k += 4) {
        data lean;
        lean.set("k", std::to_string(k / 4));
        lean.set("column", std::to_string(shader.lobes + 1 + k / 4));
        leans.push_back(lean);
    }
    page.set("leans", leans);
    page.set("engine", std::string(shader.engine->name));
    page.set("level", fmt::format(fmt::runtime(shader.engine->formula),
                                  fmt::format("{}.0", shader.engine->levels - 1)));
}

}  // namespace

std::string lightingFunction(const LightingShader& shader) {
    return functionOf(shader).name;
}

std::span<const Language> lightingLanguages() {
    return languages;
}

std::string lightingShaderSource(Language language, const LightingShader& shader) {
    gpu::checkPrefix(shader.prefix);
    if (!std::ranges::count(languages, language))
        throw UsageError("shaders of lighting are in GLSL ES, GLSL, HLSL, Slang and WGSL only");
    const std::string name = shader.prefix + "_" + functionOf(shader).name;
    std::string upper = name;
    for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    data page;
    gpu::setLanguageWords(language, shader.prefix, page);
    setDeclarations(language, shader, page);
    page.set("name", name);
    page.set("NAME", upper);
    const bool wgsl = language == Language::wgsl;
    page.set("texel", wgsl ? name + "_texel" : upper + "_TEXEL");
    page.set("cube", wgsl ? name + "_lookUp" : upper + "_CUBE");
    for (const FunctionRow& row : functions) page.set(row.name, &row == &functionOf(shader));
    const bool prefiltered = shader.kind == LightingShader::Kind::prefiltered;
    page.set("withCube", prefiltered || shader.kind == LightingShader::Kind::splitSum);
    page.set("lookUp", wgsl ? name + "_lookUp" : upper + "_LIGHT");
    page.set("summary", functionOf(shader).summary);
    page.set("generator", gpu::commentText(shader.generator));
    page.set("source", gpu::commentText(shader.source));
    page.set("order", std::to_string(shader.order));
    page.set("levels", std::to_string(prefiltered ? shader.engine->levels : shader.levels));
    page.set("rows", std::to_string(shader.rows.count));
    page.set("texels", std::to_string(shader.texels));
    page.set("last", fmt::format("{}.0", shader.rows.count - 1));
    page.set("span", gpu::shaderNumber(ElevationRows::span()));
    setAskew(shader, page);
    if (prefiltered) setLobes(shader, page);
    if (shader.kind == LightingShader::Kind::coefficients) {
        setTerms(shader, page);
        gpu::setFrameTurn(shader.order, page);
    }
    setPartials({{"functions", embedded::lighting_functions},
                 {"rowBody", embedded::lighting_row},
                 {"axes", embedded::lighting_axes},
                 {"coefficientsBody", embedded::lighting_coefficients},
                 {"splitSumBody", embedded::lighting_split_sum},
                 {"edgeBody", embedded::lighting_edge},
                 {"ltcBody", embedded::lighting_ltc},
                 {"prefilteredBody", embedded::lighting_prefiltered},
                 {"levelBody", embedded::lighting_level}},
                page);
    return gpu::rendered(embedded::lighting_snippet, page);
}

}  // namespace hshfit::lighting
