#include "fit_page.h"

#include "figures.h"
#include "fit_tables.h"

#include <brdfs/fit/instrument/instrument_text.h>
#include <hshfit/files/template_text.h>
#include <hshfit/pages/page_figures.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <map>
#include <string_view>

namespace hshfit::embedded {
extern const std::string_view fit_html;
}

namespace hshfit::jobs {
namespace {

using kainjow::mustache::data;

/// Identifiers of the comparison's own figures end below.
constexpr std::size_t firstFigure = 100;

struct Caption {
    std::string_view figure, title, kind, text;
};

constexpr Caption captions[] = {
    {"cuts", "Measured values and fit", "curves",
     "f in planes of incidence: markers are measured values, with bars of one standard uncertainty "
     "where it was stated; lines are the fit, the band holds it with 95 %."},
    {"residuals", "Residuals", "curves",
     "Standardised residuals against the angles and against normal quantiles; lines at two "
     "standard deviations."},
    {"correlations", "Correlations of the parameters", "map narrow",
     "Dark: −1, light: 1; by the route of u."},
    {"influence", "Leverage and influence", "curves",
     "Studentised residuals against leverage, with the bound that one value of all exceeds by "
     "chance in 5 of 100 fits, and Cook’s distances in the order of the values."},
    {"spectrum", "Parameters over the wavelength", "curves", "Bars are one standard uncertainty."}};

data textsOf(const std::vector<std::string>& texts) {
    data list{data::type::list};
    for (const std::string& text : texts) list.push_back(data("text", text));
    return list;
}

data pairsOf(const NamedTexts& pairs) {
    data list{data::type::list};
    for (const auto& [name, text] : pairs) {
        data fields;
        fields.set("name", name);
        fields.set("text", text);
        list.push_back(fields);
    }
    return list;
}

/// A list of one table, or of none without rows. Each cell has the head of its column, which narrow
/// pages show beside it.
data tableOf(const TextTable& table) {
    data list{data::type::list};
    if (table.rows.empty()) return list;
    data fields, rows{data::type::list};
    fields.set("heads", textsOf(table.heads));
    for (const auto& row : table.rows) {
        data cells{data::type::list}, own;
        for (std::size_t c = 1; c < row.size(); ++c) {
            data cell;
            cell.set("label", table.heads[c]);
            cell.set("text", row[c]);
            cells.push_back(cell);
        }
        own.set("first", row.front());
        own.set("cells", cells);
        rows.push_back(own);
    }
    fields.set("rows", rows);
    list.push_back(fields);
    return list;
}

/// The drawn figures that have a caption, in the order of the captions.
data figuresOf(const FigureFiles& drawn) {
    std::map<std::string, std::size_t> svgs;
    for (const std::string& name : drawn.names)
        if (name.ends_with(".svg")) svgs.emplace(name, svgs.size());
    data list{data::type::list};
    std::size_t index = firstFigure;
    for (const Caption& caption : captions) {
        const auto svg = svgs.find(std::string(caption.figure) + ".svg");
        if (svg == svgs.end()) continue;
        data fields;
        fields.set("name", std::string(caption.figure));
        fields.set("title", std::string(caption.title));
        fields.set("kind", std::string(caption.kind));
        fields.set("caption", std::string(caption.text));
        fields.set("svg", inlinedFigure(drawn.svgs.at(svg->second), ++index,
                                        drawn.columns.at(svg->second)));
        list.push_back(fields);
    }
    return list;
}

}  // namespace

FitSection addFitSection(const brdfs::FitReport& report, const nlohmann::ordered_json& fit,
                         FileSet& files) {
    constexpr std::size_t mostValues = 10;
    FigureFiles drawn = addPageFigures(report, files);
    data page;
    if (!report.result.converged) page.set("unsettled", report.result.message);
    page.set("facts", pairsOf(fitFacts(report, fit)));
    page.set("parameters", tableOf(parameterTable(report, fit, true)));
    page.set("legend", parameterLegend(report));
    page.set("ambiguous", textsOf(notToldApart(report.result)));
    page.set("budget", tableOf(budgetTable(report.result)));
    if (report.result.instrument) {
        page.set("anyInstrument", true);
        page.set("instrument", pairsOf(brdfs::instrumentRows(*report.result.instrument)));
    }
    page.set("figures", figuresOf(drawn));
    page.set("values", tableOf(influenceTable(fit, mostValues)));
    page.set("outliers", outlierText(fit));
    std::vector<std::string> others;
    for (const std::string& name : drawn.names)
        if (name == "samples.csv" || name.ends_with(".tex")) others.push_back(name);
    page.set("files", textsOf(others));
    return {filledPage(embedded::fit_html, page), std::move(drawn.names), std::move(drawn.undrawn)};
}

}  // namespace hshfit::jobs
