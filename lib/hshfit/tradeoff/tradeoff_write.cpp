#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>
#include <hshfit/pages/gnuplot.h>
#include <hshfit/pages/page_figures.h>
#include <hshfit/pages/report_files.h>
#include <hshfit/tradeoff/tradeoff_files.h>

#include <fmt/format.h>
#include <kainjow/mustache.hpp>

#include <algorithm>
#include <filesystem>
#include <optional>

namespace hshfit::embedded {
extern const std::string_view tradeoff_gp;
}

namespace hshfit::tradeoff {
namespace {

namespace fs = std::filesystem;
using kainjow::mustache::data;

/// Of one channel of an RGL material, which figures mark.
constexpr double tableBytes = 16384;

bool isTimed(std::span<const Tradeoff> trades) {
    return !trades.empty() && !trades[0].times.empty();
}

/// Runs the script for one of the two figures into a file.
void draw(const std::string& folder, const AtomicFile& file, bool timed, const std::string& more) {
    const std::string name = gnuplotString(fs::absolute(file.temporaryPath()).string());
    runGnuplot(folder,
               {"-e", fmt::format("svg={}; timed={:d}{}", name, timed, more), "tradeoff.gp"});
}

void drawWhole(const std::string& folder, const std::string& name, bool timed) {
    AtomicFile svg(folder + "/" + name);
    draw(folder, svg, timed, "");
    svg.commit();
}

/// One SVG document for each BRDF, through a temporary that is never committed.
std::vector<std::string> figuresForPage(const std::string& folder, std::size_t count, bool timed) {
    std::vector<std::string> figures;
    for (std::size_t i = 1; i <= count; ++i) {
        const AtomicFile svg(folder + "/figure.svg");
        draw(folder, svg, timed, fmt::format("; first={0}; last={0}", i));
        figures.push_back(fileContent(svg.temporaryPath()));
    }
    return figures;
}

}  // namespace

std::string tradeoffScript(std::span<const Tradeoff> trades) {
    data fields;
    fields.set("rows", std::to_string(std::max<std::size_t>(1, trades.size())));
    fields.set("metric", gnuplotString(trades.empty() ? "" : metricText(trades[0].metric)));
    fields.set("timed", isTimed(trades) ? "1" : "0");
    data entries{data::type::list};
    for (std::size_t t = 0; t < trades.size(); ++t) {
        data entry;
        entry.set("index", std::to_string(t + 1));
        entry.set("title", gnuplotString(shortName(trades[t].brdf, 110)));
        const std::size_t channels = trades[t].channels.count();
        const auto [smallest, largest] = std::ranges::minmax(trades[t].forms, {}, &Measured::bytes);
        entry.set("channels", std::to_string(channels));
        entry.set("smallest", fmt::format("{}", 0.7 * static_cast<double>(smallest.bytes)));
        entry.set("largest",
                  fmt::format("{}", std::max(1.4 * static_cast<double>(largest.bytes),
                                             tableBytes * 1.4 * static_cast<double>(channels))));
        entries.push_back(entry);
    }
    fields.set("entries", entries);
    return kainjow::mustache::mustache(std::string(embedded::tradeoff_gp)).render(fields);
}

void writeTradeoffs(std::span<const Tradeoff> trades, const std::string& folder) {
    const bool timed = isTimed(trades);
    makeFolder(folder);
    writeFile(folder + "/tradeoff.json", tradeoffJson(trades));
    writeFile(folder + "/forms.csv", formsCsv(trades));
    writeFile(folder + "/front.csv", frontCsv(trades));
    writeFile(folder + "/tradeoff.gp", tradeoffScript(trades));
    if (timed) {
        writeFile(folder + "/timing.json", timingJson(trades));
        writeFile(folder + "/timing.csv", timingCsv(trades));
        writeFile(folder + "/timing_front.csv", timingFrontCsv(trades));
    }
    std::optional<OutputError> undrawn;
    std::vector<std::string> figures, timeFigures;
    try {
        drawWhole(folder, "front.svg", false);
        figures = figuresForPage(folder, trades.size(), false);
        if (timed) {
            drawWhole(folder, "timing.svg", true);
            timeFigures = figuresForPage(folder, trades.size(), true);
        }
    } catch (const OutputError& error) {
        undrawn = error;
    }
    writeFile(folder + "/tradeoff.html", tradeoffPage(trades, figures));
    if (timed) writeFile(folder + "/timing.html", timingPage(trades, timeFigures));
    if (undrawn) throw OutputError(*undrawn);
}

}  // namespace hshfit::tradeoff
