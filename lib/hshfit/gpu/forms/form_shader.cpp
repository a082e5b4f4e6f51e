#include <hshfit/gpu/forms/form_shader.h>

#include <hshfit/error.h>
#include <hshfit/files/template_text.h>
#include <hshfit/gpu/forms/form_table.h>
#include <hshfit/gpu/forms/internal/form_text.h>
#include <hshfit/gpu/shader_text.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

namespace hshfit::embedded {
extern const std::string_view shader_basis, shader_ends, shader_turn;
extern const std::string_view form_bounded, form_eval, form_glsl, form_glsl_es, form_glsl_functions,
    form_halfway_axes, form_header, form_hlsl, form_metal, form_osl, form_sums, form_wgsl;
}  // namespace hshfit::embedded

namespace hshfit::gpu::inline forms {
namespace {

using kainjow::mustache::data;
using kainjow::mustache::partial;

constexpr std::array storages{std::pair{Storage::automatic, std::string_view("auto")},
                              std::pair{Storage::constants, std::string_view("constants")},
                              std::pair{Storage::block, std::string_view("block")},
                              std::pair{Storage::texture, std::string_view("texture")}};

/// The words that forms need of a language beyond setLanguageWords: its template, a declaration of
/// a whole number, a conversion to one, a declaration of a vector that changes, and a vector of
/// whole numbers.
struct FormLanguage {
    std::string_view text, letInt, toInt, varVector, words3;
};
FormLanguage formLanguage(Language language) {
    switch (language) {
        case Language::glslEs:
            return {embedded::form_glsl_es, "int", "int", "vec3", "uvec3"};
        case Language::glsl:
            return {embedded::form_glsl, "int", "int", "vec3", "uvec3"};
        case Language::hlsl:
        case Language::slang:
            return {embedded::form_hlsl, "int", "int", "float3", "uint3"};
        case Language::metal:
            return {embedded::form_metal, "int", "int", "float3", "uint3"};
        case Language::wgsl:
            return {embedded::form_wgsl, "let", "i32", "var", "vec3<u32>"};
        case Language::osl:
            break;
    }
    return {embedded::form_osl, "int", "(int)", "vector", ""};
}

void checkLanguage(Language language, const FormPayload& payload, Storage storage) {
    if (language != Language::osl) return;
    if (storage == Storage::block)
        throw UsageError("OSL has no uniform blocks: store the form as constants or as a texture");
    if (storage == Storage::texture && isNormalised(payload.texels.number)) {
        throw UsageError(
            "OSL reads EXR, which holds no normalised integers: use float16 or float32");
    }
}

/// 16 KiB are what the smallest uniform block that every API promises has.
void checkBlock(const FormPayload& payload, Storage storage) {
    constexpr std::size_t most = mostConstants * 4;
    const std::size_t bytes = 16 * payload.texelCount();
    if (storage != Storage::block || bytes <= most) return;
    throw UsageError(
        fmt::format("a uniform block of {} bytes; every device takes {}: store the form as a "
                    "texture or ask for fewer numbers",
                    bytes, most));
}

void setStorage(const FormPayload& payload, Storage storage, data& page) {
    for (const auto& [each, name] : storages) page.set(std::string(name), each == storage);
    page.set("place", fmt::format("(i) % {0}, (i) / {0}", payload.texels.width));
    page.set("layer", "0");
    page.set("width", std::to_string(payload.texels.width));
    page.set("height", std::to_string(payload.texels.height));
    page.set("texels", std::to_string(payload.texelCount()));
    page.set("bare", storage == Storage::constants);
    page.set("bound", storage != Storage::constants);
}

void setChannels(const Channels& channels, const std::string& prefix, Language language,
                 data& page) {
    const bool grey = channels.kind == Channels::Kind::grey;
    const bool spectral = channels.kind == Channels::Kind::spectral;
    page.set("grey", grey);
    page.set("colour", !grey && !spectral);
    page.set("spectral", spectral);
    page.set("channelCount", std::to_string(channels.count()));
    page.set("channelNames", fmt::format("{}", fmt::join(channels.names(), " ")));
    const std::string vector =
        language == Language::wgsl ? "vec3<f32>" : std::string(formLanguage(language).varVector);
    const std::string real = language == Language::wgsl ? "f32" : "float";
    page.set("type", spectral ? prefix + "_Values" : grey ? real : vector);
    page.set("zero", grey ? "0.0" : vector + "(0.0, 0.0, 0.0)");
}

void setHeader(const FormPayload& payload, data& page) {
    const Representation& form = payload.form;
    page.set("generator", commentText(form.head.generator));
    page.set("source", sourceComment(form.head.source));
    page.set("kind", std::string(kindName(form.kind())));
    page.set("orders", fmt::format("{} {}", form.head.basis, form.head.order));
    if (form.kind() == Representation::Kind::halfway) {
        page.set("orders", fmt::format("{},{},{}", form.halfway.half, form.halfway.difference,
                                       form.halfway.azimuth));
    }
    page.set("numbers", std::to_string(form.numbers()));
    page.set("bytes", std::to_string(form.bytes()));
    page.set("number", numberName(payload.texels.number));
    page.set("formula", std::string(formulaOf(form)));
    page.set("added", form.added.empty() ? data(false) : data(commentText(form.added)));
}

void setPartials(std::string_view body, data& page) {
    const std::pair<const char*, std::string_view> parts[] = {
        {"header", embedded::form_header},
        {"sumsBody", embedded::form_sums},
        {"evalBody", embedded::form_eval},
        {"halfwayAxes", embedded::form_halfway_axes},
        {"formBody", body},
        {"boundedBody", embedded::form_bounded},
        {"glslFunctions", embedded::form_glsl_functions},
        {"basisBody", embedded::shader_basis},
        {"ends", embedded::shader_ends},
        {"turnBody", embedded::shader_turn},
    };
    for (const auto& [name, text] : parts) {
        // The last newline is dropped, because the line that names a partial has one of its own.
        std::string part(text);
        if (part.ends_with('\n')) part.pop_back();
        page.set(name, data(partial([part] { return part; })));
    }
}

}  // namespace

std::string formText(Language language, const FormPayload& payload, const std::string& prefix,
                     const FormBody& body) {
    const FormLanguage words = formLanguage(language);
    data page;
    setLanguageWords(language, prefix, page);
    page.set("letInt", std::string(words.letInt));
    page.set("varInt", language == Language::wgsl ? "var" : "int");
    page.set("toInt", std::string(words.toInt));
    page.set("varVector", std::string(words.varVector));
    page.set("words3", std::string(words.words3));
    page.set("flat", language == Language::osl);
    page.set("function", "eval");
    page.set("materials", false);
    page.set("table", false);
    setStorage(payload, body.storage, page);
    setChannels(body.channels, prefix, language, page);
    setHeader(payload, page);
    ShaderCost cost;
    FormText text{payload, body.constants, page, cost};
    body.fill(text);
    page.set("evalFetches", std::to_string(cost.fetches));
    page.set("evalProducts", std::to_string(cost.products));
    setPartials(body.body, page);
    return withoutGaps(filledText(words.text, page));
}

std::string_view storageName(Storage storage) {
    return std::ranges::find(storages, storage, &decltype(storages)::value_type::first)->second;
}

Storage parseStorage(std::string_view name) {
    for (const auto& [storage, known] : storages) {
        if (known == name) return storage;
    }
    throw UsageError(
        fmt::format("'{}' is no storage; known: auto, constants, block, texture", name));
}

Storage storageFor(const FormPayload& payload, Storage asked) {
    if (asked != Storage::automatic) return asked;
    return payload.stream.size() > mostConstants ? Storage::texture : Storage::constants;
}

std::string formShaderSource(Language language, const FormPayload& payload,
                             const FormShaderOptions& options) {
    checkPrefix(options.prefix);
    const Storage storage = storageFor(payload, options.storage);
    checkLanguage(language, payload, storage);
    checkBlock(payload, storage);
    if (!payload.form.added.empty() && payload.constant.empty()) {
        throw UsageError(fmt::format("the form adds {}, which has no closed form in shaders",
                                     payload.form.added));
    }
    const FormRow& row = formRow(payload.form.kind());
    return formText(language, payload, options.prefix,
                    {.body = row.body,
                     .storage = storage,
                     .constants = storage == Storage::constants,
                     .channels = payload.form.head.channels,
                     .fill = row.fill});
}

}  // namespace hshfit::gpu::inline forms
