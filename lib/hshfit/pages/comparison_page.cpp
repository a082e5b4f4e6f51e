#include <hshfit/files/checksum.h>
#include <hshfit/files/template_text.h>
#include <hshfit/pages/internal/comparison_files.h>
#include <hshfit/pages/page_figures.h>
#include <hshfit/pages/report_files.h>
#include <hshfit/pictures/sphere_picture.h>
#include <hshfit/version.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <string_view>

namespace hshfit::embedded {
extern const std::string_view comparison_html;
}

namespace hshfit::inline pages {

namespace {

using kainjow::mustache::data;

/// Characters of a name that has a cell of its own.
constexpr std::size_t longestName = 2000;

std::string directionText(const Direction& d) {
    return fmt::format("θ {:.1f}°, φ {:.1f}°", degrees(polarAngle(d)), degrees(azimuth(d)));
}

std::string lawsText(const Laws& laws) {
    std::vector<std::string> words{laws.isotropic ? "isotropic" : "anisotropic"};
    if (laws.reciprocal) words.emplace_back("reciprocal");
    if (laws.nonNegative) words.emplace_back("not negative");
    if (laws.energyConserving) words.emplace_back("conserves energy");
    return fmt::format("{}", fmt::join(words, ", "));
}

std::string channelsText(const Channels& channels) {
    const auto names = channels.names();
    if (names.size() <= 6) return fmt::format("{}", fmt::join(names, ", "));
    return fmt::format("{} wavelengths, {} to {}", names.size(), names.front(), names.back());
}

data sideData(const ComparedBrdf& side, const SpherePicture& sphere) {
    data fields;
    fields.set("name", shortName(side.name, longestName));
    fields.set("channels", channelsText(side.channels));
    fields.set("laws", lawsText(side.laws));
    fields.set("colours", sphere.colours);
    fields.set("albedoError", fmt::format("{:.1e}", side.albedoError));
    if (side.notFinite > 0) fields.set("notFinite", std::to_string(side.notFinite));
    return fields;
}

data metricRows(const std::vector<MetricValue>& metrics) {
    data rows{data::type::list};
    for (const MetricValue& result : metrics) {
        data row;
        row.set("name", std::string(result.metric->name));
        row.set("help", std::string(result.metric->help));
        if (!result.metric->source.empty()) row.set("source", std::string(result.metric->source));
        if (result.value) {
            row.set("value", fmt::format("{:.5g}", *result.value));
            row.set("error", fmt::format("{:.1e}", result.error));
        } else {
            row.set("reason", shortName(result.reason, longestName));
        }
        std::string where;
        if (result.wi) where += "ωi " + directionText(*result.wi) + "; ";
        if (result.wo) where += "ωo " + directionText(*result.wo);
        row.set("where", where);
        rows.push_back(row);
    }
    return rows;
}

data residualData(const Comparison& comparison) {
    const ResidualShares shares = residualShares(comparison);
    data fields;
    fields.set("cells", std::to_string(shares.cells));
    fields.set("unmeasured", std::to_string(shares.unmeasured));
    fields.set("noRatio", std::to_string(shares.noRatio));
    fields.set("any", shares.cells > shares.noRatio);
    fields.set("median", fmt::format("{:.3g}", std::pow(10, shares.median)));
    fields.set("most", fmt::format("{:.3g}", std::pow(10, shares.most)));
    fields.set("tenth", fmt::format("{:.0f}", 100 * shares.withinTenth));
    fields.set("twofold", fmt::format("{:.0f}", 100 * shares.withinTwofold));
    return fields;
}

/// The left ends of the columns of panels, as comparison.gp places them.
std::span<const int> columnsOfKind(std::string_view kind) {
    static constexpr std::array polar{0, 550}, residual{0, 633};
    static constexpr std::array half{0, 371, 731};
    if (kind == "polar") return polar;
    return kind == "half" ? std::span<const int>(half) : residual;
}

/// One entry an azimuth, with its three figures.
data azimuthData(const Comparison& comparison, const std::vector<std::string>& figures) {
    data azimuths{data::type::list};
    const auto files = figuresOf(comparison);
    for (std::size_t i = 0; i < files.size(); i += 3) {
        data entry;
        entry.set("azimuth", fmt::format("{}", files[i].azimuth));
        for (std::size_t k = i; k < i + 3 && k < figures.size(); ++k) {
            const std::string_view kind = files[k].kind;
            entry.set(files[k].kind, inlinedFigure(figures[k], k + 1, columnsOfKind(kind)));
        }
        azimuths.push_back(entry);
    }
    return azimuths;
}

data rigData(const SphereRig& rig) {
    data lights{data::type::list};
    for (const SphereLight& light : rig.lights) {
        data fields;
        fields.set("theta", fmt::format("{:.4g}", degrees(polarAngle(light.towards))));
        fields.set("phi", fmt::format("{:.4g}", degrees(azimuth(light.towards))));
        fields.set("strength", fmt::format("{:g}", light.strength));
        lights.push_back(fields);
    }
    return lights;
}

/// The lines of the picture error, each a sentence of a list.
data pictureLines(const PictureError& picture) {
    data lines{data::type::list};
    const std::string text = textOf(picture);
    for (std::size_t at = 0, end = 0; at < text.size(); at = end + 1) {
        end = std::min(text.find('\n', at), text.size());
        lines.push_back(data("text", text.substr(at, end - at)));
    }
    return lines;
}

}  // namespace

std::string comparisonPage(const Comparison& comparison, const std::vector<std::string>& figures,
                           const std::string& spheres, const std::string& opening) {
    data page;
    page.set("opening", opening);
    page.set("generator", std::string("hshfit ") + version);
    page.set("style", std::string(pageStyle()));
    page.set("plotter", figures.empty() ? "gnuplot" : plotterOf(figures.front()));
    page.set("drawnFigures", !figures.empty());
    page.set("reference", sideData(comparison.reference, comparison.referenceSphere));
    page.set("approximation", sideData(comparison.approximation, comparison.approximationSphere));
    page.set("title", shortName(withoutFolders(comparison.approximation.name), 60) + " against " +
                          shortName(withoutFolders(comparison.reference.name), 60));
    page.set("outgoing", outgoingText(comparison.outgoing));
    page.set("oneDirection", comparison.outgoing.map == OutgoingSet::Map::direction);
    page.set("metrics", metricRows(comparison.metrics));
    page.set("anyPicture", comparison.picture.has_value());
    if (comparison.picture) page.set("picture", pictureLines(*comparison.picture));
    const auto names = comparison.channels.names();
    if (comparison.drawn.size() < names.size()) {
        std::vector<std::string> drawn;
        for (const std::size_t c : comparison.drawn) drawn.push_back(names[c]);
        page.set("drawn", fmt::format("{}", fmt::join(drawn, ", ")));
    }
    page.set("spheres", base64(spheres));
    page.set("lights", rigData(comparison.rig));
    page.set("dome", fmt::format("{:g}", comparison.rig.dome));
    page.set("stops", fmt::format("{:+.1f}", comparison.stops));
    page.set("amplification", fmt::format("{:g}", comparison.amplification));
    const double energy = meanSquare(comparison.referenceSphere);
    const double difference = meanSquare(comparison.difference);
    page.set("difference", difference == 0 ? "0"
                           : energy > 0
                               ? fmt::format("{:.3g} %", 100 * std::sqrt(difference / energy))
                               : "not defined");
    page.set("residual", residualData(comparison));
    page.set("azimuths", azimuthData(comparison, figures));
    page.set("several", comparison.residuals.size() > 1);
    data files{data::type::list};
    for (const char* name : {"comparison.json", "polar.csv", "half.csv", "residual.csv",
                             "albedo.csv", "spheres.png", "spheres.exr", "comparison.gp"}) {
        files.push_back(data("file", name));
    }
    if (!figures.empty()) {
        for (const auto& figure : figuresOf(comparison)) files.push_back(data("file", figure.file));
    }
    page.set("files", files);
    return filledPage(embedded::comparison_html, page);
}

}  // namespace hshfit::inline pages
