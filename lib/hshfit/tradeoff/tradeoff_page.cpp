#include <hshfit/choice/row_text.h>
#include <hshfit/files/template_text.h>
#include <hshfit/pages/page_figures.h>
#include <hshfit/pages/report_files.h>
#include <hshfit/tradeoff/tradeoff_files.h>
#include <hshfit/version.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace hshfit::embedded {
extern const std::string_view tradeoff_html, timing_html;
}

namespace hshfit::tradeoff {
namespace {

using kainjow::mustache::data;
using Kind = Representation::Kind;

/// Metrics that the table of the front shows besides the one that it weighs.
constexpr std::array shownMetrics{"relative-l2-cosine", "captured-energy", "maximum", "albedo",
                                  "reciprocity",        "negativity"};
constexpr std::array<std::size_t, 7> budgets{256, 1024, 2700, 4096, 16384, 65536, 1048576};

std::string numberText(std::optional<double> value) {
    return value && std::isfinite(*value) ? fmt::format("{:.3g}", *value) : "–";
}

data textList(const std::vector<std::string>& texts) {
    data list{data::type::list};
    for (const std::string& text : texts) list.push_back(data("text", text));
    return list;
}

std::vector<std::string> bandTexts() {
    std::vector<std::string> texts;
    for (std::size_t b = 0; b < bandCount; ++b) {
        texts.push_back(fmt::format("{:g}–{:g}°", bandEdges[b], bandEdges[b + 1]));
    }
    return texts;
}

std::string stepsText(const Measured& form) {
    std::vector<std::string> texts;
    for (const RepresentationStep& step : form.steps) {
        texts.push_back(fmt::format("{}: {:.2g}", step.what, step.change));
    }
    return fmt::format("{}", fmt::join(texts, "; "));
}

data frontRow(const Tradeoff& trade, std::size_t k) {
    const Measured& form = trade.forms[k];
    data row;
    row.set("class", trade.byteKnee == k ? "knee" : "");
    row.set("bytes", std::to_string(form.bytes));
    row.set("entropy", std::to_string(form.entropyBytes));
    row.set("error",
            fmt::format("{} ± {}", numberText(trade.errorOf(k)),
                        trade.uncertaintyOf(trade.forms[k].errors)
                            ? fmt::format("{:.1g}", *trade.uncertaintyOf(trade.forms[k].errors))
                            : "–"));
    std::vector<std::string> bands, metrics;
    for (std::size_t b = 0; b < bandCount; ++b)
        bands.push_back(numberText(trade.bandErrorOf(k, b)));
    for (const char* name : shownMetrics) {
        const auto index = selectMetrics(name).front() - metricCatalog().data();
        metrics.push_back(numberText(form.errors.values[static_cast<std::size_t>(index)]));
    }
    row.set("bands", textList(bands));
    row.set("metrics", textList(metrics));
    row.set("command", commandMarkup(commandOf(trade, k)));
    if (trade.costs) row.set("cycles", choice::cyclesText(form.cost));
    if (!form.steps.empty()) row.set("steps", stepsText(form));
    return row;
}

data budgetRows(const Tradeoff& trade) {
    data rows{data::type::list};
    for (const std::size_t budget : budgets) {
        std::vector<std::string> cells;
        for (const Kind kind : {Kind::outgoing, Kind::basis, Kind::halfway}) {
            const auto best = bestWithin(trade, kind, budget);
            cells.push_back(best ? fmt::format("{} ({} bytes)", numberText(trade.errorOf(*best)),
                                               trade.forms[*best].bytes)
                                 : "–");
        }
        data row;
        row.set("budget", std::to_string(budget));
        row.set("cells", textList(cells));
        rows.push_back(row);
    }
    return rows;
}

data leftOutRows(const Tradeoff& trade) {
    data rows{data::type::list};
    for (const LeftOut& line : trade.leftOut) {
        data row;
        row.set("forms", std::to_string(line.forms));
        row.set("example", line.example);
        row.set("reason", line.reason);
        rows.push_back(row);
    }
    return rows;
}

/// The wavelet forms that no other of them beats.
data waveletTable(const Tradeoff& trade) {
    data rows{data::type::list};
    for (const std::size_t k : trade.waveletFront()) {
        data row;
        row.set("bytes", std::to_string(trade.wavelets[k].bytes));
        row.set("error", numberText(trade.waveletErrorOf(k)));
        row.set("name", trade.wavelets[k].name());
        rows.push_back(row);
    }
    data table;
    table.set("rows", rows);
    return table;
}

/// Materials that are no coefficient files.
data formulaTableOf(const Tradeoff& trade) {
    data rows{data::type::list};
    for (std::size_t k = 0; k < trade.formulas.size(); ++k) {
        const choice::Row& formula = trade.formulas[k].row;
        data row("name", formula.name);
        row.set("bytes", std::to_string(formula.made.bytes));
        row.set("error", numberText(trade.formulaErrorOf(k)));
        row.set("flip", fmt::format("{:.3f}", formula.picture.flip.mean));
        row.set("largest", fmt::format("{:.3f}", formula.picture.flip.largest));
        row.set("lost", formula.lost);
        if (trade.costs) row.set("cycles", choice::cyclesText(formula.cost));
        const std::string command = choice::commandLineOf(formula);
        row.set("command",
                commandMarkup(command.empty() ? withoutFolders(formula.made.spec) : command));
        rows.push_back(row);
    }
    data table;
    table.set("rows", rows);
    return table;
}

data sizeEntry(const Tradeoff& trade) {
    data entry;
    entry.set("channels", fmt::format("{}", fmt::join(trade.channels.names(), ", ")));
    entry.set("isotropic", trade.laws.isotropic ? "yes" : "no");
    entry.set("forms", std::to_string(trade.forms.size()));
    entry.set("beyond", trade.beyondBytes == 0
                            ? ""
                            : fmt::format(", and {} that are too large", trade.beyondBytes));
    entry.set("pairs", std::to_string(trade.pairs));
    entry.set("knee", trade.byteKnee ? commandOf(trade, *trade.byteKnee) : "–");
    if (!trade.noSquares.empty()) entry.set("noSquares", trade.noSquares);
    entry.set("bands", textList(bandTexts()));
    entry.set("metrics", textList({shownMetrics.begin(), shownMetrics.end()}));
    std::vector<std::string> bounds;
    for (const double bound : trade.sliceErrors) bounds.push_back(numberText(bound));
    entry.set("bounded", !bounds.empty());
    entry.set("bounds", fmt::format("{}", fmt::join(bounds, ", ")));
    entry.set("sliceOutgoing", trade.sliceOutgoing);
    data front{data::type::list};
    for (const std::size_t k : trade.byteFront) front.push_back(frontRow(trade, k));
    entry.set("front", front);
    entry.set("budgets", budgetRows(trade));
    if (!trade.wavelets.empty()) entry.set("wavelets", waveletTable(trade));
    if (!trade.formulas.empty()) entry.set("formulas", formulaTableOf(trade));
    if (trade.costs) entry.set("scale", choice::scaleText(*trade.costs));
    entry.set("anyLeftOut", !trade.leftOut.empty());
    entry.set("leftOut", leftOutRows(trade));
    return entry;
}

std::string timeText(const PairTime& time) {
    return fmt::format("{:.1f} ({:.1f}–{:.1f})", time.median, time.low, time.high);
}

data timeRows(const Tradeoff& trade, const std::vector<std::size_t>& front) {
    data rows{data::type::list};
    for (const std::size_t k : front) {
        const MeasuredTime& time = trade.times[k];
        data row;
        row.set("class", trade.timeKnee == k ? "knee" : "");
        row.set("batch", timeText(time.evaluation.batch));
        row.set("single", timeText(time.evaluation.single));
        row.set("error", numberText(trade.errorOf(k)));
        row.set("bytes", std::to_string(trade.forms[k].bytes));
        row.set("projection", fmt::format("{:.3f} s", time.projectionSeconds));
        row.set("derivation", fmt::format("{:.2f} ms", 1e3 * time.derivationSeconds));
        row.set("command", commandMarkup(commandOf(trade, k)));
        rows.push_back(row);
    }
    return rows;
}

std::string millions(double nanoseconds) {
    return fmt::format("{:.3f}", 1e-6 * nanoseconds);
}

/// The shaders of the fronts, the fastest first; forms without a shader come last.
data shaderTable(const Tradeoff& trade) {
    const MeasuredShaders& shaders = *trade.shaders;
    std::vector<const MeasuredShader*> order;
    for (const MeasuredShader& shader : shaders.forms) order.push_back(&shader);
    std::ranges::stable_sort(order, {}, [](const MeasuredShader* shader) {
        return shader->time ? shader->time->median : HUGE_VAL;
    });
    data rows{data::type::list}, table;
    for (const MeasuredShader* shader : order) {
        data row;
        row.set("time", shader->time
                            ? fmt::format("{} ({}–{})", millions(shader->time->median),
                                          millions(shader->time->low), millions(shader->time->high))
                            : shader->reason);
        row.set("error", numberText(trade.errorOf(shader->form)));
        row.set("bytes", std::to_string(trade.forms[shader->form].bytes));
        row.set("command", commandMarkup(commandOf(trade, shader->form)));
        rows.push_back(row);
    }
    table.set("rows", rows);
    table.set("device", shaders.device);
    table.set("software", shaders.software);
    table.set("bare", millions(shaders.bare.median));
    return table;
}

data timeEntry(const Tradeoff& trade) {
    data tables{data::type::list}, byTime, byBytes;
    byTime.set("title", "The front over time");
    byTime.set("rows", timeRows(trade, trade.timeFront));
    byBytes.set("title", "Times of the front over bytes");
    byBytes.set("rows", timeRows(trade, trade.byteFront));
    tables.push_back(byTime);
    tables.push_back(byBytes);
    data entry;
    entry.set("tables", tables);
    if (trade.shaders) entry.set("shaders", shaderTable(trade));
    return entry;
}

std::string page(std::span<const Tradeoff> trades, const std::vector<std::string>& figures,
                 std::string_view shape, data (*entryOf)(const Tradeoff&)) {
    data fields;
    fields.set("generator", std::string("hshfit ") + version);
    fields.set("style", std::string(pageStyle()));
    fields.set("count", std::to_string(trades.size()));
    fields.set("plural", trades.size() == 1 ? "" : "s");
    fields.set("many", trades.size() > 1);
    fields.set("metric", trades.empty() ? "" : metricText(trades[0].metric));
    fields.set("timed", !trades.empty() && !trades[0].times.empty());
    std::string plotter = "gnuplot";
    // The panel and its key, as tradeoff.gp places them.
    constexpr std::array columns{0, 790};
    data entries{data::type::list};
    for (std::size_t t = 0; t < trades.size(); ++t) {
        data entry = entryOf(trades[t]);
        entry.set("index", std::to_string(t + 1));
        entry.set("brdf", withoutFolders(trades[t].brdf));
        if (t < figures.size()) {
            plotter = plotterOf(figures[t]);
            entry.set("figure", inlinedFigure(figures[t], t + 1, columns));
        }
        entries.push_back(entry);
    }
    fields.set("plotter", plotter);
    fields.set("entries", entries);
    return filledPage(shape, fields);
}

}  // namespace

std::string tradeoffPage(std::span<const Tradeoff> trades,
                         const std::vector<std::string>& figures) {
    return page(trades, figures, embedded::tradeoff_html, sizeEntry);
}

std::string timingPage(std::span<const Tradeoff> trades, const std::vector<std::string>& figures) {
    return page(trades, figures, embedded::timing_html, timeEntry);
}

}  // namespace hshfit::tradeoff
