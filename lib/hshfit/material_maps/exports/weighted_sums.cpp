#include <hshfit/material_maps/exports/internal/weighted_sums.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

namespace hshfit::inline material_maps::inline exports {

using kainjow::mustache::data;

namespace {

/// The sums that the lanes of a group belong to.
data dotsOf(const WeightedSums& sums, std::size_t group, const std::string& factor,
            gpu::ShaderCost& cost) {
    data dots = gpu::list();
    const std::size_t first = 4 * group, last = std::min(first + 4, sums.outs * sums.ins);
    for (std::size_t out = first / sums.ins; out * sums.ins < last; ++out) {
        for (const std::size_t colour : sums.coloursOf(out)) {
            std::vector<std::string> lanes(4, "0.0");
            for (std::size_t lane = std::max(first, out * sums.ins);
                 lane < std::min(last, (out + 1) * sums.ins); ++lane)
                lanes[lane - first] = sums.from(lane - out * sums.ins, colour);
            if (std::ranges::all_of(lanes, [](const auto& name) { return name == "0.0"; }))
                continue;
            data dot;
            dot.set("to", sums.to(out, colour));
            if (factor.empty())
                dot.set("factor", false);
            else
                dot.set("factor", factor);
            dot.set("weights", fmt::format("{}", fmt::join(lanes, ", ")));
            dots.push_back(dot);
            cost.products += factor.empty() ? 4 : 5;
        }
    }
    return dots;
}

}  // namespace

data sumsData(const WeightedSums& sums, gpu::ShaderCost& cost) {
    data names = gpu::list(), lookups = gpu::list();
    std::set<std::string> declared;
    for (std::size_t out = 0; out < sums.outs; ++out) {
        for (const std::size_t colour : sums.coloursOf(out)) {
            if (declared.insert(sums.to(out, colour)).second)
                names.push_back(data("name", sums.to(out, colour)));
        }
    }
    for (std::size_t group = 0; 4 * group < sums.outs * sums.ins; ++group) {
        for (std::size_t k = 0; k < sums.factors.size(); ++k) {
            const data dots = dotsOf(sums, group, sums.factors[k], cost);
            if (dots.is_empty_list()) continue;
            data lookup;
            lookup.set("texel", fmt::format("{}{}_{}", sums.texel, group, k));
            lookup.set("fetch", sums.fetch(k, group));
            lookup.set("dots", dots);
            lookups.push_back(lookup);
            ++cost.fetches;
        }
    }
    data entry;
    entry.set("sums", names);
    entry.set("lookups", lookups);
    return entry;
}

}  // namespace hshfit::inline material_maps::inline exports
