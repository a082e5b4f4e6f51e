#include <hshfit/gpu/forms/library_shader.h>

#include <hshfit/error.h>
#include <hshfit/gpu/forms/internal/form_rows.h>
#include <hshfit/gpu/forms/internal/form_text.h>
#include <hshfit/gpu/forms/table_text.h>
#include <hshfit/gpu/shader_text.h>

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

namespace hshfit::embedded {
extern const std::string_view form_library, form_library_table;
}  // namespace hshfit::embedded

namespace hshfit::gpu::inline forms {
namespace {

using kainjow::mustache::data;

/// Rows of a texture that every device takes; further materials go into further layers.
constexpr int mostRows = 2048, rowBits = 11;
static_assert(mostRows == 1 << rowBits);

/// A row for each material.
Texels rowsOf(const std::vector<double>& materials, std::size_t stride) {
    const std::size_t count = materials.size() / (4 * stride), most = mostRows;
    const std::size_t rows = std::min(count, most), layers = (count + most - 1) / most;
    std::vector<double> values = materials;
    values.resize(4 * stride * rows * layers, 0.0);
    return encode(values, static_cast<int>(stride), static_cast<int>(rows), layers,
                  Number::float16);
}

void fillConstants(const SharedSums& sums, FormText& text) {
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
    text.page.set("parts", parts);
    text.page.set("last", std::to_string(sums.stride() - 1));
    text.cost.products += 3 * (sums.parts.size() + 1);
    text.cost.fetches = sums.stride();
}

void fillTable(const FunctionTable& table, FormText& text) {
    setTablePlace(table, text.page);
    text.page.set("table", true);
    text.cost.products += tableProducts + 16 * table.groups();
    text.cost.fetches = 1 + 5 * table.groups();
}

void fillMaterials(const SharedSums& sums, FormText& text) {
    if (sums.table)
        fillTable(*sums.table, text);
    else
        fillConstants(sums, text);
    text.page.set("function", "material");
    text.page.set("materials", true);
    text.page.set("place", fmt::format("i, (m) & {}", mostRows - 1));
    text.page.set("layer", fmt::format("(m) >> {}", rowBits));
    const double unit = text.constants ? std::numbers::log2e : 1;
    text.page.set("expOf", text.constants ? "exp2" : "exp");
    text.page.set("topScale", shaderNumber(sums.topStep * unit));
    text.page.set("topFirst", shaderNumber(sums.topFirst * unit));
    text.page.set("offset", shaderNumber(sums.offset));
    text.page.set("kind", fmt::format("library: {} materials over {} functions{}", sums.count(),
                                      sums.functions.head.channels.count() - 1,
                                      sums.table ? " in a table" : ""));
    text.page.set("orders", false);
    text.page.set("numbers", std::to_string(sums.materials.size()));
    text.page.set("bytes", std::to_string(text.payload.texels.bytes.size()));
    text.page.set("channelNames", "R G B");
    text.page.set("formula", "f = max(exp(min(Phi_0 + sum_k q_k Phi_k, top)) - offset, 0)");
}

}  // namespace

SharedSums tabledSums(const SharedSums& sums, const TableSize& size) {
    SharedSums tabled = sums;
    tabled.table = std::make_shared<const FunctionTable>(sums.functions, size);
    std::vector<double> texels(4 * tabled.stride() * sums.count(), 0.0);
    for (std::size_t m = 0; m < sums.count(); ++m) {
        const double* const from = &sums.materials[4 * sums.stride() * m];
        double* const to = &texels[4 * tabled.stride() * m];
        std::size_t last = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            double* const numbers = to + 4 * (1 + c);
            const auto at = [&](std::size_t k) -> double& { return numbers[k / 4 * 12 + k % 4]; };
            to[c] = from[4 * sums.parts.size() + c];
            at(0) = 1;
            for (std::size_t p = 0; p < sums.parts.size(); ++p) {
                const std::size_t k = sums.parts[p].function;
                at(k) += sums.parts[p].scale * from[4 * p + c];
                if (at(k) != 0) last = std::max(last, k);
            }
        }
        to[3] = static_cast<double>(last / 4 + 1);
    }
    tabled.materials = decode(rowsOf(texels, tabled.stride()));
    tabled.materials.resize(texels.size());
    return tabled;
}

Texels materialTexels(const SharedSums& sums) {
    if (sums.further == 0) return rowsOf(sums.materials, sums.stride());
    std::vector<double> all;
    all.reserve(4 * sums.width() * sums.count());
    const auto append = [&](const std::vector<double>& from, std::size_t texels, std::size_t m) {
        const auto first = from.begin() + static_cast<std::ptrdiff_t>(4 * texels * m);
        all.insert(all.end(), first, first + static_cast<std::ptrdiff_t>(4 * texels));
    };
    for (std::size_t m = 0; m < sums.count(); ++m) {
        append(sums.materials, sums.stride(), m);
        append(sums.furtherTexels, sums.further, m);
    }
    return rowsOf(all, sums.width());
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
                    {.body = sums.table ? embedded::form_library_table : embedded::form_library,
                     .storage = Storage::texture,
                     .constants = !sums.table,
                     .channels = Channels::rgb(),
                     .fill = [&](FormText& text) { fillMaterials(sums, text); }});
}

}  // namespace hshfit::gpu::inline forms
