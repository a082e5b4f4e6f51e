#include <hshfit/bases/catalog.h>
#include <hshfit/files/printable.h>
#include <hshfit/files/template_text.h>
#include <hshfit/pages/gnuplot.h>
#include <hshfit/pages/report_files.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <regex>
#include <string_view>

#include <fmt/format.h>

namespace hshfit::embedded {
extern const std::string_view curves_gp;
}

namespace hshfit::inline pages {

namespace {

using kainjow::mustache::data;

/// All bases of all entries, each once, in order of appearance.
std::vector<std::string> basesOf(const Report& report) {
    std::vector<std::string> names;
    for (const auto& entry : report.reports) {
        for (const auto& curve : entry.curves) {
            if (std::find(names.begin(), names.end(), curve.basis) == names.end()) {
                names.push_back(curve.basis);
            }
        }
    }
    return names;
}

/// The places, from 1, of the bases that have a curve in this entry: " 1 2 5 ".
std::string ownCurves(const ReportEntry& entry, const std::vector<std::string>& names) {
    std::string own = " ";
    for (std::size_t i = 0; i < names.size(); ++i) {
        const bool drawn = std::ranges::any_of(entry.curves, [&](const ReportCurve& curve) {
            return curve.basis == names[i] && firstReaching(curve, -HUGE_VAL);
        });
        if (drawn) own += fmt::format("{} ", i + 1);
    }
    return own;
}

/// The end of the axis of the missing share: below the best point at 50 %, 20 % or a power of ten,
/// but not below 1e-6, the default tolerance of a projection.
double leastMissing(const ReportEntry& entry) {
    double least = 1;
    for (const auto& curve : entry.curves) {
        for (const auto& point : curve.points) {
            if (point.accuracy) least = std::min(least, 1 - *point.accuracy);
        }
    }
    if (least > 0.2) return least > 0.5 ? 0.5 : 0.2;
    return least > 1e-6 ? std::pow(10, std::floor(std::log10(least))) : 1e-6;
}

/// `text` with line breaks instead of the spaces before `width` characters are exceeded.
std::string wrapped(const std::string& text, std::size_t width) {
    std::string out;
    std::size_t column = 0;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find(' ', at), text.size());
        if (column > 0) {
            const bool breaks = column + 1 + (end - at) > width;
            out += breaks ? '\n' : ' ';
            column = breaks ? 0 : column + 1;
        }
        out += text.substr(at, end - at);
        column += end - at;
        at = end + 1;
    }
    return out;
}

std::string titleOf(const ReportEntry& entry) {
    return fmt::format("{}\n{}, {}, energy {}", shortName(withoutFolders(entry.brdf), 60),
                       entry.quantity == Quantity::brdf ? "f" : "f cos θ",
                       outgoingText(entry.outgoing), energyText(entry.energy));
}

}  // namespace

bool hasAccuracy(const ReportEntry& entry) {
    for (const auto& curve : entry.curves) {
        for (const auto& point : curve.points) {
            if (point.accuracy) return true;
        }
    }
    return false;
}

bases::Style curveStyle(const std::string& basis) {
    if (basis == wavelets::sohoName) return {"#882255", 3, 12};
    return bases::find(basis).style;
}

std::string shortName(const std::string& brdf, std::size_t limit) {
    // A parameter with five decimals or more.
    static const std::regex number(R"(([=/*+] ?)(-?\d*\.\d{5,}(?:e[-+]?\d+)?)(?![\w.]))");
    const std::string text = printable(brdf);
    std::string few;
    auto rest = text.cbegin();
    for (std::sregex_iterator one(text.begin(), text.end(), number), end; one != end; ++one) {
        few.append(rest, (*one)[2].first);
        few += fmt::format("{:.4g}", std::strtod((*one)[2].str().c_str(), nullptr));
        rest = (*one)[2].second;
    }
    return shortened(few.append(rest, text.cend()), limit);
}

std::string withoutFolders(const std::string& brdf) {
    constexpr std::string_view ends = ":=,+*";
    std::string out;
    for (std::size_t at = 0; at < brdf.size();) {
        const std::size_t end = std::min(brdf.find_first_of(ends, at), brdf.size());
        std::string part = brdf.substr(at, end - at);
        const std::size_t slash = part.rfind('/'), dot = part.rfind('.');
        const bool file = slash != part.npos && dot != part.npos && dot > slash &&
                          dot + 1 < part.size() &&
                          std::isalpha(static_cast<unsigned char>(part[dot + 1]));
        if (file) {
            const std::size_t first = part.find_first_not_of(' ');
            part.erase(first, slash + 1 - first);
        }
        out += part;
        if (end < brdf.size()) out += brdf[end];
        at = end + 1;
    }
    return out;
}

std::string energyText(const Energy& energy) {
    if (!energy.finite || !std::isfinite(energy.value)) return "does not exist";
    return fmt::format("{:.6g} ± {:.1e}", energy.value, energy.error);
}

std::string outgoingText(const OutgoingSet& outgoing) {
    const std::string spec = outgoing.spec();
    switch (outgoing.map) {
        case OutgoingSet::Map::parabolic:
            return fmt::format("{} × {} parabolic map", outgoing.width, outgoing.height);
        case OutgoingSet::Map::elevations:
            return fmt::format("{} elevations", outgoing.width);
        case OutgoingSet::Map::direction:
            break;
    }
    const std::size_t comma = spec.find(',');
    return fmt::format("θ = {}°, φ = {}°", spec.substr(0, comma), spec.substr(comma + 1));
}

std::string reportScript(const Report& report) {
    data fields;
    fields.set("rows", std::to_string(std::max<std::size_t>(1, report.reports.size())));
    data entries{data::type::list};
    const auto names = basesOf(report);
    for (std::size_t i = 0; i < report.reports.size(); ++i) {
        const ReportEntry& entry = report.reports[i];
        int maxCount = 2, maxOrder = 2;
        for (const auto& curve : entry.curves) {
            for (const auto& point : curve.points) {
                maxCount = std::max(maxCount, point.coefficients);
                maxOrder = std::max(maxOrder, point.order);
            }
        }
        data row;
        row.set("index", std::to_string(i + 1));
        row.set("title", gnuplotString(titleOf(entry)));
        row.set(
            "reason",
            gnuplotString(hasAccuracy(entry) ? "" : wrapped(printable(entry.energy.reason), 48)));
        row.set("maxCount", std::to_string(maxCount));
        row.set("maxOrder", std::to_string(maxOrder));
        row.set("leastMissing", fmt::format("{:g}", leastMissing(entry)));
        row.set("own", gnuplotString(ownCurves(entry, names)));
        row.set("interval", std::to_string(std::max(1, maxOrder / 16)));
        entries.push_back(row);
    }
    fields.set("entries", entries);
    data lines{data::type::list};
    for (std::size_t i = 0; i < names.size(); ++i) {
        const bases::Style style = curveStyle(names[i]);
        data line;
        line.set("index", std::to_string(i + 1));
        line.set("colour", style.colour);
        line.set("dash", std::to_string(style.dash));
        line.set("point", std::to_string(style.mark));
        lines.push_back(line);
    }
    fields.set("styles", lines);
    fields.set("bases", fmt::format("{}", fmt::join(names, " ")));
    return filledPage(embedded::curves_gp, fields);
}

std::string reportCsv(const Report& report) {
    const auto quoted = [](const std::string& text) {
        std::string out = "\"";
        for (const char c : text) {
            out +=
                c == '"' ? "\"\"" : std::string(1, static_cast<unsigned char>(c) < ' ' ? ' ' : c);
        }
        return out + '"';
    };
    std::string out = "report,basis,order,coefficients,slots,accuracy,quantity,outgoing,brdf\n";
    for (std::size_t i = 0; i < report.reports.size(); ++i) {
        const ReportEntry& entry = report.reports[i];
        // The texts come last, so that gnuplot finds the columns before them for any text.
        const std::string texts = fmt::format("{},{},{}", quantityName(entry.quantity),
                                              quoted(entry.outgoing.spec()), quoted(entry.brdf));
        for (const auto& curve : entry.curves) {
            for (const auto& point : curve.points) {
                fmt::format_to(std::back_inserter(out), "{},{},{},{},{},{},{}\n", i + 1,
                               curve.basis, point.order, point.coefficients, point.slots,
                               point.accuracy ? fmt::format("{}", *point.accuracy) : "", texts);
            }
        }
    }
    return out;
}

}  // namespace hshfit::inline pages
