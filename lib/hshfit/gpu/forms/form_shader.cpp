#include <hshfit/gpu/forms/form_shader.h>

#include <hshfit/error.h>
#include <hshfit/files/template_text.h>
#include <hshfit/gpu/forms/form_table.h>
#include <hshfit/gpu/forms/internal/form_text.h>
#include <hshfit/gpu/language_words.h>
#include <hshfit/gpu/shader_text.h>

#include <fmt/format.h>

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

constexpr std::array storages{std::pair{Storage::automatic, std::string_view("auto")},
                              std::pair{Storage::constants, std::string_view("constants")},
                              std::pair{Storage::block, std::string_view("block")},
                              std::pair{Storage::texture, std::string_view("texture")}};

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

}  // namespace

std::string formText(Language language, const FormPayload& payload, const std::string& prefix,
                     const FormBody& body) {
    data page;
    setLanguageWords(language, prefix, page);
    setChannelWords(body.channels, page);
    page.set("function", "eval");
    page.set("materials", false);
    page.set("table", false);
    setStorage(payload, body.storage, page);
    setHeader(payload, page);
    ShaderCost cost;
    FormText text{payload, body.constants, page, cost};
    body.fill(text);
    page.set("evalFetches", std::to_string(cost.fetches));
    page.set("evalProducts", std::to_string(cost.products));
    setPartials({{"header", embedded::form_header},
                 {"sumsBody", embedded::form_sums},
                 {"evalBody", embedded::form_eval},
                 {"halfwayAxes", embedded::form_halfway_axes},
                 {"formBody", body.body},
                 {"boundedBody", embedded::form_bounded},
                 {"glslFunctions", embedded::form_glsl_functions},
                 {"basisBody", embedded::shader_basis},
                 {"ends", embedded::shader_ends},
                 {"turnBody", embedded::shader_turn}},
                page);
    return rendered(
        textOf(language, {embedded::form_glsl_es, embedded::form_glsl, embedded::form_hlsl,
                          embedded::form_wgsl, embedded::form_metal, embedded::form_osl}),
        page);
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
