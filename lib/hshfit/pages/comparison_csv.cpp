#include <hshfit/pages/internal/comparison_files.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace hshfit::inline pages {
namespace {

std::string number(double value) {
    return std::isfinite(value) ? fmt::format("{}", value) : "";
}

std::string header(const Comparison& comparison, const std::string& angles) {
    std::string text = angles;
    const auto names = comparison.channels.names();
    for (const std::size_t c : comparison.drawn) {
        text += fmt::format(",reference {0},approximation {0}", names[c]);
    }
    return text + "\n";
}

void appendCurves(const std::vector<ComparisonCurve>& curves, bool sliced, std::string& text) {
    for (const ComparisonCurve& curve : curves) {
        for (std::size_t i = 0; i < curve.angles.size(); ++i) {
            text += number(curve.azimuth);
            const auto append = [&](double value) {
                text += ',';
                text += number(value);
            };
            if (sliced) append(curve.slice);
            append(curve.angles[i]);
            for (std::size_t c = 0; c < curve.reference.size(); ++c) {
                append(curve.reference[c][i]);
                append(curve.approximation[c][i]);
            }
            text += '\n';
        }
    }
}

/// The value that `share` of the sorted numbers do not exceed.
double quantile(const std::vector<double>& sorted, double share) {
    if (sorted.empty()) return 0;
    return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

}  // namespace

std::string polarCsv(const Comparison& comparison) {
    std::string text = header(comparison, "azimuth,theta_o,theta_i");
    appendCurves(comparison.polar, true, text);
    return text;
}

std::string halfCsv(const Comparison& comparison) {
    std::string text = header(comparison, "azimuth,theta_d,theta_h");
    appendCurves(comparison.half, true, text);
    return text;
}

std::string albedoCsv(const Comparison& comparison) {
    std::string text = header(comparison, "azimuth,theta_o");
    appendCurves(comparison.albedo, false, text);
    return text;
}

std::string residualCsv(const Comparison& comparison) {
    std::string text = "azimuth,theta_d,theta_h,log10_ratio,measured\n";
    for (const ResidualMap& map : comparison.residuals) {
        for (std::size_t cell = 0; cell < map.logRatio.size(); ++cell) {
            const std::size_t width = map.thetaHalf.size();
            fmt::format_to(std::back_inserter(text), "{},{},{},{},{}\n", number(map.azimuth),
                           map.thetaDifference[cell / width], map.thetaHalf[cell % width],
                           number(map.logRatio[cell]), map.measured[cell] ? 1 : 0);
        }
    }
    return text;
}

ResidualShares residualShares(const Comparison& comparison) {
    ResidualShares shares;
    std::vector<double> magnitudes;
    for (const ResidualMap& map : comparison.residuals) {
        for (std::size_t cell = 0; cell < map.logRatio.size(); ++cell) {
            if (!map.measured[cell]) {
                ++shares.unmeasured;
                continue;
            }
            ++shares.cells;
            if (std::isnan(map.logRatio[cell])) {
                ++shares.noRatio;
            } else {
                magnitudes.push_back(std::abs(map.logRatio[cell]));
            }
        }
    }
    std::sort(magnitudes.begin(), magnitudes.end());
    shares.median = quantile(magnitudes, 0.5);
    shares.most = quantile(magnitudes, 0.98);
    const auto within = [&](double ratio) {
        const auto end = std::upper_bound(magnitudes.begin(), magnitudes.end(), std::log10(ratio));
        return magnitudes.empty() ? 0
                                  : static_cast<double>(end - magnitudes.begin()) /
                                        static_cast<double>(magnitudes.size());
    };
    shares.withinTenth = within(1.1);
    shares.withinTwofold = within(2);
    return shares;
}

}  // namespace hshfit::inline pages
