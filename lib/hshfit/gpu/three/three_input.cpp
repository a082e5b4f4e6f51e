#include <hshfit/gpu/three/internal/three_input.h>

#include <hshfit/error.h>
#include <hshfit/gpu/viewer_light.h>
#include <hshfit/wording.h>

#include <fmt/format.h>

namespace hshfit::gpu::inline three {
namespace {

/// WGSL snippets declare texture and sampler for the whole module, where three.js puts its own:
/// here every function that needs them has them as its first arguments; the sampler if `filtered`.
std::string withoutBindings(const std::string& wgsl) {
    std::string text;
    for (std::size_t first = 0; first < wgsl.size();) {
        const std::size_t end = std::min(wgsl.find('\n', first), wgsl.size());
        const std::string line = wgsl.substr(first, end - first);
        first = end + 1;
        if (!line.starts_with("@group(")) text += line + '\n';
    }
    return text;
}

/// Puts arguments before a function's own, where it is declared and where it is called.
void addArguments(const std::string& function, const std::string& declared,
                  const std::string& called, std::string& text) {
    const std::string call = function + "(";
    for (std::size_t at = text.find(call); at != text.npos; at = text.find(call, at)) {
        const bool declaration = at >= 3 && text.compare(at - 3, 3, "fn ") == 0;
        at += call.size();
        text.insert(at, declaration ? declared : called);
    }
}

std::string withArguments(const std::string& wgsl, const std::string& prefix, bool filtered,
                          bool table = false) {
    std::string text = withoutBindings(wgsl);
    std::string declared = prefix + "_coefficients: texture_2d_array<f32>, ",
                called = prefix + "_coefficients, ";
    if (filtered) {
        declared += prefix + "_sampler: sampler, ";
        called += prefix + "_sampler, ";
    }
    if (table) {
        declared += prefix + "_basis: texture_2d_array<f32>, ";
        called += prefix + "_basis, ";
    }
    for (const char* name :
         {"texel", "basisTexel", "evalRaw", "eval", "material", "shade", "shadeWorld"})
        addArguments(fmt::format("{}_{}", prefix, name), declared, called, text);
    return text;
}

void replaceAll(const std::string& from, const std::string& to, std::string& text) {
    for (std::size_t at = text.find(from); at != text.npos; at = text.find(from, at + to.size()))
        text.replace(at, from.size(), to);
}

void refuseSpectral(const CoefficientHead& head) {
    if (head.channels.kind != Channels::Kind::spectral) return;
    throw UsageError(
        fmt::format("{}: a material of three.js is grey or RGB; project the spectral BRDF with {}",
                    head.source, Call{.function = "asRgb"}));
}

void setHead(const CoefficientHead& head, const ThreeOptions& options, ThreeInput& input) {
    input.title = head.source.empty() ? "Material" : shownName(head.source);
    input.generator = head.generator;
    input.prefix = options.shader.prefix;
    input.channels = head.channels.names();
    input.cosine = false;
}

}  // namespace

LookUpNode lookUpNode(const std::string& wgsl, const std::string& prefix) {
    const std::string name = prefix + "_prefiltered";
    std::string text = withoutBindings(wgsl);
    const std::string table = "table: texture_2d<f32>, ",
                      light =
                          "cube: texture_cube<f32>, cubeSampler: sampler, cubeTurn: mat3x3<f32>, "
                          "cubeLevels: f32, cubeIntensity: f32, even: vec3<f32>, ";
    // The engine's own number of levels, its turn, and even light beside it.
    replaceAll(
        fmt::format("textureSampleLevel({0}_cube, {0}_sampler, direction, {0}_level(roughness))",
                    name),
        "cubeIntensity * textureSampleLevel(cube, cubeSampler, cubeTurn * direction, "
        "cubeLevels * roughness * (2.0 - roughness)) + vec4<f32>(even, 0.0)",
        text);
    replaceAll(name + "_table", "table", text);
    addArguments(name + "_lookUp", light,
                 "cube, cubeSampler, cubeTurn, cubeLevels, cubeIntensity, even, ", text);
    for (const char* part : {"_texel", "_at"}) addArguments(name + part, table, "table, ", text);
    addArguments(name, table + light, "", text);
    const std::size_t main = text.find("fn " + name + "(");
    return {.main = text.substr(main), .functions = text.substr(0, main)};
}

ThreeInput threeInput(const Payload& given, const ThreeOptions& options) {
    refuseSpectral(given.head);
    Payload payload = given;
    payload.basisTexels.reset();
    payload.head.source = shownName(payload.head.source);
    ThreeInput input;
    setHead(payload.head, options, input);
    input.form = fmt::format("{} order {} over outgoing directions {}", payload.head.basis,
                             payload.head.order, payload.head.outgoing.spec());
    input.number = numberName(payload.coefficients.number);
    input.bytes = payload.coefficients.bytes.size();
    input.cosine = payload.head.quantity == Quantity::brdfCosine;
    input.shade = options.shader.environmentOrder > 0;
    input.oddSign = payload.head.condonShortley;
    input.glsl = shaderSource(Language::glslEs, payload, options.shader);
    input.wgsl =
        withArguments(shaderSource(Language::wgsl, payload, options.shader), input.prefix, true);
    input.texels = samplerTexels(payload.coefficients);
    return input;
}

ThreeInput threeInput(const FormPayload& given, const ThreeOptions& options) {
    refuseSpectral(given.form.head);
    FormPayload payload = given;
    payload.form.head.source = shownName(payload.form.head.source);
    ThreeInput input;
    setHead(payload.form.head, options, input);
    const Representation& form = payload.form;
    input.form = form.kind() == Representation::Kind::halfway
                     ? fmt::format("halfway {},{},{}", form.halfway.half, form.halfway.difference,
                                   form.halfway.azimuth)
                     : fmt::format("{} {} order {}", kindName(form.kind()), form.head.basis,
                                   form.head.order);
    input.number = numberName(payload.texels.number);
    input.bytes = form.bytes();
    FormShaderOptions shader{.prefix = input.prefix,
                             .storage = storageFor(payload, options.storage)};
    if (shader.storage == Storage::block) shader.storage = Storage::texture;
    input.glsl = formShaderSource(Language::glslEs, payload, shader);
    input.wgsl = formShaderSource(Language::wgsl, payload, shader);
    input.filtered = false;
    if (shader.storage == Storage::texture) {
        input.wgsl = withArguments(input.wgsl, input.prefix, false);
        input.texels = samplerTexels(payload.texels);
    }
    return input;
}

ThreeInput threeInput(const SharedSums& library, const std::vector<std::string>& names,
                      const ThreeOptions& options) {
    ThreeInput input;
    input.title = options.name;
    input.prefix = options.shader.prefix;
    input.channels = Channels::rgb().names();
    input.materials = names;
    input.form = fmt::format("{} materials over {} functions{}", names.size(),
                             library.functions.head.channels.count() - 1,
                             library.table ? " in a table" : "");
    input.texels = materialTexels(library);
    input.number = numberName(input.texels->number);
    input.bytes = input.texels->bytes.size();
    input.filtered = false;
    if (library.table) {
        input.table = library.table->texels();
        input.bytes += input.table->bytes.size();
    }
    input.glsl = libraryShaderSource(Language::glslEs, library, input.prefix);
    input.wgsl = withArguments(libraryShaderSource(Language::wgsl, library, input.prefix),
                               input.prefix, library.table != nullptr, library.table != nullptr);
    return input;
}

}  // namespace hshfit::gpu::inline three
