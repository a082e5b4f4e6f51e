#include "lighting_trade.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <utility>

namespace hshfit::jobs {
namespace {

using Kind = LightingModel::Kind;

struct Candidate {
    const LightingModel* model;
    LightingTableOptions tables;
    std::string settings;
};

std::vector<Candidate> candidatesOf(const LightingTradeOptions& options) {
    std::vector<Candidate> candidates;
    for (const LightingModel* model : selectLightingModels(options.models)) {
        const auto add = [&](const std::string& settings, auto&& set) {
            Candidate candidate{model, options.errors.tables, settings};
            set(candidate.tables);
            candidates.push_back(candidate);
        };
        if (model->kind == Kind::coefficients)
            for (const int order : options.orders)
                add(fmt::format("order {}", order),
                    [&](LightingTableOptions& how) { how.order = order; });
        if (model->kind == Kind::splitSum)
            for (const std::size_t face : options.faces)
                add(fmt::format("faces up to {}", face),
                    [&](LightingTableOptions& how) { how.face = face; });
        if (model->kind == Kind::cosines)
            for (const std::size_t tiles : options.tiles)
                add(fmt::format("{} tiles", tiles),
                    [&](LightingTableOptions& how) { how.tiles = tiles; });
        if (model->kind == Kind::prefiltered)
            for (const std::size_t lobes : options.lobes)
                add(fmt::format("{} lobe{}", lobes, lobes == 1 ? "" : "s"),
                    [&](LightingTableOptions& how) { how.lobes = lobes; });
    }
    return candidates;
}

std::size_t bytesOf(const LightingTrade& trade) {
    return trade.error.bytes + trade.error.lightBytes;
}

void markFront(std::vector<LightingTrade>& trades) {
    for (LightingTrade& one : trades) {
        one.front = std::ranges::none_of(trades, [&](const LightingTrade& other) {
            const auto cost = [](const LightingTrade& trade) {
                return std::array<double, 3>{static_cast<double>(bytesOf(trade)),
                                             trade.error.nanoseconds,
                                             trade.error.difference.relativeL2};
            };
            if (&other == &one || other.error.light != one.error.light) return false;
            const auto a = cost(other), b = cost(one);
            return a[0] <= b[0] && a[1] <= b[1] && a[2] <= b[2] && a != b;
        });
    }
}

}  // namespace

std::vector<LightingTrade> tradeLighting(const Brdf& brdf, const LightingTradeOptions& options,
                                         const Listener& listener) {
    std::vector<LightingTrade> trades;
    // Tables depend on the order and the number of lobes, not on faces and tiles.
    std::optional<LightingTables> tables;
    const auto references = lightingReferences(brdf, options.errors, listener);
    const Candidate* before = nullptr;
    const std::vector<Candidate> candidates = candidatesOf(options);
    for (const Candidate& candidate : candidates) {
        const LightingModel* const models[] = {candidate.model};
        if (!before || before->model != candidate.model ||
            before->tables.order != candidate.tables.order ||
            before->tables.lobes != candidate.tables.lobes)
            tables = fitLightingTables(brdf, models, candidate.tables);
        before = &candidate;
        LightingErrorOptions how = options.errors;
        how.tables = candidate.tables;
        for (LightingError& error : lightingErrors(references, *tables, models, how)) {
            const bool known = std::ranges::any_of(trades, [&](const LightingTrade& other) {
                return other.error.light == error.light && other.error.model == error.model &&
                       other.error.bytes == error.bytes &&
                       other.error.lightBytes == error.lightBytes;
            });
            if (!known) trades.push_back({candidate.settings, std::move(error)});
        }
    }
    std::ranges::stable_sort(trades, {}, [](const LightingTrade& trade) {
        return std::pair(trade.error.light, bytesOf(trade));
    });
    markFront(trades);
    return trades;
}

std::optional<LightingTrade> chooseLighting(std::span<const LightingTrade> trades,
                                            const std::string& light, double budget, bool byTime) {
    std::optional<LightingTrade> best;
    for (const LightingTrade& trade : trades) {
        if (trade.error.light != light || !(trade.error.difference.relativeL2 <= budget)) continue;
        const auto cost = [&](const LightingTrade& one) {
            return byTime ? one.error.nanoseconds : static_cast<double>(bytesOf(one));
        };
        if (!best || cost(trade) < cost(*best)) best = trade;
    }
    return best;
}

nlohmann::ordered_json lightingTradesJson(std::span<const LightingTrade> trades) {
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (const LightingTrade& trade : trades) {
        nlohmann::ordered_json row = lightingErrorsJson({&trade.error, 1}).front();
        row["settings"] = trade.settings;
        row["front"] = trade.front;
        rows.push_back(row);
    }
    return rows;
}

}  // namespace hshfit::jobs
