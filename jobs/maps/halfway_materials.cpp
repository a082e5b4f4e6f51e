#include "halfway_materials.h"

#include <hshfit/coefficient_files/coefficient_formats.h>
#include <hshfit/representation/forms/form.h>

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

namespace hshfit::jobs {
namespace {

constexpr std::size_t mostParts = 16;

/// The texel of each material with the least stated error, the first of equals; none: it has none.
std::vector<std::optional<TexelPlace>> nearestTexels(const MaterialMap& map) {
    std::vector<std::optional<TexelPlace>> nearest(map.sidecar().materials());
    std::vector<unsigned> least(nearest.size(), std::numeric_limits<unsigned>::max());
    for (std::size_t level = 0; level < map.sidecar().levels.size(); ++level) {
        const std::span<const std::byte> bytes = map.level(level);
        const std::size_t width = map.sidecar().levels[level].width;
        const auto pair = [&](std::size_t at) {
            return static_cast<unsigned>(bytes[at]) | static_cast<unsigned>(bytes[at + 1]) << 8U;
        };
        for (std::size_t texel = 0; texel < bytes.size() / 4; ++texel) {
            const unsigned material = pair(4 * texel), error = pair(4 * texel + 2);
            if (material >= least.size() || error >= least[material]) continue;
            least[material] = error;
            nearest[material] = TexelPlace{level, texel % width, texel / width};
        }
    }
    return nearest;
}

/// texts[item], of which each process has its share; then each has all.
void gatherTexts(Processes& processes, std::vector<std::string>& texts) {
    std::vector<std::uint64_t> sizes;
    for (const std::string& text : texts) sizes.push_back(text.size());
    gatherValues(processes, texts.size(), sizes);
    const std::size_t longest = sizes.empty() ? 0 : std::ranges::max(sizes);
    if (processes.count() == 1 || longest == 0) return;
    std::string all(texts.size() * longest, '\0');
    for (std::size_t k = 0; k < texts.size(); ++k)
        std::ranges::copy(texts[k], all.begin() + static_cast<std::ptrdiff_t>(k * longest));
    processes.gather(texts.size(), longest, all.data());
    for (std::size_t k = 0; k < texts.size(); ++k) texts[k] = all.substr(k * longest, sizes[k]);
}

}  // namespace

std::size_t HalfwayMaterials::bytes(std::size_t first, std::size_t last) const {
    std::size_t sum = 0;
    for (std::size_t k = first; k < last; ++k) sum += texts[k].empty() ? 0 : forms[k].bytes();
    return sum;
}

HalfwayMaterials halfwayMaterials(const MaterialMap& map, ParameterMaps& maps,
                                  const HalfwayOrders& orders, Processes& processes,
                                  const Listener& listener) {
    const auto nearest = nearestTexels(map);
    // In turns, since materials of higher levels take longer.
    std::vector<std::size_t> order;
    for (std::size_t process = 0; process < processes.count(); ++process)
        for (std::size_t k = process; k < nearest.size(); k += processes.count())
            order.push_back(k);
    const ItemRange mine = processes.share(order.size());
    std::vector<std::size_t> own;  // places in `order`
    std::vector<TexelPlace> places;
    for (std::size_t i = mine.first; i < mine.last; ++i) {
        if (!nearest[order[i]]) continue;
        own.push_back(i);
        places.push_back(*nearest[order[i]]);
    }
    const std::vector<SpecShares> specs =
        brdfsOfTexels(maps, map.sidecar().levels, places, mostParts);
    std::vector<std::string> texts(order.size());
    const ProgressCall progress = listener.part("halfway");
    Form form;
    form.kind = Representation::Kind::halfway;
    form.halfway = orders;
    form.precision = Precision::half;
    for (std::size_t k = 0; k < own.size(); ++k) {
        const auto brdf = openShares(specs[k]);
        form.reciprocal = brdf->laws().reciprocal;
        Representation material = represent(*brdf, form, {});
        if (specs[k].size() > 1) {
            material.head.source = fmt::format("{}:x={},y={},level={}", map.sidecar().source,
                                               places[k].column, places[k].row, places[k].level);
        }
        texts[own[k]] = representationToJson(material);
        if (progress) progress(k + 1, own.size());
    }
    gatherTexts(processes, texts);
    HalfwayMaterials result{.texts = std::vector<std::string>(order.size())};
    for (std::size_t i = 0; i < order.size(); ++i) result.texts[order[i]] = std::move(texts[i]);
    for (const std::string& text : result.texts)
        result.forms.push_back(text.empty() ? Representation{}
                                            : representationFromJson(text, "material"));
    return result;
}

}  // namespace hshfit::jobs
