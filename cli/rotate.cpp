#include "command.h"
#include "command_rows.h"
#include "job_options.h"

#include <jobs/lighting/rotate.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace hshfit::cli {

namespace {

using Json = nlohmann::ordered_json;

struct RotateArguments {
    std::string input, output;
    jobs::RotateOptions options;
};

void runRotate(const RotateArguments& arguments, const Globals& globals) {
    const jobs::Rotated done = jobs::rotate(arguments.input, arguments.output, arguments.options);
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
        if (done.bands > 0) document["bands"] = done.bands;
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

constexpr ArgumentRow rotateArguments[] = {
    required("FILE", at<&RotateArguments::input>, "Coefficient file of a BRDF or of light",
             {.files = Files::read, .dash = ""}),
    requiredOutput(at<&RotateArguments::output>, "File to write: .json; BRDFs also .exr",
                   jsonWritten),
};

}  // namespace

CommandRows rotateRows() {
    return {rotateArguments, {jobs::rotateOptions().rows}};
}

void addRotate(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<RotateArguments>();
    addArguments(command, rotateArguments, *arguments);
    addOptions(command, jobs::rotateOptions(), arguments->options);
    command.callback([arguments, &globals] { runRotate(*arguments, globals); });
}

}  // namespace hshfit::cli
