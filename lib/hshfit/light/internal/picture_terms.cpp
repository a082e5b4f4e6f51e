#include <hshfit/light/internal/picture_terms.h>

#include <hshfit/error.h>
#include <hshfit/light/placement.h>

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <utility>

namespace hshfit::inline light {
namespace {

constexpr double longestAxis = 1e6;

Parameter choiceOf(std::string_view name, std::string_view help,
                   std::vector<std::string_view> choices) {
    return {
        .name = name, .help = help, .kind = Parameter::Kind::choice, .choices = std::move(choices)};
}

Parameter textLike(std::string_view name, std::string_view help, std::string_view example) {
    return {.name = name, .help = help, .kind = Parameter::Kind::text, .choices = {example}};
}

template <class Placed>
Placed mirroredAndTilted(std::string_view owner, Placed light, const Parameters& p) {
    if (p.choice("mirror") == "yes") light = mirrorImage(std::move(light));
    const double angle = radians(p.number("tilt"));
    if (p.given("axis") && !p.given("tilt"))
        throw UsageError(
            fmt::format("{}: axis is given without tilt, the degrees about it", owner));
    if (angle == 0) return light;
    Direction axis{0, 1, 0};
    if (p.given("axis")) {
        const std::vector<double> values = p.colour("axis");
        const double equal = values[0];
        axis = values.size() == 3 ? Direction{values[0], values[1], values[2]}
                                  : Direction{equal, equal, equal};
    }
    if (!(dot(axis, axis) > 0))
        throw UsageError(
            fmt::format("{}: axis=0/0/0 is no direction; valid: x/y/z, one of them not 0", owner));
    return rotated(std::move(light), Rotation::aboutAxis(axis, angle));
}

}  // namespace

std::vector<Parameter> pictureParameters() {
    std::vector<std::string_view> layouts{"by-size"}, curves{"by-format"};
    for (const auto& row : layoutNames()) layouts.push_back(row.name);
    for (const auto& row : curveNames()) curves.push_back(row.name);
    return {
        choiceOf("layout", "of directions; has to be given where the size does not tell", layouts),
        choiceOf("curve", "code of the values; has to be given for whole-number formats", curves),
        textLike("part", "of OpenEXR: the name or number of one of several", "rgba"),
        textLike("layer", "of OpenEXR: the words before .R, .G and .B", "ViewLayer.Combined"),
        choiceOf("invalid",
                 "of pixels below 0, infinite or not a number; clamp: 0, 65504 and 0; inpaint: "
                 "from those around",
                 {"refuse", "clamp", "inpaint"})};
}

PictureOptions pictureOptions(const Parameters& p) {
    PictureOptions options;
    for (const auto& row : layoutNames())
        if (row.name == p.choice("layout")) options.layout = row.layout;
    for (const auto& row : curveNames())
        if (row.name == p.choice("curve")) options.curve = row.curve;
    options.part = p.choice("part");
    options.layer = p.choice("layer");
    return options;
}

InvalidPixels invalidPixels(const Parameters& p, InvalidPixels otherwise) {
    if (otherwise != InvalidPixels::refused) return otherwise;
    const std::string choice = p.choice("invalid");
    if (choice == "clamp") return InvalidPixels::clamped;
    return choice == "inpaint" ? InvalidPixels::inpainted : InvalidPixels::refused;
}

std::vector<Parameter> tiltParameters() {
    return {choiceOf("mirror", "exchange left and right, y and -y, before all else", {"no", "yes"}),
            {.name = "tilt",
             .help = "degrees about axis, right-handed, before turn",
             .fallback = 0,
             .min = -360,
             .max = 360},
            {.name = "axis",
             .help = "of tilt, x/y/z; 0/1/0, to the left, if not given",
             .kind = Parameter::Kind::colour,
             .fallback = -2 * longestAxis,
             .min = -longestAxis,
             .max = longestAxis}};
}

PictureLight tilted(std::string_view owner, PictureLight light, const Parameters& p) {
    return mirroredAndTilted(owner, std::move(light), p);
}
CoefficientLight tilted(std::string_view owner, CoefficientLight light, const Parameters& p) {
    return mirroredAndTilted(owner, std::move(light), p);
}

}  // namespace hshfit::inline light
