#include <brdfs/catalog.h>
#include <brdfs/fit/latex_table.h>
#include <brdfs/fit/split_models.h>
#include <brdfs/spec.h>
#include <hshfit/files/printable.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace hshfit::brdfs {
namespace {

/// The power of ten of the first digit of a number that is not 0, once rounded to so many digits.
int powerOf(double number, int digits) {
    const std::string text = fmt::format("{:.{}e}", std::abs(number), digits - 1);
    const std::size_t e = text.find('e');
    int power = 0;
    std::from_chars(text.data() + e + (text[e + 1] == '+' ? 2 : 1), text.data() + text.size(),
                    power);
    return power;
}

std::string withPower(const std::string& number, int power) {
    return power == 0 ? number : fmt::format("{}\\times10^{{{}}}", number, power);
}

/// A number without an error.
std::string bareNumber(double value, int digits = 6) {
    if (!std::isfinite(value))
        return std::isnan(value) ? "\\mathrm{nan}" : value > 0 ? "\\infty" : "-\\infty";
    std::string text = fmt::format("{:.{}g}", value, digits);
    const std::size_t e = text.find('e');
    if (e == text.npos) return text;
    int power = 0;
    std::from_chars(text.data() + e + (text[e + 1] == '+' ? 2 : 1), text.data() + text.size(),
                    power);
    return withPower(text.substr(0, e), power);
}

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

/// Of a coefficient of a law over the wavelength in micrometres, "ior.B" or "ior.C1"; none of other
/// parameters.
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

/// "ggx.alpha" of "lambert+ggx": the term, whose number follows its name where there are several,
/// and the key.
std::string unitOf(const FitResult& result, const std::string& name) {
    if (const auto unit = unitOfLaw(result, name)) return *unit;
    const std::string parameter = name.substr(0, name.find('@'));  // of a coefficient of a spline
    const std::vector<std::string> terms = splitModels(result.model);
    const std::size_t dot = parameter.find('.');
    if (dot == parameter.npos) return unitOf(terms.front(), parameter);
    const std::string model = parameter.substr(0, dot), key = parameter.substr(dot + 1);
    for (const std::string& term : terms)
        if (model.starts_with(term.substr(0, term.find(':')))) return unitOf(term, key);
    return "1";
}

/// Of the instrument, an offset and a dark signal are in the unit of f, the others are shares.
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
        return text + notes() + statistics();
    }

private:
    std::string valueOf(const FittedParameter& p) {
        if (p.standardError) return fmt::format("${}$", latexNumber(p.value, *p.standardError));
        char mark = 'c';
        if (!p.bound.empty()) mark = p.bound == "lower" ? 'a' : 'b';
        marks_[static_cast<std::size_t>(mark - 'a')] = true;
        return fmt::format("${}^{{{}}}$", bareNumber(p.value), mark);
    }

    std::string shared() {
        Tabular tabular("lrl");
        tabular.rule("toprule");
        tabular.row({"parameter", "value", "unit"});
        tabular.rule("midrule");
        bool any = false;
        for (const FittedParameter& p : result_.parameters) {
            if (!p.channel.empty() || p.isScanScale()) continue;
            tabular.row({latexText(p.name), valueOf(p), unitOf(result_, p)});
            any = true;
        }
        tabular.rule("bottomrule");
        return any ? tabular.text() : std::string();
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
        return "\\par\\medskip\n" + tabular.text();
    }

    std::string notes() const {
        constexpr std::array<std::string_view, 3> texts{"at its lower bound", "at its upper bound",
                                                        "not determined by the data"};
        std::vector<std::string> lines;
        for (std::size_t k = 0; k < texts.size(); ++k)
            if (marks_[k])
                lines.push_back(fmt::format("$^{{{}}}$ {}", static_cast<char>('a' + k), texts[k]));
        return lines.empty() ? std::string()
                             : fmt::format("\\par\\smallskip {}.\n", fmt::join(lines, "; "));
    }

    std::string statistics() const {
        const std::optional<Uncertainty>& own = result_.uncertainty;
        std::string fitness;
        if (own && own->stated) {
            fitness = fmt::format("$\\chi^2/\\nu = {}/{} = {}$", bareNumber(own->chiSquare, 5),
                                  own->degreesOfFreedom, bareNumber(own->reducedChiSquare(), 4));
            // Below the least double, the probability is known to be less.
            if (own->probability)
                fitness += *own->probability > 0
                               ? fmt::format(", probability ${}$", bareNumber(*own->probability, 3))
                               : ", probability below $10^{-300}$";
        } else {
            fitness =
                fmt::format("root mean square residual ${}$ by the loss {}",
                            bareNumber(result_.loss, 4), latexText(lossName(report_.options.loss)));
        }
        std::string text =
            fmt::format("\\par\\smallskip {}; $N = {}$ samples, {} values; {}",
                        latexText(result_.model), result_.samples, result_.values, fitness);
        if (!report_.sigma.empty())
            text +=
                fmt::format("; standard uncertainties of the data: {}", latexText(report_.sigma));
        return text + fmt::format("; data: {}.\n", latexText(report_.data));
    }

    const FitReport& report_;
    const FitResult& result_;
    std::array<bool, 3> marks_{};
};

}  // namespace

std::string latexNumber(double value, double error) {
    if (!std::isfinite(value) || !std::isfinite(error) || !(error > 0)) return bareNumber(value);
    const int last = powerOf(error, 2) - 1;  // of the second digit of the error
    const double unit = std::pow(10, last), rounded = std::round(value / unit) * unit;
    const int first = rounded == 0 ? last + 1 : std::max(powerOf(rounded, 15), last + 1);
    constexpr int mostDigits = 9, leastFixed = -3, mostFixed = 5;
    if (first - last >= mostDigits)
        return bareNumber(value) + fmt::format("\\pm {}", bareNumber(error, 2));
    const bool fixed = last <= 0 && first >= leastFixed && first < mostFixed;
    const int power = fixed ? 0 : first;
    const int decimals = power - last;
    return withPower(
        fmt::format("{:.{}f}({:.0f})", value / std::pow(10, power), decimals, error / unit), power);
}

std::string latexText(std::string_view text) {
    std::string out;
    for (const char c : printable(text)) {
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
