#include <hshfit/error.h>
#include <hshfit/files/file_set.h>
#include <hshfit/files/template_text.h>
#include <hshfit/pages/gnuplot.h>
#include <hshfit/pages/page_figures.h>
#include <hshfit/pages/report_files.h>
#include <hshfit/tradeoff/tradeoff_files.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

namespace hshfit::embedded {
extern const std::string_view tradeoff_gp;
}

namespace hshfit::tradeoff {
namespace {

namespace fs = std::filesystem;
using kainjow::mustache::data;

/// Bytes of one channel of an RGL material, which figures mark.
constexpr double tableBytes = 16384;

bool isTimed(std::span<const Tradeoff> trades) {
    return !trades.empty() && !trades[0].times.empty();
}

/// The axis of errors: beyond all that are above 0, with an end below them for 0.
struct ErrorRange {
    double lowest = 1e-6, highest = 1;
};

ErrorRange errorRange(const Tradeoff& trade) {
    std::vector<double> errors;
    const auto add = [&](std::optional<double> error) {
        if (error && std::isfinite(*error) && *error > 0) errors.push_back(*error);
    };
    for (std::size_t k = 0; k < trade.forms.size(); ++k) add(trade.errorOf(k));
    for (std::size_t k = 0; k < trade.wavelets.size(); ++k) add(trade.waveletErrorOf(k));
    if (errors.empty()) return {};
    const auto [least, greatest] = std::ranges::minmax(errors);
    return {least / 2, 2 * greatest};
}

/// One of the two figures, drawn from files of the set that are closed but not yet in place.
class Drawing {
public:
    Drawing(FileSet& files, const AtomicFile& script, const AtomicFile& points,
            const AtomicFile& front, bool timed)
        : files_(files),
          script_(fs::absolute(script.temporaryPath()).string()),
          settings_(gnuplotFile("dataCsv", points) + gnuplotFile("frontCsv", front) +
                    fmt::format("timed={:d}; ", timed)),
          name_(timed ? "timing.svg" : "front.svg") {}

    void drawWhole() const {
        const AtomicFile& svg = files_.add(name_);
        try {
            draw(svg, "");
        } catch (...) {
            files_.remove(name_);
            throw;
        }
    }

    /// One SVG document for each BRDF, through a temporary that is never committed.
    std::vector<std::string> drawForPage(std::size_t count) const {
        std::vector<std::string> figures;
        for (std::size_t i = 1; i <= count; ++i) {
            const AtomicFile svg((files_.folder() / "figure.svg").string());
            draw(svg, fmt::format("first={0}; last={0}", i));
            figures.push_back(fileContent(svg.temporaryPath()));
        }
        return figures;
    }

private:
    void draw(const AtomicFile& svg, const std::string& rows) const {
        runGnuplot(files_.folder().string(),
                   {"-e", settings_ + gnuplotFile("svg", svg) + rows, script_},
                   {fs::absolute(svg.temporaryPath()).string()});
    }

    FileSet& files_;
    std::string script_, settings_, name_;
};

}  // namespace

std::string tradeoffScript(std::span<const Tradeoff> trades) {
    data fields;
    fields.set("rows", std::to_string(std::max<std::size_t>(1, trades.size())));
    fields.set("metric", gnuplotString(trades.empty() ? "" : metricText(trades[0].metric)));
    fields.set("timed", isTimed(trades) ? "1" : "0");
    const bool wavelets =
        std::ranges::any_of(trades, [](const Tradeoff& trade) { return !trade.wavelets.empty(); });
    fields.set("wavelets", wavelets);
    fields.set("kinds", std::to_string(seriesNames().size() + (wavelets ? 1 : 0)));
    data entries{data::type::list};
    for (std::size_t t = 0; t < trades.size(); ++t) {
        data entry;
        entry.set("index", std::to_string(t + 1));
        entry.set("title", gnuplotString(shortName(withoutFolders(trades[t].brdf), 110)));
        const std::size_t channels = trades[t].channels.count();
        const auto [smallest, largest] = std::ranges::minmax(trades[t].forms, {}, &Measured::bytes);
        entry.set("channels", std::to_string(channels));
        const ErrorRange range = errorRange(trades[t]);
        entry.set("lowest", fmt::format("{}", range.lowest));
        entry.set("highest", fmt::format("{}", range.highest));
        entry.set("smallest", fmt::format("{}", 0.7 * static_cast<double>(smallest.bytes)));
        entry.set("largest",
                  fmt::format("{}", std::max(1.4 * static_cast<double>(largest.bytes),
                                             tableBytes * 1.4 * static_cast<double>(channels))));
        entries.push_back(entry);
    }
    fields.set("entries", entries);
    return filledPage(embedded::tradeoff_gp, fields);
}

void writeTradeoffs(std::span<const Tradeoff> trades, FileSet& files) {
    const bool timed = isTimed(trades);
    files.write("tradeoff.json", tradeoffJson(trades));
    const AtomicFile& forms = files.write("forms.csv", formsCsv(trades));
    const AtomicFile& front = files.write("front.csv", frontCsv(trades));
    const AtomicFile& script = files.write("tradeoff.gp", tradeoffScript(trades));
    const AtomicFile *timing = nullptr, *timingFront = nullptr;
    if (timed) {
        files.write("timing.json", timingJson(trades));
        timing = &files.write("timing.csv", timingCsv(trades));
        timingFront = &files.write("timing_front.csv", timingFrontCsv(trades));
        if (trades[0].shaders) files.write("timing_gpu.csv", shadersCsv(trades));
    }
    std::optional<NoFigures> undrawn;
    std::vector<std::string> figures, timeFigures;
    try {
        const Drawing drawing(files, script, forms, front, false);
        drawing.drawWhole();
        figures = drawing.drawForPage(trades.size());
        if (timed) {
            const Drawing times(files, script, *timing, *timingFront, true);
            times.drawWhole();
            timeFigures = times.drawForPage(trades.size());
        }
    } catch (const NoFigures& error) {
        undrawn = error;
    }
    files.write("tradeoff.html", tradeoffPage(trades, figures));
    if (timed) files.write("timing.html", timingPage(trades, timeFigures));
    for (const char* name :
         {"timing.csv", "timing_front.csv", "timing_gpu.csv", "timing.svg", "timing.html"})
        files.leaveUnchecked(name);
    files.commit();
    if (undrawn) throw NoFigures(*undrawn);
}

void writeTradeoffs(std::span<const Tradeoff> trades, const std::string& folder) {
    FileSet files(folder, true, FileSet::Above::require);
    writeTradeoffs(trades, files);
}

}  // namespace hshfit::tradeoff
