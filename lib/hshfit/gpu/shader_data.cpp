#include <hshfit/gpu/shader_data.h>

#include <hshfit/gpu/internal/basis_steps.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <cstdlib>
#include <map>

namespace hshfit::gpu {
namespace {

using kainjow::mustache::data;

/// A constant that depends on the nearer end: mean + half e, e = 1 or -1.
data endsData(const std::array<double, 2>& values, int near, bool bothEnds) {
    data ends;
    ends.set("same", !bothEnds);
    ends.set("value", shaderNumber(values[0]));
    const double mean = 0.5 * (values[0] + values[1]);
    if (mean == 0)
        ends.set("mean", false);
    else
        ends.set("mean", shaderNumber(mean));
    ends.set("half", shaderNumber(0.5 * near * (values[0] - values[1])));
    return ends;
}

/// Steps of every m that reach the last stored function of that m.
std::map<int, int> stepsNeeded(const Payload& payload, int bandStep) {
    std::map<int, int> needed;
    for (const int slot : payload.slots) {
        const auto [l, m] = bandOf(slot);
        int& count = needed[std::abs(m)];
        count = std::max(count, (l - std::abs(m)) / bandStep);
    }
    return needed;
}

data stepsData(const BasisSteps& steps, const BasisSteps::Column& column, int count,
               ShaderCost& cost) {
    data rows = list();
    for (int k = 0; k < count; ++k) {
        const BasisSteps::Step& step = column.steps[static_cast<std::size_t>(k)];
        data row;
        row.set("k", std::to_string(k));
        row.set("next", std::to_string(k + 1));
        row.set("before", std::to_string(k - 1));
        row.set("slope", shaderNumber(step.slope));
        row.set("ratio", endsData(step.ratio, steps.near, steps.bothEnds));
        if (k > 0)
            row.set("carry", endsData(step.carry, steps.near, steps.bothEnds));
        else
            row.set("carry", false);
        const std::size_t ends = steps.bothEnds ? 2 : 1;
        cost.products += 2 + ends * (k > 0 ? 2 : 1);
        rows.push_back(row);
    }
    return rows;
}

std::string partName(const BasisSteps& steps, int m) {
    if (m == 0) return steps.rootCosine ? "c0" : "";
    return fmt::format("{}{}", m > 0 ? 'c' : 's', std::abs(m));
}

data groupsData(const Payload& payload, ShaderCost& cost) {
    data groups = list();
    for (std::size_t g = 0; g * 4 < payload.slots.size(); ++g) {
        data group;
        group.set("g", std::to_string(g));
        std::vector<std::string> weights;
        for (std::size_t j = 4 * g; j < 4 * g + 4; ++j) {
            weights.push_back(j < payload.slots.size() ? fmt::format("b{}", j) : "0.0");
        }
        group.set("weights", fmt::format("{}", fmt::join(weights, ", ")));
        group.set("affine", false);
        if (payload.basisTexels) {
            setAffine(*payload.basisTexels, g, group, cost);
            ++cost.fetches;
        }
        groups.push_back(group);
    }
    return groups;
}

data coef4Lookups(const Payload& payload, ShaderCost& cost) {
    data lookups = list();
    for (std::size_t c = 0; c < payload.stored.size(); ++c) {
        for (std::size_t g = 0; g * 4 < payload.stored[c].slots; ++g) {
            const std::size_t layer = payload.place(c, 4 * g)[0];
            data row;
            row.set("layer", std::to_string(layer));
            row.set("c", std::to_string(c));
            row.set("g", std::to_string(g));
            setAffine(payload.coefficients, layer, row, cost);
            cost.products += 4;
            ++cost.fetches;
            lookups.push_back(row);
        }
    }
    return lookups;
}

data rgbLookups(const Payload& payload, ShaderCost& cost) {
    data lookups = list();
    for (std::size_t j = 0; j < payload.slots.size(); ++j) {
        data row;
        row.set("layer", std::to_string(j));
        row.set("g", std::to_string(j / 4));
        row.set("weightLane", laneNames[j % 4]);
        setAffine(payload.coefficients, j, row, cost);
        data used = list();
        for (std::size_t c = 0; c < payload.stored.size(); ++c) {
            data lane;
            lane.set("c", std::to_string(c));
            lane.set("lane", laneNames[c]);
            used.push_back(lane);
            ++cost.products;
        }
        row.set("lanes", used);
        ++cost.fetches;
        lookups.push_back(row);
    }
    return lookups;
}

}  // namespace

Band bandOf(int slot) {
    int l = 0;
    while ((l + 1) * (l + 1) <= slot) ++l;
    return {l, slot - l * (l + 1)};
}

void setAffine(const Texels& texels, std::size_t layer, data& row, ShaderCost& cost) {
    row.set("affine", isNormalised(texels.number));
    if (!isNormalised(texels.number)) return;
    std::vector<std::string> scales, offsets;
    for (std::size_t lane = 0; lane < 4; ++lane) {
        const LaneScale& scale = texels.scales[layer * 4 + lane];
        scales.push_back(shaderNumber(scale.scale));
        offsets.push_back(shaderNumber(scale.offset));
    }
    row.set("scales", fmt::format("{}", fmt::join(scales, ", ")));
    row.set("offsets", fmt::format("{}", fmt::join(offsets, ", ")));
    cost.products += 4;
}

data outputTerms(const std::vector<double>& factors, ShaderCost& cost) {
    data terms = list();
    std::size_t last = factors.size();
    while (last > 0 && factors[last - 1] == 0) --last;
    for (std::size_t c = 0; c < last; ++c) {
        if (factors[c] == 0) continue;
        data term;
        term.set("c", std::to_string(c));
        if (factors[c] == 1) {
            term.set("factor", false);
        } else {
            term.set("factor", shaderNumber(factors[c]));
            ++cost.products;
        }
        term.set("last", c + 1 == last);
        terms.push_back(term);
    }
    return terms;
}

data list() {
    return data{data::type::list};
}

std::string shaderNumber(double value) {
    const std::string text = fmt::format("{}", static_cast<float>(value));
    return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
}

void setBasis(const Payload& payload, const Basis& basis, data& page, ShaderCost& cost) {
    page.set("analytic", !payload.basisTexels);
    page.set("tabulated", payload.basisTexels.has_value());
    if (payload.basisTexels) {
        const double side = payload.basisTexels->width;
        page.set("basisScale", shaderNumber((side - 2) / (2 * side)));
        return;
    }
    const BasisSteps steps = basisSteps(basis);
    page.set("bothEnds", steps.bothEnds);
    page.set("near", shaderNumber(steps.near));
    page.set("one", steps.scale == BasisSteps::Scale::one);
    page.set("hump", steps.scale == BasisSteps::Scale::hump);
    page.set("chord", steps.scale == BasisSteps::Scale::chord);
    page.set("rootCosine", steps.rootCosine);
    data columns = list();
    const std::map<int, int> needed = stepsNeeded(payload, steps.bandStep);
    for (const auto& [m, count] : needed) {
        const BasisSteps::Column& from = steps.columns[static_cast<std::size_t>(m)];
        data column;
        column.set("m", std::to_string(m));
        column.set("start", shaderNumber(from.start));
        column.set("steps", stepsData(steps, from, count, cost));
        columns.push_back(column);
    }
    page.set("columns", columns);
    data powers = list();
    cost.products += 6;
    for (int m = 1; m <= needed.rbegin()->first; ++m) {
        data power;
        power.set("first", m == 1);
        power.set("m", std::to_string(m));
        power.set("before", std::to_string(m - 1));
        powers.push_back(power);
        if (m > 1) cost.products += 4;
    }
    page.set("powers", powers);
    data functions = list();
    for (std::size_t j = 0; j < payload.slots.size(); ++j) {
        const auto [l, m] = bandOf(payload.slots[j]);
        data function;
        function.set("j", std::to_string(j));
        function.set("m", std::to_string(std::abs(m)));
        function.set("k", std::to_string((l - std::abs(m)) / steps.bandStep));
        const std::string part = partName(steps, m);
        if (part.empty())
            function.set("part", false);
        else
            function.set("part", part);
        cost.products += !part.empty();
        functions.push_back(function);
    }
    page.set("functions", functions);
}

void setEvaluation(const Payload& payload, data& page, ShaderCost& cost) {
    page.set("groups", groupsData(payload, cost));
    const bool rgb = payload.packing == Packing::rgb;
    page.set("lookups", rgb ? rgbLookups(payload, cost) : coef4Lookups(payload, cost));
    data sums = list();
    for (std::size_t c = 0; c < payload.stored.size(); ++c) {
        sums.push_back(data("c", std::to_string(c)));
    }
    page.set("sums", sums);
    data outputs = list();
    for (std::size_t i = 0; i < payload.toChannels.size(); ++i) {
        data output;
        output.set("i", std::to_string(i));
        output.set("terms", outputTerms(payload.toChannels[i], cost));
        outputs.push_back(output);
    }
    page.set("outputs", outputs);
}

}  // namespace hshfit::gpu
