#include <hshfit/choice/row_text.h>
#include <hshfit/tradeoff/tradeoff_files.h>
#include <hshfit/wording.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace hshfit::tradeoff {
namespace {

using Kind = Representation::Kind;

constexpr std::array<const char*, 5> series{"outgoing", "outgoing, factored", "basis",
                                            "basis, factored", "halfway"};

/// A field of a table: text in quotes, quotes doubled (RFC 4180).
std::string quoted(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) {
        out += c;
        if (c == '"') out += c;
    }
    return out + "\"";
}

std::string cell(std::optional<double> value) {
    return value && std::isfinite(*value) ? fmt::format("{}", *value) : std::string();
}

std::vector<bool> marked(const std::vector<std::size_t>& front, std::size_t count) {
    std::vector<bool> marks(count);
    for (const std::size_t k : front) marks[k] = true;
    return marks;
}

std::string frontRows(std::span<const Tradeoff> trades, const char* heading,
                      std::vector<std::size_t> Tradeoff::*front,
                      std::optional<std::size_t> Tradeoff::*knee,
                      double (*cost)(const Tradeoff&, std::size_t)) {
    std::string csv = heading;
    for (std::size_t t = 0; t < trades.size(); ++t) {
        const Tradeoff& trade = trades[t];
        for (const std::size_t k : trade.*front) {
            csv += fmt::format("{},{},{},{:d},{}\n", t + 1, cost(trade, k), cell(trade.errorOf(k)),
                               trade.*knee == k, quoted(commandOf(trade, k)));
        }
    }
    return csv;
}

/// Rows of forms.csv of the wavelets, the series after the last.
std::string waveletRows(std::span<const Tradeoff> trades) {
    std::string csv;
    for (std::size_t t = 0; t < trades.size(); ++t) {
        for (std::size_t k = 0; k < trades[t].wavelets.size(); ++k) {
            const MeasuredWavelets& form = trades[t].wavelets[k];
            csv += fmt::format("{},{},{},{},", t + 1, series.size() + 1, form.bytes,
                               cell(trades[t].waveletErrorOf(k)));
            for (std::size_t b = 0; b < bandCount; ++b) csv += ",";
            csv += fmt::format(",,{}", form.terms);
            for (const auto& value : form.errors.values) csv += fmt::format(",{}", cell(value));
            csv += fmt::format(",0,{}\n", quoted(form.name()));
        }
    }
    return csv;
}

/// A row of the tables.
struct Line {
    std::size_t bytes;
    double error;
    std::optional<double> uncertainty;
    const PairSummary& summary;
    const PictureError& picture;
    bool poor;
    std::string nanoseconds, gpu, name;
    std::optional<gpu::ShaderCost> cost;
};

std::string headingText(const Tradeoff& trade, const char* names) {
    return fmt::format("  {:>9} {:>11} {:>5} {:>9} {:>9} {:>5} {:>6} {:>6} {:>4} {:>9}{}{}  {}\n",
                       "bytes", "error", "+-", zoneNames[0], zoneNames[1], "FLIP", "dip", "peak",
                       "", trade.times.empty() ? "" : "ns",
                       trade.shaders ? fmt::format(" {:>10}", "gpu ns/Mpx") : "",
                       trade.costs ? fmt::format(" {:>6}", "cycles") : "", names);
}

std::string lineText(const Tradeoff& trade, const Line& line) {
    const auto relative = [&] {
        if (!(line.error > 0) || !line.uncertainty) return std::string("-");
        return fmt::format("{:.0f}%", 100 * *line.uncertainty / line.error);
    };
    return fmt::format(
        "  {:>9} {:>11.4g} {:>5} {:>9.3g} {:>9.3g} {:>5.3f} {:>6} {:>6} {:>4} {:>9}{}{}  {}\n",
        line.bytes, line.error, relative(), line.summary.zones[0].value,
        line.summary.zones[1].value, line.picture.flip.mean, shareText(line.picture.dip),
        shareText(line.picture.peak), line.poor ? "poor" : "", line.nanoseconds,
        trade.shaders ? fmt::format(" {:>10}", line.gpu) : "",
        trade.costs ? fmt::format(" {:>6}", choice::cyclesText(line.cost)) : "", line.name);
}

std::string frontTable(const Tradeoff& trade, const std::vector<std::size_t>& front) {
    std::string text = headingText(trade, "options");
    for (const std::size_t k : front) {
        const Measured& form = trade.forms[k];
        const std::optional<double> time = trade.shaderTimeOf(k);
        text += lineText(
            trade,
            {.bytes = form.bytes,
             .error = trade.errorOf(k),
             .uncertainty = trade.uncertaintyOf(form.errors),
             .summary = form.summary,
             .picture = *form.picture,
             .poor = trade.poorReasonOf(k).has_value(),
             .nanoseconds = trade.times.empty()
                                ? ""
                                : fmt::format("{:.1f}", trade.times[k].evaluation.batch.median),
             .gpu = time ? fmt::format("{:.3g}", *time) : "–",
             .name = form.options,
             .cost = form.cost});
    }
    return text;
}

/// Materials that are no coefficient files, with the commands that write them.
std::string formulaTable(const Tradeoff& trade) {
    if (trade.formulas.empty()) return "";
    std::string text = headingText(trade, "formulas, for comparison");
    for (std::size_t k = 0; k < trade.formulas.size(); ++k) {
        const MeasuredFormula& formula = trade.formulas[k];
        const std::string command = choice::commandLineOf(formula.row);
        text += lineText(trade, {.bytes = formula.row.made.bytes,
                                 .error = trade.formulaErrorOf(k),
                                 .uncertainty = trade.uncertaintyOf(formula.errors),
                                 .summary = formula.summary,
                                 .picture = formula.row.picture,
                                 .poor = formula.row.poor.has_value(),
                                 .nanoseconds = "",
                                 .gpu = "–",
                                 .name = formula.row.name + (command.empty() ? "" : ": " + command),
                                 .cost = formula.row.cost});
    }
    return text;
}

/// The device, and forms of the fronts that it did not run.
std::string shadersText(const Tradeoff& trade) {
    const MeasuredShaders& shaders = *trade.shaders;
    std::string text = fmt::format(
        "  gpu: {}{}; a million pixels of a sphere under one light; without the form "
        "{:.3g} ns\n",
        shaders.device, shaders.software ? ", a renderer in software" : "", shaders.bare.median);
    for (const MeasuredShader& form : shaders.forms) {
        if (form.time) continue;
        text += fmt::format("  gpu: {}: {}\n", trade.forms[form.form].options, form.reason);
    }
    return text;
}

}  // namespace

std::span<const char* const> seriesNames() {
    return series;
}

std::size_t seriesOf(const Form& form) {
    const bool factored = form.rank > 0 || form.rankError > 0;
    switch (form.kind) {
        case Kind::outgoing:
            return factored ? 2 : 1;
        case Kind::basis:
            return factored ? 4 : 3;
        case Kind::halfway:
            break;
    }
    return 5;
}

std::string commandOf(const Tradeoff& trade, std::size_t form) {
    Call call{.function = "writeRepresentation",
              .subject = trade.brdf,
              .settings = settingsOf(trade.forms[form].form),
              .output = "OUT.json"};
    if (trade.tolerance > 0) {
        call.settings.push_back(
            {"ProjectionOptions::tolerance", fmt::format("{}", trade.tolerance)});
    }
    return fmt::format("{}", call);
}

std::optional<std::size_t> bestWithin(const Tradeoff& trade, Kind kind, std::size_t bytes) {
    std::optional<std::size_t> best;
    for (std::size_t k = 0; k < trade.forms.size(); ++k) {
        const Measured& form = trade.forms[k];
        if (form.form.kind != kind || form.bytes > bytes) continue;
        if (!best || trade.errorOf(k) < trade.errorOf(*best)) best = k;
    }
    return best;
}

std::string metricText(const std::string& metric) {
    if (metric == "picture") return "mean FLIP of lit spheres (picture)";
    const Metric& row = *selectMetrics(metric).front();
    return metric == "captured-energy"
               ? "energy that is not captured, relative-l2 squared (captured-energy)"
               : fmt::format("{} ({})", row.help, row.name);
}

std::string formsCsv(std::span<const Tradeoff> trades) {
    std::string csv = "brdf,series,bytes,error,uncertainty";
    for (std::size_t b = 0; b < bandCount; ++b)
        csv += fmt::format(",error_{}_{}", bandEdges[b], bandEdges[b + 1]);
    csv += ",entropy_bytes,numbers";
    for (const Metric& metric : metricCatalog()) csv += fmt::format(",{}", metric.name);
    csv += ",front,options\n";
    for (std::size_t t = 0; t < trades.size(); ++t) {
        const Tradeoff& trade = trades[t];
        const std::vector<bool> front = marked(trade.byteFront, trade.forms.size());
        for (std::size_t k = 0; k < trade.forms.size(); ++k) {
            const Measured& form = trade.forms[k];
            csv += fmt::format("{},{},{},{},{}", t + 1, seriesOf(form.form), form.bytes,
                               cell(trade.errorOf(k)),
                               cell(trade.uncertaintyOf(trade.forms[k].errors)));
            for (std::size_t b = 0; b < bandCount; ++b)
                csv += fmt::format(",{}", cell(trade.bandErrorOf(k, b)));
            csv += fmt::format(",{},{}", form.entropyBytes, form.numbers);
            for (const auto& value : form.errors.values) csv += fmt::format(",{}", cell(value));
            csv += fmt::format(",{:d},{}\n", bool(front[k]), quoted(form.options));
        }
    }
    return csv + waveletRows(trades);
}

std::string frontCsv(std::span<const Tradeoff> trades) {
    return frontRows(trades, "brdf,bytes,error,knee,command\n", &Tradeoff::byteFront,
                     &Tradeoff::byteKnee, [](const Tradeoff& trade, std::size_t k) {
                         return static_cast<double>(trade.forms[k].bytes);
                     });
}

std::string timingCsv(std::span<const Tradeoff> trades) {
    std::string csv =
        "brdf,series,batch_ns,error,batch_low,batch_high,single_ns,single_low,single_high,"
        "projection_s,derivation_s,bytes,front,options\n";
    for (std::size_t t = 0; t < trades.size(); ++t) {
        const Tradeoff& trade = trades[t];
        const std::vector<bool> front = marked(trade.timeFront, trade.forms.size());
        for (std::size_t k = 0; k < trade.times.size(); ++k) {
            const MeasuredTime& time = trade.times[k];
            const PairTime &batch = time.evaluation.batch, &single = time.evaluation.single;
            csv += fmt::format("{},{},{:.2f},{},{:.2f},{:.2f},{:.2f},{:.2f},{:.2f},{:.6f},{:.6f}",
                               t + 1, seriesOf(trade.forms[k].form), batch.median,
                               cell(trade.errorOf(k)), batch.low, batch.high, single.median,
                               single.low, single.high, time.projectionSeconds,
                               time.derivationSeconds);
            csv += fmt::format(",{},{:d},{}\n", trade.forms[k].bytes, bool(front[k]),
                               quoted(trade.forms[k].options));
        }
    }
    return csv;
}

std::string timingFrontCsv(std::span<const Tradeoff> trades) {
    return frontRows(trades, "brdf,batch_ns,error,knee,command\n", &Tradeoff::timeFront,
                     &Tradeoff::timeKnee, [](const Tradeoff& trade, std::size_t k) {
                         return trade.times[k].evaluation.batch.median;
                     });
}

std::string shadersCsv(std::span<const Tradeoff> trades) {
    std::string csv =
        "brdf,ns_per_million_pixels,low,high,bare,error,bytes,device,software,options\n";
    for (std::size_t t = 0; t < trades.size(); ++t) {
        if (!trades[t].shaders) continue;
        const MeasuredShaders& shaders = *trades[t].shaders;
        for (const MeasuredShader& form : shaders.forms) {
            if (!form.time) continue;
            const Measured& measured = trades[t].forms[form.form];
            csv +=
                fmt::format("{},{:.0f},{:.0f},{:.0f},{:.0f},{},{},{},{:d},{}\n", t + 1,
                            form.time->median, form.time->low, form.time->high, shaders.bare.median,
                            cell(trades[t].errorOf(form.form)), measured.bytes,
                            quoted(shaders.device), shaders.software, quoted(measured.options));
        }
    }
    return csv;
}

std::string tradeoffText(const Tradeoff& trade, bool byTime) {
    std::string text = fmt::format("{}: {} forms, {} pairs, error: {}\n", trade.brdf,
                                   trade.forms.size(), trade.pairs, metricText(trade.metric));
    text += frontTable(trade, byTime ? trade.timeFront : trade.byteFront);
    text += formulaTable(trade);
    if (trade.costs) text += fmt::format("  cycles: {}\n", choice::scaleText(*trade.costs));
    if (trade.shaders) text += shadersText(trade);
    for (const LeftOut& line : trade.leftOut) {
        text += fmt::format("  left out: {} ({}): {}\n", line.forms, line.example, line.reason);
    }
    if (trade.beyondBytes > 0) {
        text += fmt::format("  left out: {} forms larger than {}\n", trade.beyondBytes,
                            Setting{"TradeoffOptions::maxBytes"});
    }
    if (!trade.wavelets.empty()) {
        text +=
            "  for comparison, adaptive: the best terms of spherical wavelets, values and "
            "indices\n";
        for (const std::size_t k : trade.waveletFront()) {
            text += fmt::format("  {:>9} {:>11.4g}  {}\n", trade.wavelets[k].bytes,
                                trade.waveletErrorOf(k), trade.wavelets[k].name());
        }
    }
    if (const auto knee = byTime ? trade.timeKnee : trade.byteKnee) {
        text += fmt::format("  the front bends at: {}\n", commandOf(trade, *knee));
    }
    return text;
}

}  // namespace hshfit::tradeoff
