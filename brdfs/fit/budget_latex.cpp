#include <brdfs/fit/budget_latex.h>

#include <brdfs/fit/latex_table.h>
#include <brdfs/fit/printed_number.h>

#include <fmt/format.h>

#include <cmath>

namespace hshfit::brdfs {
namespace {

std::string numberText(double value, int digits) {
    if (!std::isfinite(value)) return "\\infty";
    const std::string text = fmt::format("{:.{}g}", value, digits);
    const std::size_t e = text.find('e');
    if (e == text.npos) return text;
    return fmt::format("{}\\times10^{{{}}}", text.substr(0, e), std::stoi(text.substr(e + 1)));
}

std::string unitText(const std::string& unit) {
    if (unit == "1/sr") return "\\,sr$^{-1}$";
    return unit == "degrees" ? "$^\\circ$" : "";
}

std::string rowText(const BudgetRow& row) {
    return fmt::format("  {} & {} & {} & ${}${} & ${}$ & ${}$ & {:.1f} & ${}$ \\\\\n",
                       latexText(row.name), row.type, latexText(row.distribution),
                       numberText(row.standard, 3), unitText(row.unit),
                       numberText(row.sensitivity, 4), numberText(row.contribution, 3),
                       100 * row.share, numberText(row.degrees, 3));
}

}  // namespace

std::string latexBudget(const Budget& budget) {
    std::string text =
        "% Budgets of the parameters of a fit\n"
        "\\providecommand{\\toprule}{\\hline}\\providecommand{\\midrule}{\\hline}%\n"
        "\\providecommand{\\bottomrule}{\\hline}%\n";
    for (const ParameterBudget& own : budget.parameters) {
        text +=
            "\\begin{tabular}{lllrrrrr}\n  \\toprule\n  contribution & type & distribution & "
            "$u(x_i)$ & $c_i$ & $|c_i|\\,u(x_i)$ & share (\\%) & $\\nu_i$ \\\\\n  \\midrule\n";
        for (const BudgetRow& row : own.rows) text += rowText(row);
        text += fmt::format(
            "  \\bottomrule\n\\end{{tabular}}\n\\par\\smallskip {} {}: ${}$, $u_c = {}$, "
            "$\\nu_\\mathrm{{eff}} = {}$, $U = {}$ ($k = {:.3g}$, {:.4g}\\,\\%).\\par\\medskip\n",
            latexText(own.name), own.channel.empty() ? std::string() : latexText(own.channel),
            latexNumber(own.value, own.combined), numberText(own.combined, 3),
            numberText(own.degrees, 3), numberText(own.expanded, 3), own.coverage,
            100 * Budget::probability);
    }
    return text;
}

}  // namespace hshfit::brdfs
