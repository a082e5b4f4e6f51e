#include "command.h"
#include "rotation_options.h"
#include "within.h"

#include <hshfit/error.h>

#include <jobs/lighting/rotate.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace hshfit::cli {

Rotation parseEuler(const std::string& text) {
    const auto angles = parseNumbers(text, 3, "--euler",
                                     "A,B,C in degrees, R_z(A) R_y(B) R_z(C) (for example 0,30,0)");
    return Rotation::euler(radians(angles[0]), radians(angles[1]), radians(angles[2]));
}

namespace {

using Json = nlohmann::ordered_json;

struct RotateArguments {
    std::string input, output, euler, axis, up, method = "exact";
    double tolerance = HemisphereRotationOptions{}.tolerance;
    int tables = HemisphereRotationOptions{}.tables;
};

Rotation rotationOf(const RotateArguments& arguments) {
    const int given = !arguments.euler.empty() + !arguments.axis.empty() + !arguments.up.empty();
    if (given != 1)
        throw UsageError(fmt::format(
            "{} rotations; give one of --euler A,B,C, --axis X,Y,Z,ANGLE and --up THETA,PHI",
            given));
    if (!arguments.euler.empty()) return parseEuler(arguments.euler);
    if (!arguments.axis.empty()) {
        const auto axis = parseNumbers(arguments.axis, 4, "--axis",
                                       "X,Y,Z,ANGLE, the angle in degrees (for example 0,0,1,90)");
        return Rotation::aboutAxis({axis[0], axis[1], axis[2]}, radians(axis[3]));
    }
    const auto up = parseNumbers(arguments.up, 2, "--up",
                                 "THETA,PHI in degrees, where +z goes (for example 30,180)");
    return Rotation::zTo(directionFromAngles(radians(up[0]), radians(up[1])));
}

void runRotate(const RotateArguments& arguments, const Globals& globals) {
    const jobs::Rotated done = jobs::rotate(arguments.input, arguments.output,
                                            {.rotation = rotationOf(arguments),
                                             .way = {.method = hemisphereMethod(arguments.method),
                                                     .tolerance = arguments.tolerance,
                                                     .tables = arguments.tables}});
    if (done.method == HemisphereMethod::paperShift)
        note(globals, "paper-shift moves only the pole to where it should go; for comparison");
    if (globals.json) {
        Json document = {{"format", "hshfit-rotate"},
                         {"version", 1},
                         {"input", arguments.input},
                         {"output", arguments.output},
                         {"kind", done.kind},
                         {"basis", done.basis},
                         {"order", done.order},
                         {"domain", done.domain},
                         {"method", methodName(done.method)},
                         {"lost_energy", done.lostEnergy},
                         {"error", done.error}};
        if (done.method == HemisphereMethod::throughSh) document["bands"] = done.bands;
        printJson(document);
        return;
    }
    printText(
        fmt::format("{}: {} order {}, {}: {:.3g} % of the energy left the {}; {:.2g} % off the "
                    "rotated function in "
                    "relative L2\n",
                    arguments.output, done.basis, done.order, methodName(done.method),
                    100 * done.lostEnergy, done.domain, 100 * done.error));
}

}  // namespace

void addRotate(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<RotateArguments>();
    command.add_option("FILE", arguments->input, "Coefficient file of a BRDF or of light")
        ->required();
    command.add_option("-o,--output", arguments->output, "File to write: .json; BRDFs also .exr")
        ->required();
    command.add_option("--euler", arguments->euler,
                       "A,B,C in degrees: R_z(A) R_y(B) R_z(C), directions move");
    command.add_option("--axis", arguments->axis, "X,Y,Z,ANGLE: right-handed, in degrees");
    command.add_option("--up", arguments->up,
                       "THETA,PHI in degrees: where +z goes, along the shortest arc");
    command
        .add_option("--method", arguments->method,
                    "exact, through-sh, table or paper-shift (which is wrong but at the pole)")
        ->capture_default_str();
    command.add_option("--tolerance", arguments->tolerance, "Of through-sh: relative change")
        ->check(within(jobs::bounds::rotationTolerance))
        ->capture_default_str();
    command.add_option("--tables", arguments->tables, "Of table: matrices from 0 to 180 degrees")
        ->check(within(jobs::bounds::rotationTables))
        ->capture_default_str();
    command.callback([arguments, &globals] { runRotate(*arguments, globals); });
}

}  // namespace hshfit::cli
