#include <brdfs/catalog/tables.h>
#include <brdfs/fit/instrument/instrument_text.h>
#include <brdfs/fit/latex_table.h>
#include <brdfs/fit/printed_number.h>
#include <brdfs/fit/split_models.h>
#include <brdfs/fit/stated_error.h>
#include <brdfs/rows/spec.h>
#include <hshfit/files/printable.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <utility>
#include <vector>

namespace hshfit::brdfs {
namespace {

/// The unit of a parameter as its row in the catalog states it.
std::string unitOf(const std::string& term, const std::string& key) {
    const std::string name = term.substr(0, term.find(':'));
    const auto model = std::ranges::find(models(), name, &Model::name);
    if (model == models().end()) return "1";
    const auto row = std::ranges::find(model->parameters, key, &Parameter::name);
    if (row == model->parameters.end()) return "1";
    const bool normalised =
        term.find("normalized=") != term.npos && term.find("normalized=false") == term.npos;
    if (row->help.find("1/sr") != row->help.npos) return normalised ? "1" : "sr$^{-1}$";
    if (row->help.find("degrees") != row->help.npos) return "$^\\circ$";
    return row->help.find("radians") != row->help.npos ? "rad" : "1";
}

/// The unit of a coefficient of a law over the wavelength in micrometres, "ior.B" or "ior.C1"; none
/// for other parameters.
std::optional<std::string> unitOfLaw(const FitResult& result, const std::string& parameter) {
    for (const FittedLaw& law : result.laws) {
        if (!parameter.starts_with(law.parameter + ".")) continue;
        const std::string term = parameter.substr(law.parameter.size() + 1);
        const int power = 2 * (term.front() - 'A');
        if (law.law.starts_with("sellmeier")) return term.front() == 'C' ? "$\\mu$m$^2$" : "1";
        if (law.law.starts_with("cauchy"))
            return power == 0 ? "1" : fmt::format("$\\mu$m$^{{{}}}$", power);
    }
    return std::nullopt;
}

/// By the parameter's name in the sum of models that was fitted.
std::string unitOf(const FitResult& result, const std::string& name) {
    if (const auto unit = unitOfLaw(result, name)) return *unit;
    if (name.starts_with("incidence zero") || name.starts_with("detector zero")) return "$^\\circ$";
    const std::string parameter = name.substr(0, name.find('@'));  // of a coefficient of a spline
    const std::vector<std::string> terms = splitModels(result.model);
    const std::size_t dot = parameter.find('.');
    if (dot == parameter.npos) return unitOf(terms.front(), parameter);
    const std::string model = parameter.substr(0, dot), key = parameter.substr(dot + 1);
    const std::vector<std::string> names = termNames(result.model);
    const auto own = std::ranges::find(names, model);
    return own == names.end() ? "1"
                              : unitOf(terms[static_cast<std::size_t>(own - names.begin())], key);
}

/// An offset and a dark signal of the instrument are in the unit of f, its other terms are shares.
std::string unitOf(const FitResult& result, const FittedParameter& parameter) {
    if (!parameter.instrument) return unitOf(result, parameter.name);
    return parameter.name == "offset" || parameter.name == "dark" ? "sr$^{-1}$" : "1";
}

/// The rows of a tabular with their columns.
class Tabular {
public:
    explicit Tabular(std::string columns) : columns_(std::move(columns)) {}

    void row(const std::vector<std::string>& cells) {
        rows_ += fmt::format("  {} \\\\\n", fmt::join(cells, " & "));
    }
    void rule(std::string_view name) { rows_ += fmt::format("  \\{}\n", name); }
    std::string text() const {
        return fmt::format("\\begin{{tabular}}{{{}}}\n{}\\end{{tabular}}\n", columns_, rows_);
    }

private:
    std::string columns_, rows_;
};

class Table {
public:
    explicit Table(const FitReport& report) : report_(report), result_(report.result) {}

    std::string text() {
        std::string text = fmt::format(
            "% Parameters of the fit of {} to {}\n"
            "\\providecommand{{\\toprule}}{{\\hline}}\\providecommand{{\\midrule}}{{\\hline}}%\n"
            "\\providecommand{{\\bottomrule}}{{\\hline}}%\n",
            printable(result_.model), printable(report_.data));
        text += shared();
        text += byChannel();
        return text + notes() + correlations() + instrument() + statistics();
    }

private:
    /// The value with its standard uncertainty, or the mark of a note.
    std::string valueOf(const FittedParameter& p) {
        if (p.standardError) return fmt::format("${}$", latexNumber(p.value, *p.standardError));
        char mark = 'c';
        if (!p.bound.empty()) mark = p.bound == "lower" ? 'a' : 'b';
        marks_[static_cast<std::size_t>(mark - 'a')] = true;
        return fmt::format("${}$\\textsuperscript{{{}}}", latexValue(p.value), mark);
    }

    std::string shared() {
        Tabular tabular("lrrrrl");
        tabular.rule("toprule");
        tabular.row({"parameter", "value", "$U$", "$k$", "$\\nu$", "unit"});
        tabular.rule("midrule");
        bool any = false;
        for (std::size_t i = 0; i < result_.parameters.size(); ++i) {
            const FittedParameter& p = result_.parameters[i];
            if (!p.channel.empty() || p.isScanScale()) continue;
            std::vector<std::string> cells{latexText(p.name), valueOf(p), "", "", ""};
            if (const auto stated = statedError(result_, i)) {
                cells[2] = fmt::format("${}$", latexError(stated->expanded()));
                cells[3] = fmt::format("{:.2f}", stated->factor);
                cells[4] = fmt::format("${}$", degreesText(stated->degrees));
                routes_.insert(stated->route);
            }
            cells.push_back(unitOf(result_, p));
            tabular.row(cells);
            any = true;
        }
        tabular.rule("bottomrule");
        return any ? tabular.text() : std::string();
    }

    static std::string degreesText(double degrees) {
        return std::isinf(degrees) ? "\\infty" : fmt::format("{:.0f}", degrees);
    }

    std::string byChannel() {
        std::vector<std::string> names;
        for (const FittedParameter& p : result_.parameters)
            if (!p.channel.empty() && std::ranges::find(names, p.name) == names.end())
                names.push_back(p.name);
        if (names.empty()) return {};
        const Channels& channels = report_.samples->channels;
        const bool spectral = channels.kind == Channels::Kind::spectral;
        Tabular tabular(fmt::format("l{}", std::string(names.size(), 'r')));
        std::vector<std::string> head{spectral ? "wavelength (nm)" : "channel"};
        for (const std::string& name : names) {
            const std::string unit = unitOf(result_, name);
            head.push_back(latexText(name) +
                           (unit == "1" ? std::string() : fmt::format(" ({})", unit)));
        }
        tabular.rule("toprule");
        tabular.row(head);
        tabular.rule("midrule");
        const std::vector<std::string> own = channels.names();
        for (std::size_t c = 0; c < own.size(); ++c) {
            std::vector<std::string> cells{spectral ? fmt::format("{:g}", channels.wavelengths[c])
                                                    : latexText(own[c])};
            for (const std::string& name : names) {
                const auto p =
                    std::ranges::find_if(result_.parameters, [&](const FittedParameter& candidate) {
                        return candidate.name == name && candidate.channel == own[c];
                    });
                cells.push_back(p == result_.parameters.end() ? "" : valueOf(*p));
            }
            tabular.row(cells);
        }
        tabular.rule("bottomrule");
        return "\\par\\medskip\n" + tabular.text() + factors();
    }

    /// The factors of the parameters by channel, which have no columns of their own.
    std::string factors() {
        double least[2] = {HUGE_VAL, HUGE_VAL}, most[2] = {0, 0};
        for (std::size_t i = 0; i < result_.parameters.size(); ++i) {
            const auto stated = statedError(result_, i);
            if (!stated || result_.parameters[i].channel.empty()) continue;
            routes_.insert(stated->route);
            const double own[2] = {stated->factor, stated->degrees};
            for (int k = 0; k < 2; ++k) {
                least[k] = std::min(least[k], own[k]);
                most[k] = std::max(most[k], own[k]);
            }
        }
        if (most[0] == 0) return {};
        const auto range = [](const std::string& low, const std::string& high) {
            return low == high ? low : fmt::format("{}$ to ${}", low, high);
        };
        return fmt::format(
            "\\par\\smallskip By {}, $U = k u$ with $k = {}$ for $\\nu = {}$.\n",
            report_.samples->channels.kind == Channels::Kind::spectral ? "wavelength" : "channel",
            range(fmt::format("{:.2f}", least[0]), fmt::format("{:.2f}", most[0])),
            range(degreesText(least[1]), degreesText(most[1])));
    }

    /// The correlations: all if parameters are few, else the ones beyond 0.95.
    std::string correlations() const {
        constexpr std::size_t mostColumns = 8, mostPairs = 10;
        constexpr double strong = 0.95;
        const std::size_t all = result_.parameters.size();
        std::vector<std::size_t> own;
        for (std::size_t i = 0; i < all; ++i)
            if (result_.parameters[i].standardError && !result_.parameters[i].isScanScale())
                own.push_back(i);
        if (own.size() < 2) return {};
        const auto nameOf = [&](std::size_t i) {
            const FittedParameter& p = result_.parameters[own[i]];
            return latexText(p.label());
        };
        const auto at = [&](std::size_t i, std::size_t j) {
            return result_.correlations[own[i] * all + own[j]];
        };
        if (own.size() <= mostColumns) {
            Tabular tabular(fmt::format("l{}", std::string(own.size() - 1, 'r')));
            tabular.rule("toprule");
            std::vector<std::string> cells{"correlation"};
            for (std::size_t j = 0; j + 1 < own.size(); ++j) cells.push_back(nameOf(j));
            tabular.row(cells);
            tabular.rule("midrule");
            for (std::size_t i = 1; i < own.size(); ++i) {
                cells = {nameOf(i)};
                for (std::size_t j = 0; j + 1 < own.size(); ++j)
                    cells.push_back(j < i ? fmt::format("${:.3f}$", at(i, j)) : "");
                tabular.row(cells);
            }
            tabular.rule("bottomrule");
            return "\\par\\medskip\n" + tabular.text();
        }
        std::vector<std::string> pairs;
        std::size_t count = 0;
        for (std::size_t i = 0; i < own.size(); ++i)
            for (std::size_t j = i + 1; j < own.size(); ++j)
                if (std::abs(at(i, j)) > strong && ++count <= mostPairs)
                    pairs.push_back(
                        fmt::format("{} and {} ${:.3f}$", nameOf(i), nameOf(j), at(i, j)));
        return fmt::format(
            "\\par\\smallskip Correlations beyond {}: {}{}.\n", strong,
            count == 0 ? "none" : fmt::format("{}", fmt::join(pairs, ", ")),
            count > mostPairs ? fmt::format(", and {} more", count - mostPairs) : std::string());
    }

    std::string instrument() const {
        if (!result_.instrument) return {};
        std::vector<std::string> terms;
        for (const auto& [name, text] : instrumentRows(*result_.instrument))
            terms.push_back(fmt::format("{}: {}", latexText(name), latexText(text)));
        return fmt::format("\\par\\smallskip Instrument: {}.\n", fmt::join(terms, "; "));
    }

    std::string notes() const {
        constexpr std::array<std::string_view, 3> texts{"at its lower bound", "at its upper bound",
                                                        "not determined by the data"};
        std::vector<std::string> lines;
        for (std::size_t k = 0; k < texts.size(); ++k)
            if (marks_[k])
                lines.push_back(fmt::format("\\textsuperscript{{{}}} {}",
                                            static_cast<char>('a' + k), texts[k]));
        std::string text;
        if (!routes_.empty())
            text = fmt::format(
                "\\par\\smallskip Standard uncertainties $u$ in units of the last digits (route: "
                "{}{}); $U = k u$ holds the value with {:.4g}\\,\\%.\n",
                fmt::join(routes_, " or "), result_.budget ? ", combined with the budget" : "",
                100 * Budget::probability);
        return lines.empty() ? text
                             : text + fmt::format("\\par\\smallskip {}.\n", fmt::join(lines, "; "));
    }

    std::string statistics() const {
        const std::optional<Uncertainty>& own = result_.uncertainty;
        std::string fitness;
        if (own && own->stated) {
            fitness = fmt::format("$\\chi^2/\\nu = {}/{} = {}$", latexValue(own->chiSquare, 5),
                                  own->degreesOfFreedom, latexValue(own->reducedChiSquare(), 4));
            // Below the least double, the probability is known to be less.
            if (own->probability)
                fitness += *own->probability > 0
                               ? fmt::format(", probability ${}$", latexValue(*own->probability, 3))
                               : ", probability below $10^{-300}$";
        } else {
            fitness =
                fmt::format("root mean square residual ${}$ by the loss {}",
                            latexValue(result_.loss, 4), latexText(lossName(report_.options.loss)));
            if (own)
                fitness +=
                    fmt::format(", variance of residuals ${}$ over {} degrees of freedom",
                                latexValue(own->reducedChiSquare(), 4), own->degreesOfFreedom);
        }
        std::string text =
            fmt::format("\\par\\smallskip {}; $N = {}$ samples, {} values; {}",
                        latexText(result_.model), result_.samples, result_.values, fitness);
        if (!report_.sigma.empty())
            text +=
                fmt::format("; standard uncertainties of the data: {}", latexText(report_.sigma));
        if (!report_.scans.empty()) text += fmt::format("; scans: {}", latexText(report_.scans));
        return text + fmt::format("; data: {}.\n", latexText(report_.data));
    }

    const FitReport& report_;
    const FitResult& result_;
    std::array<bool, 3> marks_{};
    std::set<std::string_view> routes_;
};

/// Signs of plainValue, which the fonts of LaTeX do not have.
constexpr std::array<std::string_view, 2> signs[] = {{"×", "$\\times$"},
                                                     {"−", "$-$"},
                                                     {"∞", "$\\infty$"},
                                                     {"⁻", "\\textsuperscript{-}"},
                                                     {"⁰", "\\textsuperscript{0}"},
                                                     {"¹", "\\textsuperscript{1}"},
                                                     {"²", "\\textsuperscript{2}"},
                                                     {"³", "\\textsuperscript{3}"},
                                                     {"⁴", "\\textsuperscript{4}"},
                                                     {"⁵", "\\textsuperscript{5}"},
                                                     {"⁶", "\\textsuperscript{6}"},
                                                     {"⁷", "\\textsuperscript{7}"},
                                                     {"⁸", "\\textsuperscript{8}"},
                                                     {"⁹", "\\textsuperscript{9}"}};

}  // namespace

std::string latexText(std::string_view text) {
    std::string out;
    const std::string shown = printable(text);
    for (std::size_t k = 0; k < shown.size(); ++k) {
        const char c = shown[k];
        const auto sign = std::ranges::find_if(
            signs, [&](const auto& own) { return shown.compare(k, own[0].size(), own[0]) == 0; });
        if (sign != std::end(signs)) {
            out += (*sign)[1];
            k += (*sign)[0].size() - 1;
            continue;
        }
        switch (c) {
            case '\\':
                out += "\\textbackslash{}";
                break;
            case '~':
                out += "\\textasciitilde{}";
                break;
            case '^':
                out += "\\textasciicircum{}";
                break;
            case '<':
                out += "\\ensuremath{<}";
                break;
            case '>':
                out += "\\ensuremath{>}";
                break;
            case '|':
                out += "\\ensuremath{|}";
                break;
            case '"':
                out += "\\char34{}";
                break;
            case '\'':
                out += "\\char39{}";
                break;
            case '`':
                out += "\\char96{}";
                break;
            case '-':
                out += "-{}";  // no ligature of two
                break;
            default:
                if (std::string_view("{}$&#_%").find(c) != std::string_view::npos) out += '\\';
                out += c;
        }
    }
    return out;
}

std::string latexTable(const FitReport& report) {
    return Table(report).text();
}

}  // namespace hshfit::brdfs
