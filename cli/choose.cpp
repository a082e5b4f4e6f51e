#include "command.h"
#include "command_rows.h"
#include "job_options.h"

#include <hshfit/choice/choice_files.h>

#include <jobs/studies/choose.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

namespace hshfit::cli {
namespace {

struct ChooseArguments {
    std::string spec, output;
    jobs::ChooseOptions options;
};

/// Whether what is taken has files; a measured file that is there already has none.
bool writesFiles(const choice::Choice& choice) {
    return choice.recommended && choice.rows[*choice.recommended].made.write;
}

void runChoose(const ChooseArguments& arguments, Globals& globals) {
    const choice::Choice choice =
        jobs::choose(arguments.spec, arguments.output, arguments.options, listenerFor(globals));
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

constexpr ArgumentRow chooseArguments[] = {
    required("SPEC", at<&ChooseArguments::spec>, "A BRDF", brdfRead),
    optionalOutput(at<&ChooseArguments::output>,
                   "Folder for choice.html, choice.json and the recommended material",
                   {.files = Files::folder}),
};

}  // namespace

CommandRows chooseRows() {
    return {chooseArguments, {jobs::chooseOptions().rows}};
}

void addChoose(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<ChooseArguments>();
    addArguments(command, chooseArguments, *arguments);
    addOptions(command, jobs::chooseOptions(), arguments->options);
    command.callback([arguments, &globals] { runChoose(*arguments, globals); });
}

}  // namespace hshfit::cli
