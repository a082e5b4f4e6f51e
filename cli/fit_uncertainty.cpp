#include "fit_uncertainty.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace hshfit::cli {
namespace {

using Document = nlohmann::ordered_json;

std::string number(const Document& value) {
    return value.is_number() ? fmt::format("{:.3g}", value.get<double>()) : "-";
}

std::string interval(const Document& ends) {
    const auto end = [](const Document& value) {
        return value.is_number() ? fmt::format("{:.6g}", value.get<double>()) : "bound";
    };
    return fmt::format("{} to {}", end(ends[0]), end(ends[1]));
}

std::string chiSquareLine(const Document& uncertainty) {
    const auto degrees = uncertainty["degrees_of_freedom"].get<std::size_t>();
    if (!uncertainty["chi_square"].is_number())
        return fmt::format("  variance of residuals {:.6g} over {} degrees of freedom\n",
                           uncertainty["residual_variance"].get<double>(), degrees);
    std::string line = fmt::format("  chi-square {:.6g} over {} degrees of freedom, {:.4g} each",
                                   uncertainty["chi_square"].get<double>(), degrees,
                                   uncertainty["reduced_chi_square"].get<double>());
    if (uncertainty["probability"].is_number())
        line += fmt::format(", probability {:.3g}", uncertainty["probability"].get<double>());
    if (uncertainty.contains("correlation"))
        line +=
            uncertainty["correlation"]["used_in"] == "fit"
                ? "\n  weights, chi-square and errors by the stated correlation"
                : "\n  errors by the stated correlation; weights are those of independent values";
    return line + "\n";
}

/// Whether a parameter is the scale, or the zero of an angle, of one scan.
bool isOfScan(const Document& parameter) {
    const auto name = parameter["name"].get<std::string>();
    const std::size_t blank = name.rfind(' ');
    return blank != name.npos && name.find_first_not_of("0123456789", blank + 1) == name.npos;
}

/// The errors of every parameter, a column for each route.
std::string errorTable(const Document& uncertainty) {
    const bool scans = uncertainty.contains("scans"),
               correlated = uncertainty.contains("correlation"),
               bootstrap = uncertainty.contains("bootstrap");
    std::string lines =
        fmt::format("  {:<27} {:>10} {:>10}{}{}{}\n", "standard errors", "normal", "sandwich",
                    correlated ? " correlated" : "", scans ? "    by scan   df" : "",
                    bootstrap ? "  bootstrap" : "");
    for (const Document& own : uncertainty["parameters"]) {
        // There may be hundreds of scans; FIT.json has them all.
        if (isOfScan(own)) continue;
        lines +=
            fmt::format("  {:<24} {:>2} {:>10} {:>10}", own["name"].get<std::string>(),
                        own.value("channel", ""), number(own["normal"]), number(own["sandwich"]));
        if (correlated)
            lines += fmt::format(" {:>10}", number(own.value("correlated", Document())));
        if (scans) {
            const auto student = own.find("scans_student");
            lines += fmt::format(
                " {:>10} {:>4}", number(own["scans"]),
                student == own.end()
                    ? std::string("-")
                    : fmt::format("{:.0f}", (*student)["degrees_of_freedom"].get<double>()));
        }
        if (own.contains("bootstrap"))
            lines += fmt::format(" {:>10}", number(own["bootstrap"]["standard_error"]));
        lines += '\n';
    }
    return lines;
}

/// The reason why there are no errors by scan; empty where there are.
std::string reasonLine(const Document& uncertainty) {
    const auto scans = uncertainty.find("scans");
    if (scans == uncertainty.end() || !scans->contains("reason")) return {};
    return fmt::format("  {}\n", (*scans)["reason"].get<std::string>());
}

/// The pairs of parameters whose errors are nearly one.
std::string correlationLine(const Document& uncertainty) {
    constexpr double strong = 0.95;
    constexpr std::size_t most = 5;
    const Document &parameters = uncertainty["parameters"],
                   &correlations = uncertainty["correlations"];
    const auto nameOf = [&](std::size_t i) {
        const std::string channel = parameters[i].value("channel", "");
        return parameters[i]["name"].get<std::string>() + (channel.empty() ? "" : " " + channel);
    };
    std::vector<std::string> pairs;
    std::size_t count = 0;
    for (std::size_t i = 0; i < parameters.size(); ++i)
        for (std::size_t j = i + 1; j < parameters.size(); ++j) {
            const double value = correlations[i][j].get<double>();
            if (std::abs(value) <= strong || ++count > most) continue;
            pairs.push_back(fmt::format("{} and {} ({:.3f})", nameOf(i), nameOf(j), value));
        }
    if (count == 0) return {};
    return fmt::format("  correlated beyond {}: {}{}\n", strong, fmt::join(pairs, ", "),
                       count > most ? fmt::format(", and {} more", count - most) : "");
}

/// The budget of each parameter: a line for each contribution.
std::string budgetText(const Document& budget) {
    const auto degreesText = [](const Document& degrees) {
        return degrees.is_number() ? fmt::format("{:.1f}", degrees.get<double>())
                                   : std::string("infinite");
    };
    std::string lines;
    for (const Document& own : budget["parameters"]) {
        if (isOfScan(own)) continue;
        const std::string channel = own.value("channel", "");
        lines += fmt::format(
            "  {}{} = {:.6g}, U = {:.3g} (k = {:.3g} for {:.4g} %, {} degrees of freedom)\n",
            own["name"].get<std::string>(), channel.empty() ? "" : " " + channel,
            own["value"].get<double>(), own["expanded_uncertainty"].get<double>(),
            own["coverage_factor"].get<double>(),
            100 * budget["coverage_probability"].get<double>(),
            degreesText(own["effective_degrees_of_freedom"]));
        lines += fmt::format("    {:<22} {:<4} {:<12} {:>16} {:>11} {:>12} {:>7} {:>8}\n",
                             "contribution", "type", "distribution", "uncertainty", "sensitivity",
                             "contribution", "share", "degrees");
        for (const Document& row : own["contributions"]) {
            const std::string unit = row.value("unit", "");
            lines += fmt::format(
                "    {:<22} {:<4} {:<12} {:>16} {:>11.4g} {:>12.3g} {:>5.1f} % {:>8}\n",
                row["name"].get<std::string>(), row["type"].get<std::string>(),
                row["distribution"].get<std::string>(),
                fmt::format("{:.3g}{}", row["standard_uncertainty"].get<double>(),
                            unit.empty() || unit == "1" ? "" : " " + unit),
                row["sensitivity"].get<double>(), row["contribution"].get<double>(),
                100 * row["share"].get<double>(), degreesText(row["degrees_of_freedom"]));
        }
    }
    return lines;
}

std::string profileTable(const Document& uncertainty) {
    std::string lines;
    for (const Document& own : uncertainty["parameters"]) {
        if (!own.contains("profile")) continue;
        const Document& profile = own["profile"];
        lines += fmt::format("  {:<24} {:>2} 68 %: {}; 95 %: {}{}\n",
                             own["name"].get<std::string>(), own.value("channel", ""),
                             interval(profile["interval_68"]), interval(profile["interval_95"]),
                             profile["quadratic"].get<bool>() ? "" : "; not quadratic");
    }
    return lines.empty() ? lines : "  profile likelihood\n" + lines;
}

std::string places(const Document& values, const char* size, const std::string& unit) {
    constexpr std::size_t most = 5;
    std::vector<std::string> parts;
    for (std::size_t i = 0; i < std::min(most, values.size()); ++i) {
        const Document& own = values[i];
        const std::string channel = own.value("channel", "");
        parts.push_back(fmt::format("{} {}{}{} ({:.3g})", unit, own["row"].get<std::size_t>(),
                                    channel.empty() ? "" : " at ", channel,
                                    own[size].get<double>()));
    }
    return fmt::format("{}", fmt::join(parts, ", "));
}

std::string influenceText(const Document& influence) {
    const std::string unit = influence["rows"] == "lines" ? "line" : "sample";
    const auto count = influence["outlier_count"].get<std::size_t>();
    std::string lines =
        fmt::format("  {} {} with a studentised residual beyond {:.3g}{}\n", count,
                    count == 1 ? "outlier" : "outliers", influence["outlier_bound"].get<double>(),
                    count == 0 ? "" : ": " + places(influence["outliers"], "studentised", unit));
    return lines + fmt::format("  most influential (Cook's distance): {}\n",
                               places(influence["most_influential"], "cook", unit));
}

std::string predictionLine(const Document& prediction, const std::string& unit) {
    const Document& worst = prediction["largest_relative_error"];
    const std::string channel = worst.value("channel", "");
    return fmt::format(
        "  standard error of the fitted f ({}) {:.3g} of f in the root mean square, most at {} "
        "{}{}: {:.4g} +- {:.2g}\n",
        prediction["route"] == "scans" ? "by scan" : prediction["route"].get<std::string>(),
        prediction["rms_relative_error"].get<double>(), unit, worst["row"].get<std::size_t>(),
        channel.empty() ? "" : " at " + channel, worst["model"].get<double>(),
        worst["standard_error"].get<double>());
}

std::string bandsLine(const Document& bands) {
    return fmt::format(
        "  bands at {} pairs: 95 % at one of them within at most {:.4g} standard errors, at all at "
        "once within {:.4g}\n",
        bands["count"].get<std::size_t>(), bands["pointwise_95"].get<double>(),
        bands["simultaneous_95"].get<double>());
}

}  // namespace

std::string uncertaintyText(const Document& fit) {
    const std::string bands = fit.contains("bands") ? bandsLine(fit["bands"]) : "";
    if (!fit.contains("uncertainty")) return bands;
    const Document& uncertainty = fit["uncertainty"];
    std::string lines =
        chiSquareLine(uncertainty) + errorTable(uncertainty) + reasonLine(uncertainty);
    if (uncertainty.contains("bootstrap")) {
        const Document& bootstrap = uncertainty["bootstrap"];
        lines += fmt::format(
            "  {} fits to resampled {}, {} failed\n", bootstrap["draws"].get<std::size_t>(),
            bootstrap["of"].get<std::string>(), bootstrap["failed"].get<std::size_t>());
    }
    return lines + correlationLine(uncertainty) + profileTable(uncertainty) +
           (uncertainty.contains("prediction")
                ? predictionLine(uncertainty["prediction"],
                                 fit["influence"]["rows"] == "lines" ? "line" : "sample")
                : "") +
           bands + influenceText(fit["influence"]) +
           (fit.contains("budget") ? budgetText(fit["budget"]) : "");
}

}  // namespace hshfit::cli
