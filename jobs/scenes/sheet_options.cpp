#include "sheet_options.h"

#include <jobs/common/enum_words.h>
#include <jobs/common/option_words.h>

#include <hshfit/error.h>
#include <hshfit/wording.h>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace hshfit::jobs {
namespace {

using options::at;
using options::spelled;

constexpr EnumWord ways[] = {{"coefficients"}, {"integration"}, {"both"}};
constexpr EnumWord upAxes[] = {{"y"}, {"z"}};
using Ways = EnumWords<ways, RenderOptions::By>;
using UpAxes = EnumWords<upAxes, RenderOptions::Up>;

/// The point light of "THETA,PHI" or "THETA,PHI,STRENGTH".
SphereLight pointLight(const std::string& text) {
    constexpr std::string_view member = "SheetOptions::light",
                               form =
                                   "THETA,PHI or THETA,PHI,STRENGTH: degrees from the line of "
                                   "sight (0 to 180), degrees from the right counterclockwise, "
                                   "strength (for example 45,135,1); or a kind of light or the "
                                   "path of a picture";
    std::vector<double> numbers = numbersIn(text, 2, 3, member, form);
    numbers.resize(3, 1);
    if (!(numbers[0] >= 0 && numbers[0] <= 180 && numbers[2] >= 0))
        throw UsageError(fmt::format("{} '{}': give {}", Setting{member}, text, form));
    return {directionFromAngles(radians(numbers[0]), radians(numbers[1])), numbers[2]};
}

/// Whether a light begins like numbers; others are kinds of light and paths.
bool isPoint(const std::string& text) {
    double first = 0;
    const char* end = text.data() + text.size();
    const auto [next, error] = std::from_chars(text.data(), end, first);
    if (error != std::errc() || (next != end && *next != ',')) return text.size() < 2;
    return true;
}

constexpr Bounds<double> stops{-100, 100};

/// None for "auto".
std::optional<double> exposureIn(const std::string& text) {
    constexpr std::string_view member = "RenderOptions::exposure",
                               form = "auto or stops (for example -1.5)";
    if (text == "auto") return std::nullopt;
    const double number =
        numbersIn(text.starts_with('+') ? text.substr(1) : text, 1, 1, member, form)[0];
    if (!(number >= stops.least && number <= stops.most))
        throw UsageError(fmt::format("{} '{}': give {}", Setting{member}, text, form));
    return number;
}
std::string exposureText(double number) {
    return fmt::format("{}", number);
}

Angles viewIn(const std::string& text) {
    return anglesIn(text, "RenderOptions::view", 180);
}

constexpr OptionRow sheetRows[] = {
    OptionRow{"size", at<&SheetOptions::surfaces, &RenderOptions::size>,
              "Pixels along a picture's square"}
        .within(bounds::pictureSize),
    OptionRow{"samples", at<&SheetOptions::samples>,
              "N: N x N samples a pixel (default: 3; 2 under other than point lights)"}
        .within(bounds::pictureSamples),
    OptionRow{"light", at<&SheetOptions::light>,
              "A light, sky or picture, added up with '+'; or THETA,PHI[,STRENGTH] in degrees "
              "about the line of sight; again for more lights (default: 45,135,1 and "
              "75,-30,0.25)"}
        .takes({.syntax = Syntax::light, .files = Files::read, .dash = ""}),
    OptionRow{"dome", at<&SheetOptions::dome>,
              "Radiance from all around (default: 0.1 with point lights, else 0)"}
        .within(bounds::dome),
    OptionRow{"exposure",
              spelled<exposureIn, exposureText, &SheetOptions::surfaces, &RenderOptions::exposure>,
              "auto or stops; for .png only"}
        .takes({.syntax = Syntax::numbers})
        .byDefault("auto"),
    OptionRow{"mesh", at<&SheetOptions::surfaces, &RenderOptions::mesh>,
              "OBJ, PLY or glTF file in the place of the sphere"}
        .takes({.files = Files::read})
        .onlyFor(sheets::surfaces),
    OptionRow{"up",
              spelled<UpAxes::parse, UpAxes::name, &SheetOptions::surfaces, &RenderOptions::up>,
              "The mesh's axis that points up"}
        .takes({.words = UpAxes::words, .complete = true})
        .onlyFor(sheets::details),
    OptionRow{"view", spelled<viewIn, anglesText, &SheetOptions::surfaces, &RenderOptions::view>,
              "THETA,PHI: the direction to the viewer, degrees from the zenith and from +x towards "
              "+y"}
        .takes({.syntax = Syntax::numbers})
        .onlyFor(sheets::surfaces),
    OptionRow{"field-of-view", at<&SheetOptions::surfaces, &RenderOptions::fieldOfView>,
              "Degrees from edge to edge of a perspective picture (default: lines of sight are "
              "parallel)"}
        .within(bounds::fieldOfView)
        .onlyFor(sheets::surfaces),
    OptionRow{"by", spelled<Ways::parse, Ways::name, &SheetOptions::surfaces, &RenderOptions::by>,
              "The way in which light and material meet"}
        .takes({.words = Ways::words, .complete = true})
        .onlyFor(sheets::surfaces),
    OptionRow{"basis", at<&SheetOptions::surfaces, &RenderOptions::bases>,
              "Bases of the coefficients, a column each (default: hsh)"}
        .takes({basisWords, Syntax::list})
        .orNamed("bases")
        .inPython("bases")
        .onlyFor(sheets::surfaces),
    OptionRow{"order", at<&SheetOptions::surfaces, &RenderOptions::orders>,
              "Their numbers of bands, a column each (default: 10)"}
        .takes({.syntax = Syntax::list})
        .orNamed("orders")
        .inPython("orders")
        .onlyFor(sheets::surfaces),
    OptionRow{"cosine", at<&SheetOptions::surfaces, &RenderOptions::cosine>,
              "Coefficients of f cos(theta_i)"}
        .onlyFor(sheets::details),
    OptionRow{"outgoing", at<&SheetOptions::surfaces, &RenderOptions::outgoing>,
              "Outgoing directions of the coefficients, interpolated in between (default: 64 if "
              "isotropic, else 48x48)"}
        .takes({.syntax = Syntax::outgoing})
        .onlyFor(sheets::details),
    OptionRow{"exposures", at<&SheetOptions::surfaces, &RenderOptions::exposures>,
              "Stops, a column each: -2,0,2 (default: 0)"}
        .within(stops)
        .takes({.syntax = Syntax::list})
        .onlyFor(sheets::surfaces),
    OptionRow{"tolerance", at<&SheetOptions::surfaces, &RenderOptions::tolerance>,
              "Bound of the integration's error, as 1% or 0.01 (default: 5% by integration alone, "
              "0.5% beside coefficients)"}
        .within(bounds::pictureTolerance)
        .in(Unit::percent)
        .orNamed("error")
        .onlyFor(sheets::details),
    OptionRow{"seconds", at<&SheetOptions::surfaces, &RenderOptions::seconds>,
              "End integration after that time with the best picture so far, after a first pass "
              "over all pixels to an error of 50% (default: no end)"}
        .within(bounds::seconds)
        .onlyFor(sheets::surfaces),
};

}  // namespace

OptionRows<SheetOptions> sheetOptions() {
    return {sheetRows};
}

void refuseDetail(std::string_view option) {
    throw UsageError(
        fmt::format("render: {} is not for spheres in point lights, but beside {}, {}, {}, {} or "
                    "another light",
                    option, Setting{"RenderOptions::mesh"}, Setting{"RenderOptions::by"},
                    Setting{"RenderOptions::bases"}, Setting{"RenderOptions::orders"}));
}

std::variant<SphereSheetOptions, RenderOptions> sheetOf(const SheetOptions& asked, bool surface) {
    RenderOptions options = asked.surfaces;
    for (const std::string& light : asked.light) {
        if (isPoint(light))
            options.rig.lights.push_back(pointLight(light));
        else
            options.lights.push_back(light);
    }
    if (asked.light.empty()) options.rig = SphereRig{};
    const double dome = options.lights.empty() ? SphereRig{}.dome : 0;
    options.rig.dome = asked.dome.value_or(dome);
    if (asked.samples) options.samples = static_cast<int>(*asked.samples);
    if (surface || !options.lights.empty()) return options;
    return SphereSheetOptions{
        .rig = options.rig,
        .size = options.size,
        .samples = asked.samples ? options.samples : SphereSheetOptions{}.samples,
        .exposure = options.exposure};
}

}  // namespace hshfit::jobs
