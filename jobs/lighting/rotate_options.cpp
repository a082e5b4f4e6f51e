#include "rotate.h"

#include <jobs/common/enum_words.h>
#include <jobs/common/number_text.h>

#include <fmt/format.h>

namespace hshfit::jobs {
namespace {

using options::at;
using options::spelled;

constexpr EnumWord matrixWeights[] = {{"solid-angle"}, {"cosine"}};
using Weights = EnumWords<matrixWeights, Basis::Inner>;

std::vector<Word> rotationMethods() {
    return {{"exact"}, {"through-sh"}, {"table"}, {"paper-shift"}};
}

EulerAngles eulerIn(const std::string& text) {
    const auto angles = numbersIn(text, 3, 3, "RotateOptions::euler",
                                  "A,B,C in degrees, R_z(A) R_y(B) R_z(C) (for example 0,30,0)");
    return {angles[0], angles[1], angles[2]};
}
std::string eulerText(const EulerAngles& angles) {
    return fmt::format("{},{},{}", angles.a, angles.b, angles.c);
}

Rotation byEuler(const std::string& text) {
    return eulerIn(text).rotation();
}
Rotation aboutAxis(const std::string& text) {
    const auto axis = numbersIn(text, 4, 4, "RotateOptions::axis",
                                "X,Y,Z,ANGLE, the angle in degrees (for example 0,0,1,90)");
    return Rotation::aboutAxis({axis[0], axis[1], axis[2]}, radians(axis[3]));
}
Rotation upTo(const std::string& text) {
    const auto up = numbersIn(text, 2, 2, "RotateOptions::up",
                              "THETA,PHI in degrees, where +z goes (for example 30,180)");
    return Rotation::zTo(Angles{up[0], up[1]}.direction());
}
constexpr Values numbers{.syntax = Syntax::numbers};

constexpr OptionRow rotateRows[] = {
    OptionRow{"euler", spelled<byEuler, options::untold<Rotation>, &RotateOptions::rotation>,
              "A,B,C in degrees: R_z(A) R_y(B) R_z(C), directions move"}
        .takes(numbers)
        .notWith("axis up"),
    OptionRow{"axis", spelled<aboutAxis, options::untold<Rotation>, &RotateOptions::rotation>,
              "X,Y,Z,ANGLE: right-handed, in degrees"}
        .takes(numbers)
        .notWith("up"),
    OptionRow{"up", spelled<upTo, options::untold<Rotation>, &RotateOptions::rotation>,
              "THETA,PHI in degrees: where +z goes, along the shortest arc"}
        .takes(numbers),
    OptionRow{"method",
              spelled<hemisphereMethod, methodName, &RotateOptions::way,
                      &HemisphereRotationOptions::method>,
              "exact, through-sh, table or paper-shift (which is wrong but at the pole)"}
        .takes({.words = rotationMethods}),
    OptionRow{"tolerance", at<&RotateOptions::way, &HemisphereRotationOptions::tolerance>,
              "Of through-sh: relative change"}
        .within(bounds::rotationTolerance),
    OptionRow{"tables", at<&RotateOptions::way, &HemisphereRotationOptions::tables>,
              "Of table: matrices from 0 to 180 degrees"}
        .within(bounds::rotationTables),
};

constexpr OptionRow matrixRows[] = {
    OptionRow{"order", at<&MatrixOptions::order>, "Bands of TO"}.within(bounds::matrixOrder),
    OptionRow{"from-order", at<&MatrixOptions::fromOrder>, "Bands of FROM (default: those of TO)"}
        .within(bounds::matrixOrder),
    OptionRow{"euler", spelled<eulerIn, eulerText, &MatrixOptions::euler>,
              "A,B,C in degrees: of the rotated function, R_z(A) R_y(B) R_z(C)"}
        .takes(numbers),
    OptionRow{"condon-shortley", at<&MatrixOptions::condonShortley>,
              "Give functions of odd m the Condon-Shortley sign, in both bases"},
    OptionRow{"weight", spelled<Weights::parse, Weights::name, &MatrixOptions::weight>,
              "Of the integral: solid-angle or cosine (default: that of the basis TO)"}
        .takes({.words = Weights::words, .complete = true}),
};

}  // namespace

OptionRows<RotateOptions> rotateOptions() {
    return {rotateRows};
}

OptionRows<MatrixOptions> matrixOptions() {
    return {matrixRows};
}

std::string_view weightName(Basis::Inner weight) {
    return Weights::name(weight);
}

}  // namespace hshfit::jobs
