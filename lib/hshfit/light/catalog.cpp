#include <hshfit/light/catalog.h>

#include <hshfit/coefficient_files/coefficient_file.h>
#include <hshfit/coefficient_files/light_file.h>
#include <hshfit/error.h>
#include <hshfit/files/exr_header.h>
#include <hshfit/light/coefficient_light.h>
#include <hshfit/light/internal/hosek_wilkie_sky.h>
#include <hshfit/light/internal/perez_sky.h>
#include <hshfit/light/internal/picture_terms.h>
#include <hshfit/light/internal/sun_place.h>
#include <hshfit/light/picture_light.h>
#include <hshfit/light/placement.h>
#include <hshfit/light/sky.h>
#include <hshfit/picture_files/picture_file.h>
#include <hshfit/specification/sums.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

namespace hshfit::inline light {
namespace {

constexpr double brightest = 1e9;
constexpr double notGiven = -1000;  // outside of every range: the help says the default

// --- parameters that several kinds have -----------------------------------------------------

Parameter colour(std::string_view name, std::string_view help, double fallback) {
    return {.name = name,
            .help = help,
            .kind = Parameter::Kind::colour,
            .fallback = fallback,
            .min = 0,
            .max = brightest};
}

Parameter number(std::string_view name, std::string_view help, double fallback, double min,
                 double max) {
    return {.name = name, .help = help, .fallback = fallback, .min = min, .max = max};
}

std::vector<Parameter> both(std::vector<Parameter> first, const std::vector<Parameter>& second) {
    first.insert(first.end(), second.begin(), second.end());
    return first;
}

std::vector<Parameter> scaleAndTurn() {
    return {number("scale", "factor of the radiance", 1, 0, brightest),
            number("turn", "degrees about +z, from +x towards +y", 0, -360, 360)};
}

Rgb rgb(const Parameters& p, std::string_view name) {
    const std::vector<double> values = p.colour(name);
    if (values.size() == 3) return {values[0], values[1], values[2]};
    return {values[0], values[0], values[0]};
}

Rgb over(Rgb values, const Rgb& divisors) {
    for (std::size_t c = 0; c < 3; ++c) values[c] = divisors[c] > 0 ? values[c] / divisors[c] : 0;
    return values;
}
Rgb over(const Rgb& values, double divisor) {
    return over(values, Rgb{divisor, divisor, divisor});
}

void onlyOne(std::string_view owner, const Parameters& p) {
    if (p.given("radiance") && p.given("irradiance"))
        throw UsageError(
            fmt::format("{}: radiance and irradiance are both given; valid: one of "
                        "the two",
                        owner));
}

/// Radiance, or the irradiance asked for over the irradiance of radiance 1.
Rgb radianceBy(std::string_view owner, const Parameters& p, double irradianceOfOne) {
    onlyOne(owner, p);
    const bool byIrradiance = p.given("irradiance") || p.colour("radiance")[0] < 0;
    return byIrradiance ? over(rgb(p, "irradiance"), irradianceOfOne) : rgb(p, "radiance");
}

// --- the kinds ------------------------------------------------------------------------------

Light uniform(std::string_view owner, const Parameters& p) {
    const Rgb radiance = radianceBy(owner, p, pi);
    return SkyLight{.zenith = radiance, .ground = radiance};
}

Light directional(std::string_view owner, const Parameters& p) {
    if (!p.given("elevation"))
        throw UsageError(fmt::format("{}: elevation has to be given; valid: -90 to 90", owner));
    return DirectionalLight{fromElevation(p), rgb(p, "irradiance")};
}

Light sun(std::string_view owner, const Parameters& p) {
    const double radius = radians(p.number("angle")) / 2;
    const PlacedSun placed = placedSun(owner, p);
    Parameters stated = p;
    if (placed.weather && !p.given("radiance") && !p.given("irradiance"))
        stated.set("irradiance", {placed.weather->direct});
    return DiscLight{placed.towards, radius,
                     radianceBy(owner, stated, pi * std::pow(std::sin(radius), 2))};
}

Light panel(std::string_view owner, const Parameters& p) {
    const double width = radians(p.number("width")), height = radians(p.number("height"));
    // A rectangle seen from a surface that faces its centre (Lambert's formula).
    const double a = std::tan(width / 2), b = std::tan(height / 2);
    const double overA = std::sqrt(1 + a * a), overB = std::sqrt(1 + b * b);
    const double irradiance =
        2 * (a / overA * std::atan(b / overA) + b / overB * std::atan(a / overB));
    const Direction towards = directionFromAngles(radians(90 - p.number("elevation")), 0);
    return turned(PanelLight{towards, width, height, radians(p.number("roll")),
                             radianceBy(owner, p, irradiance)},
                  radians(p.number("azimuth")));
}

/// The sky with its irradiance scaled to what is asked for.
Light withIrradiance(SkyLight sky, const Rgb& asked) {
    sky.ground = {};
    sky.zenith = {1, 1, 1};
    sky.zenith = over(asked, skyIrradiance(sky));
    return sky;
}

Light generalSky(std::string_view owner, const Parameters& p) {
    onlyOne(owner, p);
    const double type = p.number("type");
    if (type != std::floor(type))
        throw UsageError(
            fmt::format("{}: type={} is no whole number; valid: 1 to 15", owner, type));
    // The luminance of these depends on the elevation above the horizon alone.
    const bool sunless = type == 1 || type == 3 || type == 5;
    const bool placed = p.given("elevation") || p.given("latitude") || p.given("longitude") ||
                        p.given("date") || p.given("time");
    const Direction towards = sunless && !placed ? Direction{} : placedSun(owner, p).towards;
    SkyLight sky = cieSky(static_cast<int>(type), towards, rgb(p, "radiance"));
    if (p.given("irradiance")) sky = std::get<SkyLight>(withIrradiance(sky, rgb(p, "irradiance")));
    sky.ground = rgb(p, "ground");
    return sky;
}

/// Factors that give a colour the luminance, or the three components, asked for.
Rgb factors(const std::vector<double>& asked, const Rgb& colour) {
    if (asked.size() == 3) return over({asked[0], asked[1], asked[2]}, colour);
    return over({asked[0], asked[0], asked[0]}, luminanceOf(colour));
}

/// A sky with a unit of its own, scaled to what is asked for, and its ground.
Light coloured(SkyLight sky, const Parameters& p) {
    Rgb factor{1, 1, 1};
    if (p.given("radiance")) factor = factors(p.colour("radiance"), radianceOf(sky, {0, 0, 1}));
    if (p.given("irradiance")) factor = factors(p.colour("irradiance"), skyIrradiance(sky));
    for (std::size_t c = 0; c < 3; ++c) sky.zenith[c] *= factor[c];
    sky.ground = rgb(p, "ground");
    return sky;
}

Light preetham(std::string_view owner, const Parameters& p) {
    onlyOne(owner, p);
    const Direction towards = placedSun(owner, p).towards;
    return coloured(preethamSky(p.number("turbidity"), towards, {1, 1, 1}), p);
}

Light hosekWilkie(std::string_view owner, const Parameters& p) {
    onlyOne(owner, p);
    const std::string file = p.choice("data");
    if (file.empty())
        throw UsageError(
            fmt::format("{}: data has to be given; valid: the path of a table of its authors, "
                        "such as ArHosekSkyModelData_CIEXYZ.h",
                        owner));
    const Direction towards = placedSun(owner, p).towards;
    return coloured(hosekWilkieSky(readHosekWilkieTables(file), file, p.number("turbidity"),
                                   p.number("albedo"), towards),
                    p);
}

Light perez(std::string_view owner, const Parameters& p) {
    const PlacedSun sun = placedSun(owner, p);
    const double direct = sun.weather ? sun.weather->direct : p.number("direct");
    const double diffuse = sun.weather ? sun.weather->diffuse : p.number("diffuse");
    if (!(diffuse > 0))
        throw InputError(
            fmt::format("{}, line {}: the diffuse horizontal radiation is 0; valid: "
                        "an hour of daylight",
                        p.choice("file"), sun.weather->line));
    double above = p.number("extraterrestrial");
    if (!p.given("extraterrestrial")) above /= sun.distance * sun.distance;
    SkyLight sky = perezSky(sun.towards, direct, diffuse, above);
    sky.ground = rgb(p, "ground");
    return sky;
}

LightKind kind(std::string_view name, std::string_view help, std::string_view source,
               std::string_view example, const std::vector<Parameter>& parameters,
               Light (*make)(std::string_view, const Parameters&)) {
    return {name, help, source, example, both(parameters, scaleAndTurn()), make};
}

std::vector<LightKind> makeKinds() {
    const Parameter ground = colour("ground", "radiance below the horizon", 0);
    const std::vector<Parameter> daylight =
        both(sunPlaceParameters(0),
             {colour("radiance",
                     "of the zenith; one number is its luminance, in place of the model's in "
                     "1000 cd/m^2",
                     notGiven),
              colour("irradiance",
                     "of a horizontal surface, instead; one number is its illuminance", notGiven),
              ground});
    return {
        kind("uniform", "the same radiance from all directions", "", "uniform:radiance=1",
             {colour("radiance", "from each direction", 1),
              colour("irradiance", "of any surface, instead", notGiven)},
             uniform),
        kind("directional", "parallel light from one direction", "",
             "directional:elevation=40,azimuth=120,irradiance=3",
             {number("elevation", "degrees from the horizon; has to be given", notGiven, -90, 90),
              number("azimuth", "degrees from +x towards +y", 0, -360, 360),
              colour("irradiance", "of a surface across the light", 1)},
             directional),
        kind(
            "sun", "a round light of uniform radiance",
            "position: Michalsky 1988, Solar Energy 40(3)",
            "sun:latitude=50.1,longitude=14.4,date=2024-06-21,time=09:30,zone=2,irradiance=3",
            both(
                sunPlaceParameters(-90),
                {weatherParameter(
                     "an EPW weather file, whose place and direct normal radiation in W/m^2 count"),
                 number("angle", "angular diameter, degrees", 0.533, 0.001, 180),
                 colour("radiance", "of the disc; or irradiance", notGiven),
                 colour("irradiance", "of a surface across the light", 1)}),
            sun),
        kind("panel", "a rectangle of uniform radiance that faces the origin", "",
             "panel:elevation=50,width=60,height=20,radiance=2",
             {number("elevation", "of its centre, degrees from the horizon", 90, -90, 90),
              number("azimuth", "degrees from +x towards +y", 0, -360, 360),
              number("width", "angle along azimuth, degrees", 40, 0.01, 170),
              number("height", "angle along elevation, degrees", 40, 0.01, 170),
              number("roll", "turn about its own centre, degrees", 0, -360, 360),
              colour("radiance", "of the panel", 1),
              colour("irradiance", "of a surface that faces its centre, instead", notGiven)},
             panel),
        kind("sky", "CIE standard general sky, types 1 to 15", "ISO 15469:2004",
             "sky:type=12,elevation=40",
             both({Parameter{.name = "type",
                             .help = "1 overcast to 5 uniform, 12 clear, 15 turbid",
                             .min = 1,
                             .max = 15}},
                  both(sunPlaceParameters(0),
                       {colour("radiance", "of the zenith", 1),
                        colour("irradiance", "of a horizontal surface, instead", notGiven),
                        ground})),
             generalSky),
        kind("preetham", "daylight sky with its colours, without the sun's disc",
             "Preetham, Shirley and Smits 1999, 10.1145/311535.311545",
             "preetham:turbidity=3,elevation=30",
             both({number("turbidity", "2 clear to 10 haze", 3, 2, 10)}, daylight), preetham),
        kind("hosek-wilkie", "daylight sky by its authors' tables, without the sun's disc",
             "Hosek and Wilkie 2012, 10.1145/2185520.2185591",
             "hosek-wilkie:data=ArHosekSkyModelData_CIEXYZ.h,turbidity=3,elevation=30",
             both({Parameter{.name = "data",
                             .help = "the authors' file with tables of RGB, XYZ or wavelengths; "
                                     "has to be given",
                             .kind = Parameter::Kind::text,
                             .choices = {"ArHosekSkyModelData_CIEXYZ.h"}},
                   number("turbidity", "1 clear to 10 haze", 3, 1, 10),
                   number("albedo", "share of light that the ground reflects to the sky", 0, 0, 1)},
                  daylight),
             hosekWilkie),
        kind("perez", "all-weather sky from measured sunshine, without the sun's disc",
             "Perez, Seals and Michalsky 1993, Solar Energy 50(3)",
             "perez:elevation=40,direct=700,diffuse=110",
             both({number("direct", "irradiance of the sun across its beam", 0, 0, brightest),
                   number("diffuse", "irradiance of a horizontal surface by the sky", 100, 1e-6,
                          brightest),
                   number("extraterrestrial",
                          "irradiance of the sun above the air, in the unit of both; W/m^2, or "
                          "127500 lux",
                          1367, 1e-6, brightest)},
                  both(sunPlaceParameters(0),
                       {weatherParameter("an EPW weather file, whose place, direct normal and "
                                         "diffuse horizontal radiation in W/m^2 count"),
                        ground})),
             perez),
    };
}

// --- the text -------------------------------------------------------------------------------

constexpr std::size_t mostTerms = 256;
constexpr std::string_view form =
    "kind[:key=value,...], the path of a picture or of coefficients of light, joined by '+'";

/// A path in a specification, seen from `folder`.
std::string within(const std::string& folder, std::string_view path) {
    return folder.empty() ? std::string(path) : (std::filesystem::path(folder) / path).string();
}

/// The end of the path that starts `text`, up to a '+', a ':' or the end; 0 where there is none.
std::size_t pathEnd(std::string_view text, const std::string& folder) {
    constexpr std::size_t longestPath = 4096;
    std::size_t longest = 0;
    for (std::size_t end = 1; end <= std::min(text.size(), longestPath); ++end) {
        if (end < text.size() && text[end] != '+' && text[end] != ':') continue;
        const std::string_view path = withoutSpaces(text.substr(0, end));
        if (!path.empty() && isPicturePath(within(folder, path))) longest = end;
    }
    return longest;
}

/// The end of the term that starts `text`: its first '+' outside of a path and of numbers.
std::size_t termEnd(std::string_view text, const std::string& folder) {
    return nextJoint(text, namesLight(withoutSpaces(text)) ? 0 : pathEnd(text, folder));
}

std::vector<std::string_view> splitTerms(std::string_view text, const std::string& folder) {
    std::vector<std::string_view> terms;
    while (true) {
        const std::size_t end = termEnd(text, folder);
        terms.push_back(withoutSpaces(text.substr(0, end)));
        if (terms.back().empty())
            throw UsageError(fmt::format("light: an empty term before '{}'; valid: {}",
                                         text.substr(0, 40), form));
        if (terms.size() > mostTerms)
            throw UsageError(fmt::format("light: more than {} terms", mostTerms));
        if (end == std::string_view::npos) return terms;
        text.remove_prefix(end + 1);
    }
}

const LightKind* findKind(std::string_view name) {
    const auto kinds = lightKinds();
    const auto row = std::ranges::find(kinds, name, &LightKind::name);
    return row == kinds.end() ? nullptr : &*row;
}

Light placed(Light light, const Parameters& p) {
    return turned(scaled(std::move(light), p.number("scale")), radians(p.number("turn")));
}

/// A sky and three soft panels.
constexpr std::string_view studio =
    "sky:type=3,elevation=35,azimuth=-138,radiance=0.3/0.35/0.45+"
    "panel:elevation=33,azimuth=-138,width=50,height=40,radiance=6/5.6/5+"
    "panel:elevation=15,azimuth=-21,width=30,height=60,radiance=1.8/2.1/2.6+"
    "panel:elevation=20,azimuth=84,width=60,height=30,radiance=3/2.7/2.2+"
    "uniform:radiance=0.06";

/// The terms that a term stands for: the studio's with its own turn and scale, or itself.
std::vector<std::string> termsOf(std::string_view term) {
    const std::size_t colon = std::min(term.find(':'), term.size());
    const LightKind& row = studioKind();
    if (term.substr(0, colon) != row.name) return {std::string(term)};
    const std::string_view options = term.substr(std::min(colon + 1, term.size()));
    parseParameters(row.name, row.parameters, options);
    std::vector<std::string> terms;
    for (const std::string_view each : splitTerms(studio, ""))
        terms.push_back(fmt::format("{}{}{}", each, options.empty() ? "" : ",", options));
    return terms;
}

[[noreturn]] void failUnknown(std::string_view term, const std::string& folder) {
    const std::string_view name = term.substr(0, term.find(':'));
    if (name.find('/') != std::string_view::npos || std::filesystem::path(name).has_extension())
        throw InputError(fmt::format("{}: no such file", within(folder, name)));
    std::vector<std::string_view> names;
    for (const LightKind& row : lightKinds()) names.push_back(row.name);
    names.push_back(studioKind().name);
    throw UsageError(fmt::format("unknown light '{}'{}; valid: {}, or the path of a picture", name,
                                 suggestion(name, names), joined(names)));
}

Light parseTerm(std::string_view term, const std::string& folder, InvalidPixels invalid) {
    const std::size_t colon = term.find(':');
    const auto after = [&](std::size_t at) {
        return at < term.size() ? term.substr(at + 1) : std::string_view();
    };
    if (const LightKind* row = findKind(term.substr(0, colon))) {
        Parameters p = parseParameters(row->name, row->parameters,
                                       colon == std::string_view::npos ? "" : after(colon));
        for (const char* key : {"file", "data"})
            if (p.given(key)) p.words[key] = within(folder, p.choice(key));
        return placed(row->make(row->name, p), p);
    }
    const std::size_t end = pathEnd(term, folder);
    if (end == 0) failUnknown(term, folder);
    const std::string path = within(folder, withoutSpaces(term.substr(0, end)));
    if (isLightFile(path)) {
        const Parameters p = parseParameters(path, coefficientsKind().parameters, after(end));
        return placed(tilted(path, readCoefficientLight(path), p), p);
    }
    if (looksLikeCoefficients(path))
        throw InputError(
            fmt::format("{}: has coefficients of a BRDF; light is a picture or coefficients of "
                        "light",
                        path));
    const Parameters p = parseParameters(path, pictureKind().parameters, after(end));
    // A report counts invalid pixels in any case.
    return placed(
        tilted(path, readPictureLight(path, 1, pictureOptions(p), invalidPixels(p, invalid)), p),
        p);
}

}  // namespace

std::span<const LightKind> lightKinds() {
    static const std::vector<LightKind> table = makeKinds();
    return table;
}

std::vector<std::string> lightExamples() {
    std::vector<std::string> examples;
    for (const LightKind& row : lightKinds()) {
        if (std::ranges::find(row.parameters, "data", &Parameter::name) == row.parameters.end())
            examples.emplace_back(row.example);
    }
    return examples;
}

const LightKind& studioKind() {
    static const LightKind row = kind("studio", "a sky and three soft panels, the light of viewers",
                                      "", "studio:turn=90,scale=2", {}, nullptr);
    return row;
}

const LightKind& pictureKind() {
    static const LightKind row = kind(
        "PATH", "a picture: OpenEXR, Radiance HDR; PNG, JPEG, TIFF and others with a curve", "",
        "studio.hdr:turn=90,scale=2", both(pictureParameters(), tiltParameters()), nullptr);
    return row;
}

const LightKind& coefficientsKind() {
    static const LightKind row =
        kind("FILE", "coefficients of light, a JSON file of the format hshfit-light", "",
             "sky.json:turn=90,scale=2", tiltParameters(), nullptr);
    return row;
}

bool namesLight(std::string_view text) {
    const std::string_view name = text.substr(0, text.find_first_of(":+ "));
    return name == studioKind().name || findKind(name) != nullptr;
}

bool looksLikeLight(const std::string& text) {
    if (namesLight(withoutSpaces(text))) return true;
    const std::string_view term =
        withoutSpaces(std::string_view(text).substr(0, termEnd(text, "")));
    const std::size_t end = pathEnd(term, "");
    if (end == 0) return false;
    const std::string path(withoutSpaces(term.substr(0, end)));
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) return true;  // six files
    if (isLightFile(path)) return true;
    std::string head(std::size_t{1} << 16, '\0');
    std::ifstream file(path, std::ios::binary);
    file.read(head.data(), static_cast<std::streamsize>(head.size()));
    head.resize(static_cast<std::size_t>(file.gcount()));
    if (!hasExrMagic(head)) return hasPictureMagic(head);
    for (const char* own : {"hshfit:format", "hshfit:phi_difference"}) {
        if (exrHasAttribute(head, own)) return false;
    }
    const std::string_view options = term.substr(end);
    if (options.find("layout=") != std::string_view::npos ||
        options.find("curve=") != std::string_view::npos) {
        return true;
    }
    for (const char* key : {"part=", "layer="})
        if (options.find(key) != std::string_view::npos) return true;
    const auto size = exrDisplaySize(head);
    return size && (*size)[0] == 2 * (*size)[1];
}

LightSpecification parseLights(const std::string& text, const std::string& folder,
                               InvalidPixels invalid) {
    if (withoutSpaces(text).empty())
        throw UsageError(fmt::format("empty light specification; valid: {}", form));
    LightSpecification specification{.text = text, .lights = {}, .terms = {}};
    for (const std::string_view given : splitTerms(text, folder)) {
        for (const std::string& term : termsOf(given))
            specification.lights.push_back(parseTerm(term, folder, invalid));
        specification.terms.emplace_back(given);
    }
    return specification;
}

}  // namespace hshfit::inline light
