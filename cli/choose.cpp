#include "command.h"

#include <hshfit/choice/choice_files.h>

#include <jobs/studies/choose.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

namespace hshfit::cli {
namespace {

struct ChooseArguments {
    std::string spec, output;
    double bytes = 0;
    jobs::ChooseOptions options;
};

/// Whether what is taken has files; a measured file that is there already has none.
bool writesFiles(const choice::Choice& choice) {
    return choice.recommended && choice.rows[*choice.recommended].made.write;
}

void runChoose(const ChooseArguments& arguments, Globals& globals) {
    jobs::ChooseOptions options = arguments.options;
    if (arguments.bytes > 0) options.bytes = static_cast<std::size_t>(arguments.bytes);
    const choice::Choice choice =
        jobs::choose(arguments.spec, arguments.output, options, listenerFor(globals));
    if (globals.json) {
        printText(choice::choiceJson(choice));
    } else {
        std::string text = choice::choiceText(choice);
        if (!arguments.output.empty())
            text += fmt::format("written to {}: choice.html, choice.json{}\n", arguments.output,
                                writesFiles(choice) ? ", and the files of what is taken" : "");
        printText(text);
    }
    if (!choice.recommended) endWithoutNumbers(globals, choice.why);
}

}  // namespace

void addChoose(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<ChooseArguments>();
    command.add_option("SPEC", arguments->spec, "A BRDF")->required();
    command.add_option("-o,--output", arguments->output,
                       "Folder for choice.html, choice.json and the recommended material");
    command
        .add_option("--for", arguments->options.renderer,
                    "The renderer, format or shading language that takes the material")
        ->capture_default_str();
    command
        .add_option("--kinds", arguments->options.kinds,
                    "Kinds of candidates to try: of model, lobes, gltf, openpbr, halfway, "
                    "coefficients, bsdf (default: all)")
        ->delimiter(',')
        ->allow_extra_args(false);
    command.add_option("--bytes", arguments->bytes, "Recommend nothing that takes more")
        ->check(CLI::Range(1.0, 1e15));
    command
        .add_option("--error", arguments->options.error,
                    "Mean FLIP of a faithful material at most (default: 0.1); if it is stated, "
                    "nothing else is recommended")
        ->check(CLI::Range(0.0, 1.0));
    command.callback([arguments, &globals] { runChoose(*arguments, globals); });
}

}  // namespace hshfit::cli
