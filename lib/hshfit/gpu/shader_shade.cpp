#include <hshfit/gpu/shader_data.h>
#include <hshfit/light/environment_matrix.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <set>

namespace hshfit::gpu {
namespace {

using kainjow::mustache::data;

/// M by stored function: e_j = sum of value * environment coefficient.
using Weights = std::map<std::size_t, std::vector<EnvironmentElement>>;

Weights weightsOf(const Payload& payload, const Basis& basis, int environmentOrder) {
    Weights weights;
    for (const auto& element : environmentMatrix(basis, environmentOrder, payload.head.quantity)) {
        const auto at = std::lower_bound(payload.slots.begin(), payload.slots.end(), element.slot);
        if (at == payload.slots.end() || *at != element.slot) continue;
        weights[static_cast<std::size_t>(at - payload.slots.begin())].push_back(element);
    }
    return weights;
}

/// Environment coefficients that some function needs, turned to where wo has azimuth 0 if the map
/// is `elevations`: cos(m phi) a_m + sin(m phi) a_-m and cos(m phi) a_-m - sin(m phi) a_m.
/// Rows name the places of both in the array: `stride` apart, from `first`.
data environmentData(const Payload& payload, const Weights& weights, std::size_t colours,
                     int stride, int first, ShaderCost& cost) {
    std::set<int> needed;
    for (const auto& [j, elements] : weights)
        for (const EnvironmentElement& element : elements) needed.insert(element.environment);
    const bool elevations = payload.head.outgoing.map == OutgoingSet::Map::elevations;
    data rows = list();
    for (const int slot : needed) {
        const int m = bandOf(slot).m;
        const bool turned = elevations && m != 0;
        data row;
        row.set("slot", std::to_string(slot));
        row.set("place", std::to_string(slot * stride + first));
        row.set("other", std::to_string((turned ? slot - 2 * m : slot) * stride + first));
        row.set("turned", turned);
        row.set("m", std::to_string(std::abs(m)));
        row.set("sign", m > 0 ? "+" : "-");
        rows.push_back(row);
        if (turned) cost.products += 2 * colours;
    }
    return rows;
}

data weightsData(const Weights& weights, std::size_t colours, ShaderCost& cost) {
    data rows = list();
    for (const auto& [j, elements] : weights) {
        data terms = list();
        for (std::size_t i = 0; i < elements.size(); ++i) {
            data term;
            term.set("value", shaderNumber(elements[i].value));
            term.set("slot", std::to_string(elements[i].environment));
            term.set("last", i + 1 == elements.size());
            terms.push_back(term);
            cost.products += colours;
        }
        data row;
        row.set("j", std::to_string(j));
        row.set("terms", terms);
        rows.push_back(row);
    }
    return rows;
}

/// A sum over functions is kept for every stored channel and every colour of light that meet in an
/// output.
bool meet(const Payload& payload, std::size_t c, std::size_t light) {
    const bool grey = payload.toChannels.size() == 1;
    return payload.toChannels[grey ? 0 : light][c] != 0;
}

/// Lights of a pass: the three colours, or one channel of a spectrum.
struct Pass {
    std::vector<std::size_t> lights;
    bool colours;  ///< weights are vectors of three

    std::string weight(std::size_t j, std::size_t light) const {
        return colours ? fmt::format("e{}.{}", j, laneNames[light]) : fmt::format("e{}", j);
    }
};

void addDot(data& dots, std::size_t c, std::size_t light, const std::string& weights) {
    data dot;
    dot.set("c", std::to_string(c));
    dot.set("light", std::to_string(light));
    dot.set("lane", laneNames[c % 4]);
    dot.set("weights", weights);
    dots.push_back(dot);
}

data coef4Lookups(const Payload& payload, const Weights& weights, const Pass& pass,
                  ShaderCost& cost) {
    data rows = list();
    for (std::size_t c = 0; c < payload.stored.size(); ++c) {
        for (std::size_t g = 0; g * 4 < payload.stored[c].slots; ++g) {
            data dots = list();
            for (const std::size_t light : pass.lights) {
                if (!meet(payload, c, light)) continue;
                std::vector<std::string> lane(4, "0.0");
                bool any = false;
                for (std::size_t j = 4 * g; j < std::min(4 * g + 4, payload.stored[c].slots); ++j) {
                    if (!weights.contains(j)) continue;
                    lane[j % 4] = pass.weight(j, light);
                    any = true;
                }
                if (!any) continue;
                addDot(dots, c, light, fmt::format("{}", fmt::join(lane, ", ")));
                cost.products += 4;
            }
            if (dots.is_empty_list()) continue;
            const std::size_t layer = payload.place(c, 4 * g)[0];
            data row;
            row.set("layer", std::to_string(layer));
            row.set("dots", dots);
            setAffine(payload.coefficients, layer, row, cost);
            ++cost.fetches;
            rows.push_back(row);
        }
    }
    return rows;
}

data rgbLookups(const Payload& payload, const Weights& weights, const Pass& pass,
                ShaderCost& cost) {
    data rows = list();
    for (const auto& [j, elements] : weights) {
        data dots = list();
        for (std::size_t c = 0; c < payload.stored.size(); ++c) {
            for (const std::size_t light : pass.lights) {
                if (!meet(payload, c, light)) continue;
                addDot(dots, c, light, pass.weight(j, light));
                ++cost.products;
            }
        }
        data row;
        row.set("layer", std::to_string(j));
        row.set("dots", dots);
        setAffine(payload.coefficients, j, row, cost);
        ++cost.fetches;
        rows.push_back(row);
    }
    return rows;
}

}  // namespace

std::vector<std::size_t> setShading(const Payload& payload, const Basis& basis,
                                    int environmentOrder, bool flat, data& page, ShaderCost& cost) {
    const Weights weights = weightsOf(payload, basis, environmentOrder);
    const bool colours = payload.head.channels.kind != Channels::Kind::spectral;
    const std::size_t lights = colours ? 3 : payload.head.channels.count();
    data passes = list();
    for (std::size_t first = 0; first < lights; first += colours ? 3 : 1) {
        Pass pass{{first}, colours};
        if (colours) pass.lights = {0, 1, 2};
        data row;
        const bool apart = flat && !colours;
        row.set("element", colours || flat ? "" : fmt::format(".v[{}]", first));
        row.set("environment", environmentData(payload, weights, pass.lights.size(),
                                               apart ? static_cast<int>(lights) : 1,
                                               apart ? static_cast<int>(first) : 0, cost));
        row.set("weights", weightsData(weights, pass.lights.size(), cost));
        row.set("lookups", payload.packing == Packing::rgb
                               ? rgbLookups(payload, weights, pass, cost)
                               : coef4Lookups(payload, weights, pass, cost));
        passes.push_back(row);
    }
    page.set("passes", passes);
    data sums = list(), outputs = list();
    for (std::size_t light = 0; light < lights; ++light) {
        for (std::size_t c = 0; c < payload.stored.size(); ++c) {
            if (!meet(payload, c, light)) continue;
            data sum;
            sum.set("c", std::to_string(c));
            sum.set("light", std::to_string(light));
            sums.push_back(sum);
        }
        data output;
        output.set("i", std::to_string(light));
        const std::size_t channel = payload.toChannels.size() == 1 ? 0 : light;
        output.set("terms", outputTerms(payload.toChannels[channel], cost));
        outputs.push_back(output);
    }
    page.set("shadeSums", sums);
    page.set("shadeOutputs", outputs);
    data turns = list();
    if (payload.head.outgoing.map == OutgoingSet::Map::elevations) {
        for (int m = 2; m < std::min(payload.head.order, environmentOrder); ++m) {
            data turn;
            turn.set("m", std::to_string(m));
            turn.set("before", std::to_string(m - 1));
            turns.push_back(turn);
            cost.products += 4;
        }
    }
    page.set("turns", turns);
    std::vector<std::size_t> lit;
    for (const auto& [j, elements] : weights) lit.push_back(j);
    return lit;
}

}  // namespace hshfit::gpu
