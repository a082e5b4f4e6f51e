#include "trade_lighting.h"

#include <jobs/source/source.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <string_view>

namespace hshfit::cli {
namespace {

std::string lightingTradeText(const std::string& spec,
                              const std::vector<jobs::LightingTrade>& trades) {
    std::string out =
        spec +
        ": lighting against direct integration on a sphere; * on the front of bytes, time "
        "and error\n";
    std::string_view light;
    for (const jobs::LightingTrade& trade : trades) {
        const jobs::LightingError& error = trade.error;
        if (error.light != light)
            out += fmt::format("  {} (direct integration: {:.0f} ns a point)\n", error.light,
                               error.integration);
        light = error.light;
        out += fmt::format(
            "  {} {:12} {:15} {:7} + {:7} bytes {:8.0f} ns  error {:.4f}, FLIP {:.3f}, at most "
            "{:.3f}\n",
            trade.front ? '*' : ' ', error.model, trade.settings, error.bytes, error.lightBytes,
            error.nanoseconds, error.difference.relativeL2, error.flip, error.difference.maximum,
            error.turned ? fmt::format(", over all turns {:.4f}", *error.turned) : "");
    }
    return out;
}

}  // namespace

void runTradeLighting(const std::vector<std::string>& specs,
                      const jobs::LightingTradeOptions& options, const Globals& globals) {
    nlohmann::ordered_json document = {{"format", "hshfit-tradeoff-lighting"},
                                       {"version", 1},
                                       {"brdfs", nlohmann::ordered_json::array()}};
    std::string text;
    for (const std::string& spec : specs) {
        const auto brdf = jobs::openSource(spec, true);
        const auto trades = jobs::tradeLighting(*brdf, options, listenerFor(globals));
        document["brdfs"].push_back(
            {{"brdf", brdf->name()}, {"trades", jobs::lightingTradesJson(trades)}});
        text += lightingTradeText(brdf->name(), trades);
    }
    if (globals.json)
        printJson(document);
    else
        printText(text);
}

}  // namespace hshfit::cli
