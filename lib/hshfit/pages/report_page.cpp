#include <hshfit/files/template_text.h>
#include <hshfit/pages/page_figures.h>
#include <hshfit/pages/report_files.h>
#include <hshfit/version.h>

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace hshfit::embedded {
extern const std::string_view report_html;
}

namespace hshfit::inline pages {

namespace {

using kainjow::mustache::data;

constexpr std::array<double, 4> thresholds{leastOfNeeds, 0.95, 0.99, 0.999};

std::string percent(double fraction) {
    return fmt::format("{:g} %", 100 * fraction);
}

/// Enough digits to show the missing part: 98.7 %, 99.9987 %; never rounded up, so that what is
/// below a threshold reads as below it.
std::string accuracyText(const std::optional<double>& accuracy) {
    if (!accuracy) return "–";
    const double missing = 1 - *accuracy;
    if (missing < 5e-9) return "100 %";
    const int digits = std::clamp(static_cast<int>(-std::floor(std::log10(missing))), 1, 8);
    const double scale = std::pow(10, digits);
    return fmt::format("{:.{}f} %", std::floor(100 * *accuracy * scale + 1e-6) / scale, digits);
}

/// Whether the numbers of coefficients of a curve compare with other curves': they have the same
/// energy, and no indices beside the values.
bool compares(const ReportCurve& curve) {
    return !curve.energy && !curve.bestTerms;
}

/// The fewest coefficients with which a curve reaches a threshold, 0 if none does.
int fewest(const ReportEntry& entry, double threshold) {
    int best = 0;
    for (const auto& curve : entry.curves) {
        const auto point = firstReaching(curve, threshold);
        if (point && compares(curve) && (best == 0 || point->coefficients < best))
            best = point->coefficients;
    }
    return best;
}

/// The curves below the first threshold, with the most that they capture: "sh 79.1 % (144), …".
std::string shortCurves(const ReportEntry& entry) {
    std::vector<std::string> names;
    for (const auto& curve : entry.curves) {
        if (curve.points.empty() || firstReaching(curve, leastOfNeeds)) continue;
        const ReportPoint& last = curve.points.back();
        names.push_back(
            fmt::format("{} {} ({})", curve.basis, accuracyText(last.accuracy), last.coefficients));
    }
    return fmt::format("{}", fmt::join(names, ", "));
}

/// A row for each curve that reaches a threshold.
data needsOf(const ReportEntry& entry) {
    data rows{data::type::list};
    for (const auto& curve : entry.curves) {
        if (!firstReaching(curve, leastOfNeeds)) continue;
        data cells{data::type::list};
        for (const double threshold : thresholds) {
            data cell;
            const auto point = firstReaching(curve, threshold);
            if (point) {
                const bool best =
                    compares(curve) && point->coefficients == fewest(entry, threshold);
                cell.set("text", fmt::format("{} ({})", point->coefficients, point->order));
                cell.set("class", best ? "best" : "reached");
            } else {
                const bool known = !curve.points.empty() && curve.points.back().accuracy;
                cell.set("text",
                         known ? fmt::format("> {}", curve.points.back().coefficients) : "–");
                cell.set("class", "never");
            }
            cells.push_back(cell);
        }
        data row;
        row.set("basis", curve.basis);
        row.set("colour", curveStyle(curve.basis).colour);
        row.set("cells", cells);
        rows.push_back(row);
    }
    return rows;
}

data everyOrder(const ReportEntry& entry) {
    int last = 0;
    for (const auto& curve : entry.curves) {
        for (const auto& point : curve.points) last = std::max(last, point.order);
    }
    data rows{data::type::list};
    for (int order = 1; order <= last; ++order) {
        data cells{data::type::list};
        bool any = false;
        for (const auto& curve : entry.curves) {
            const auto point = std::find_if(curve.points.begin(), curve.points.end(),
                                            [&](const ReportPoint& p) { return p.order == order; });
            const bool there = point != curve.points.end();
            any = any || there;
            cells.push_back(data("text", there ? accuracyText(point->accuracy) : ""));
        }
        if (!any) continue;
        data row;
        row.set("order", std::to_string(order));
        row.set("cells", cells);
        rows.push_back(row);
    }
    return rows;
}

data entryData(const ReportEntry& entry, std::size_t index) {
    data fields;
    fields.set("index", std::to_string(index));
    fields.set("brdf", entry.brdf);
    const std::string name = shortName(withoutFolders(entry.brdf), 100);
    fields.set("name", name);
    fields.set("isShort", name != entry.brdf);
    fields.set("quantity", entry.quantity == Quantity::brdf ? "f, without the cosine"
                                                            : "f cos θ, with the cosine");
    fields.set("outgoing", outgoingText(entry.outgoing));
    fields.set("channels", fmt::format("{}", fmt::join(entry.channels.names(), ", ")));
    fields.set("energy", energyText(entry.energy));
    fields.set("error", std::isfinite(entry.error)
                            ? fmt::format("{:.1e} relative{}, asked for {:.0e}", entry.error,
                                          entry.errorOf.empty() ? "" : " (" + entry.errorOf + ")",
                                          entry.tolerance)
                            : "none: no coefficients were reached");
    fields.set("evaluations", std::to_string(entry.evaluations));
    if (!entry.energy.finite) fields.set("reason", entry.energy.reason);
    fields.set("hasAccuracy", hasAccuracy(entry));
    data columns{data::type::list}, own{data::type::list}, best{data::type::list};
    for (const auto& curve : entry.curves) {
        columns.push_back(data("basis", curve.basis));
        if (curve.bestTerms) best.push_back(data("basis", curve.basis));
        if (!curve.energy) continue;
        data line("basis", curve.basis);
        line.set("energy", energyText(*curve.energy));
        own.push_back(line);
    }
    fields.set("columns", columns);
    fields.set("ownEnergy", own);
    fields.set("bestTerms", best);
    const data needs = needsOf(entry);
    fields.set("anyNeeds", !needs.is_empty_list());
    fields.set("needs", needs);
    const std::string below = shortCurves(entry);
    if (!below.empty()) fields.set("short", below);
    if (!entry.better.empty()) fields.set("better", commandMarkup(entry.better));
    fields.set("rows", everyOrder(entry));
    return fields;
}

}  // namespace

std::string reportPage(const Report& report, const std::vector<std::string>& figures) {
    const std::size_t count = report.reports.size();
    data page;
    page.set("generator", std::string("hshfit ") + version);
    page.set("style", std::string(pageStyle()));
    page.set("title", count == 1 ? shortName(withoutFolders(report.reports[0].brdf), 60)
                                 : fmt::format("{} BRDFs", count));
    page.set("many", count > 1);
    const bool phase = count > 0 && report.reports.front().condonShortley;
    page.set("phase", phase ? "carry" : "do not carry");
    data limits{data::type::list};
    for (const double threshold : thresholds) limits.push_back(data("text", percent(threshold)));
    page.set("thresholds", limits);
    std::string plotter = "gnuplot";
    // The panels over coefficients and over the order, as curves.gp places them.
    constexpr std::array columns{0, 493};
    data entries{data::type::list};
    for (std::size_t i = 0; i < count; ++i) {
        data entry = entryData(report.reports[i], i + 1);
        if (i < figures.size()) {
            plotter = plotterOf(figures[i]);
            entry.set("figure", inlinedFigure(figures[i], i + 1, columns));
        }
        entries.push_back(entry);
    }
    page.set("plotter", plotter);
    page.set("entries", entries);
    return filledPage(embedded::report_html, page);
}

}  // namespace hshfit::inline pages
