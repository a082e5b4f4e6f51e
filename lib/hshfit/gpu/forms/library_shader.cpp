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

/// The functions as one with a coefficient for each of R, G and B, which are those of `values`.
Representation inColours(const Representation& functions, std::vector<double> values) {
    Representation colours = functions;
    colours.head.channels = Channels::rgb();
    auto& content = std::get<HalfwayArray>(colours.content);
    content.halfway.shape[0] = 3;
    content.halfway.values = std::move(values);
    content.ceilings.assign(3, {});
    return colours;
}

/// Phi_0 + sum_k q_k Phi_k of the three channels of a material.
std::vector<double> ownSums(const SharedSums& sums, std::size_t material) {
    const std::vector<double>& all = sums.functions.as<HalfwayArray>()->halfway.values;
    const std::size_t count = all.size() / sums.functions.head.channels.count();
    const double* const texels = &sums.materials[4 * sums.stride() * material];
    std::vector<double> own;
    for (std::size_t c = 0; c < 3; ++c) {
        own.insert(own.end(), all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count));
        for (std::size_t at = 0; at < sums.parts.size(); ++at) {
            const double q = sums.parts[at].scale * texels[4 * at + c];
            const double* const function = &all[sums.parts[at].function * count];
            for (std::size_t t = 0; t < count; ++t) own[c * count + t] += q * function[t];
        }
    }
    return own;
}

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
    const double unit = text.constants ? std::numbers::log2e : 1;
    text.page.set("topScale", shaderNumber(sums.topStep * unit));
    text.page.set("topFirst", shaderNumber(sums.topFirst * unit));
    text.page.set("shared", sums.folded == 0);
    if (sums.folded > 0) text.page.set("texelBase", "first + ");
    text.page.set("offset", shaderNumber(sums.offset));
    text.page.set("kind", sums.folded > 0
                              ? fmt::format("library: {} materials, each its own sum", sums.count())
                              : fmt::format("library: {} materials over {} functions", sums.count(),
                                            sums.functions.head.channels.count() - 1));
    text.page.set("orders", false);
    text.page.set("numbers", std::to_string(sums.materials.size()));
    text.page.set("bytes", std::to_string(text.payload.texels.bytes.size()));
    text.page.set("channelNames", "R G B");
    text.page.set("formula",
                  sums.folded > 0
                      ? "f = max(exp(min(Phi, top)) - offset, 0), Phi a sum of the material's own"
                      : "f = max(exp(min(Phi_0 + sum_k q_k Phi_k, top)) - offset, 0)");
    text.cost.products += 3 * (sums.parts.size() + 1);
    text.cost.fetches = sums.stride();
}

}  // namespace

SharedSums foldedSums(const SharedSums& sums) {
    SharedSums folded = sums;
    folded.parts.clear();
    folded.materials.clear();
    for (std::size_t m = 0; m < sums.count(); ++m) {
        std::vector<double> own = ownSums(sums, m);
        const Representation colours = inColours(sums.functions, own);
        if (m == 0) {
            folded.functions = colours;
            folded.folded = (halfwayStream(colours).size() + 3) / 4;
        }
        const std::size_t first = folded.materials.size();
        for (const StreamNumber& number : halfwayStream(colours))
            folded.materials.push_back(own[number.value]);
        folded.materials.resize(first + 4 * folded.folded, 0.0);
        const auto top =
            sums.materials.begin() + static_cast<std::ptrdiff_t>(4 * (sums.stride() * (m + 1) - 1));
        folded.materials.insert(folded.materials.end(), top, top + 4);
    }
    return folded;
}

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
                     .constants = sums.folded == 0,
                     .channels = Channels::rgb(),
                     .fill = [&](FormText& text) { fillMaterials(sums, text); }});
}

}  // namespace hshfit::gpu::inline forms
