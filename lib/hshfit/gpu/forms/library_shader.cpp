#include <hshfit/gpu/forms/library_shader.h>

#include <hshfit/error.h>
#include <hshfit/gpu/forms/internal/form_rows.h>
#include <hshfit/gpu/forms/internal/form_text.h>
#include <hshfit/gpu/shader_text.h>

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

namespace hshfit::embedded {
extern const std::string_view form_library;
}  // namespace hshfit::embedded

namespace hshfit::gpu::inline forms {
namespace {

using kainjow::mustache::data;

void fillMaterials(const SharedSums& sums, FormText& text) {
    fillHalfway(text);
    data parts{data::type::list};
    for (std::size_t at = 0; at < sums.parts.size(); ++at) {
        const auto& [function, scale] = sums.parts[at];
        data row;
        row.set("k", std::to_string(function));
        row.set("at", std::to_string(at));
        row.set("scale", scale == 1 ? data(false) : data(shaderNumber(scale)));
        parts.push_back(row);
    }
    text.page.set("function", "material");
    text.page.set("materials", true);
    text.page.set("parts", parts);
    text.page.set("stride", std::to_string(sums.stride()));
    text.page.set("last", std::to_string(sums.stride() - 1));
    text.page.set("topScale", shaderNumber(sums.topStep * std::numbers::log2e));
    text.page.set("topFirst", shaderNumber(sums.topFirst * std::numbers::log2e));
    text.page.set("offset", shaderNumber(sums.offset));
    text.page.set("kind", fmt::format("library: {} materials over {} functions", sums.count(),
                                      sums.functions.head.channels.count() - 1));
    text.page.set("orders", false);
    text.page.set("numbers", std::to_string(sums.materials.size()));
    text.page.set("bytes", std::to_string(text.payload.texels.bytes.size()));
    text.page.set("channelNames", "R G B");
    text.page.set("formula", "f = max(exp(min(Phi_0 + sum_k q_k Phi_k, top)) - offset, 0)");
    text.cost.products += 3 * sums.stride();
    text.cost.fetches = sums.stride();
}

}  // namespace

Texels materialTexels(const SharedSums& sums) {
    const std::size_t texels = sums.materials.size() / 4, width = formWidth;
    const std::size_t height = std::max<std::size_t>(1, (texels + width - 1) / width);
    std::vector<double> values = sums.materials;
    values.resize(4 * width * height, 0.0);
    return encode(values, formWidth, static_cast<int>(height), 1, Number::float16);
}

std::string libraryShaderSource(Language language, const SharedSums& sums,
                                const std::string& prefix) {
    checkPrefix(prefix);
    if (language == Language::osl)
        throw UsageError(
            "OSL reads no texture by whole numbers, so that a library has no shader in it: export "
            "its materials one by one");
    FormPayload payload{.form = sums.functions,
                        .stream = halfwayStream(sums.functions),
                        .texels = materialTexels(sums)};
    return formText(language, payload, prefix,
                    {.body = embedded::form_library,
                     .storage = Storage::texture,
                     .constants = true,
                     .channels = Channels::rgb(),
                     .fill = [&](FormText& text) { fillMaterials(sums, text); }});
}

}  // namespace hshfit::gpu::inline forms
