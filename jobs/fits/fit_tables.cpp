#include "fit_tables.h"

#include <brdfs/fit/printed_number.h>
#include <brdfs/fit/stated_error.h>
#include <hshfit/percent.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>

namespace hshfit::jobs {
namespace {

using Json = nlohmann::ordered_json;

const std::string nothing = "–";

std::string numberOf(const Json& value) {
    return value.is_number() ? brdfs::plainValue(value.get<double>(), 3) : nothing;
}

std::string degreesText(double degrees) {
    return std::isinf(degrees) ? "∞" : fmt::format("{:.0f}", degrees);
}

std::string chiSquareText(const Json& study) {
    const auto degrees = study["degrees_of_freedom"].get<std::size_t>();
    if (!study["chi_square"].is_number())
        return fmt::format(
            "none, as no uncertainties of the samples are stated; variance of the residuals {} "
            "over {} degrees of freedom",
            numberOf(study["residual_variance"]), degrees);
    const std::string probability =
        study["probability"].is_null()
            ? "no probability, as errors are correlated"
            : fmt::format("probability of as much {}", numberOf(study["probability"]));
    return fmt::format("{} over {} degrees of freedom, {} each; {}",
                       brdfs::plainValue(study["chi_square"].get<double>()), degrees,
                       brdfs::plainValue(study["reduced_chi_square"].get<double>(), 4),
                       probability);
}

const Json* studyOf(const Json& fit) {
    const auto study = fit.find("uncertainty");
    return study == fit.end() ? nullptr : &*study;
}

/// The errors of a parameter by each route that the study has.
std::vector<std::string> routeCells(const Json& study, std::size_t parameter) {
    const Json& own = study["parameters"][parameter];
    std::vector<std::string> cells{numberOf(own["normal"]), numberOf(own["sandwich"])};
    if (study.contains("correlation")) cells.push_back(numberOf(own["correlated"]));
    if (study.contains("scans")) cells.push_back(numberOf(own.value("scans", Json())));
    if (study.contains("bootstrap"))
        cells.push_back(own.contains("bootstrap") ? numberOf(own["bootstrap"]["standard_error"])
                                                  : nothing);
    return cells;
}

std::vector<std::string> routeHeads(const Json& study) {
    std::vector<std::string> heads{"u normal", "u sandwich"};
    if (study.contains("correlation")) heads.emplace_back("u correlated");
    if (study.contains("scans")) heads.emplace_back("u by scan");
    if (study.contains("bootstrap")) heads.emplace_back("u bootstrap");
    return heads;
}

void append(std::vector<std::string> more, std::vector<std::string>& cells) {
    cells.insert(cells.end(), more.begin(), more.end());
}

}  // namespace

NamedTexts fitFacts(const brdfs::FitReport& report, const Json& fit) {
    const brdfs::FitResult& result = report.result;
    NamedTexts facts{{"model", result.model},
                     {"data", report.data},
                     {"samples", fmt::format("{}, {} values; weights: {}", result.samples,
                                             result.values, fit["weights"].get<std::string>())}};
    if (!report.sigma.empty()) facts.emplace_back("uncertainty of a sample", report.sigma);
    if (!report.scans.empty() && result.uncertainty)
        facts.emplace_back("scans",
                           fmt::format("{} (by {})", result.uncertainty->scans, report.scans));
    if (const Json* study = studyOf(fit)) facts.emplace_back("chi-square", chiSquareText(*study));
    facts.emplace_back(
        "residual", fmt::format("{} in the root mean square, by the loss {}",
                                brdfs::plainValue(result.loss, 4), fit["loss"].get<std::string>()));
    facts.emplace_back("explained",
                       fmt::format("{} of the data in units of the loss; relative error of "
                                   "f cos θi {}",
                                   percent(fit["explained"].get<double>(), 4),
                                   percent(fit["relative_error"].get<double>())));
    return facts;
}

TextTable parameterTable(const brdfs::FitReport& report, const Json& fit, bool routes) {
    const Json* study = routes ? studyOf(fit) : nullptr;
    TextTable table{.heads = {"parameter", "channel", "value", "u", "U", "k", "ν"}, .rows = {}};
    if (study) append(routeHeads(*study), table.heads);
    table.heads.emplace_back("");
    for (std::size_t i = 0; i < report.result.parameters.size(); ++i) {
        const brdfs::FittedParameter& p = report.result.parameters[i];
        if (p.isScanScale()) continue;
        const auto stated = brdfs::statedError(report.result, i);
        std::vector<std::string> cells{p.name, p.channel,
                                       brdfs::plainNumber(p.value, stated ? stated->error : 0)};
        if (stated)
            append({brdfs::plainError(stated->error), brdfs::plainError(stated->expanded()),
                    fmt::format("{:.2f}", stated->factor), degreesText(stated->degrees)},
                   cells);
        else
            cells.insert(cells.end(), 4, nothing);
        if (study) append(routeCells(*study, i), cells);
        cells.push_back(stated            ? ""
                        : p.bound.empty() ? "not determined by the data"
                                          : fmt::format("at its {} bound", p.bound));
        table.rows.push_back(std::move(cells));
    }
    return table;
}

std::string parameterLegend(const brdfs::FitReport& report) {
    std::set<std::string_view> routes;
    for (std::size_t i = 0; i < report.result.parameters.size(); ++i)
        if (const auto stated = brdfs::statedError(report.result, i)) routes.insert(stated->route);
    return fmt::format(
        "u: standard uncertainty (route: {}{}), also in units of the last digits behind the value. "
        "U = k u holds the value with {:.4g} %; ν: degrees of freedom of u.",
        routes.empty() ? nothing : fmt::format("{}", fmt::join(routes, " or ")),
        report.result.budget ? ", combined with the budget" : "", 100 * brdfs::Budget::probability);
}

std::vector<std::string> notToldApart(const brdfs::FitResult& result) {
    std::vector<std::string> texts;
    for (const auto& set : result.ambiguous)
        if (set.size() > 1) texts.push_back(fmt::format("{}", fmt::join(set, ", ")));
    return texts;
}

TextTable budgetTable(const brdfs::FitResult& result) {
    TextTable table{.heads = {"parameter", "contribution", "type", "distribution", "u(x)",
                              "sensitivity", "contribution to u", "share", "ν"},
                    .rows = {}};
    if (!result.budget) return table;
    for (const brdfs::FittedParameter& p : result.parameters) {
        const brdfs::ParameterBudget* own = brdfs::budgetOf(result, p);
        if (!own || p.isScanScale()) continue;
        std::string name = p.label();
        for (const brdfs::BudgetRow& row : own->rows) {
            table.rows.push_back(
                {name, row.name, std::string(1, row.type), row.distribution,
                 brdfs::plainValue(row.standard, 3) +
                     (row.unit.empty() || row.unit == "1" ? "" : fmt::format(" {}", row.unit)),
                 brdfs::plainValue(row.sensitivity, 3), brdfs::plainValue(row.contribution, 3),
                 fmt::format("{:.1f} %", 100 * row.share), degreesText(row.degrees)});
            name.clear();
        }
        table.rows.push_back({"", "combined", "", "", "", "", brdfs::plainValue(own->combined, 3),
                              "", degreesText(own->degrees)});
        table.rows.push_back({"", fmt::format("U, k = {:.2f}", own->coverage), "", "", "", "",
                              brdfs::plainValue(own->expanded, 3), "", ""});
    }
    return table;
}

TextTable influenceTable(const Json& fit, std::size_t most) {
    TextTable table;
    const auto influence = fit.find("influence");
    if (influence == fit.end()) return table;
    table.heads = {(*influence)["rows"] == "lines" ? "line" : "sample",
                   "channel",
                   "measured, 1/sr",
                   "fitted, 1/sr",
                   "studentised residual",
                   "leverage",
                   "Cook’s distance"};
    const Json& list = (*influence)["most_influential"];
    for (std::size_t i = 0; i < std::min(most, list.size()); ++i) {
        const Json& own = list[i];
        table.rows.push_back({fmt::format("{}", own["row"].get<std::size_t>()),
                              own.value("channel", ""), numberOf(own["value"]),
                              numberOf(own["model"]), numberOf(own["studentised"]),
                              numberOf(own["leverage"]), numberOf(own["cook"])});
    }
    return table;
}

std::string outlierText(const Json& fit) {
    const auto influence = fit.find("influence");
    if (influence == fit.end()) return {};
    const auto count = (*influence)["outlier_count"].get<std::size_t>();
    return fmt::format(
        "{} {} with a studentised residual beyond {:.3g}, which one value of all exceeds by chance "
        "in 5 of 100 fits.",
        count, count == 1 ? "outlier" : "outliers", (*influence)["outlier_bound"].get<double>());
}

}  // namespace hshfit::jobs
