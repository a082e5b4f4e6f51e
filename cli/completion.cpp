#include "candidates.h"
#include "command.h"
#include "job_options.h"

#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace hshfit::embedded {
extern const std::string_view completion_bash, completion_zsh, completion_fish;
}

namespace hshfit::cli {
namespace {

struct CompletionArguments {
    std::string shell, output;
    std::vector<std::string> words;
};

std::string_view scriptOf(const std::string& shell) {
    if (shell == "bash") return embedded::completion_bash;
    return shell == "zsh" ? embedded::completion_zsh : embedded::completion_fish;
}

/// A line of flags that the scripts know, then a line for each word, with its help after a tab.
std::string linesOf(const Candidates& candidates, const std::string& shell) {
    std::string flags = "words";
    const bool folders = isFolder(candidates.files);
    if (folders)
        flags += " folders";
    else if (candidates.files != Files::none)
        flags += " files";
    if (candidates.open) flags += " open";
    std::string lines = flags + "\n";
    for (const Word& word : candidates.words) {
        const bool plain = shell == "bash" || word.help.empty();
        lines += plain ? word.text + "\n" : fmt::format("{}\t{}\n", word.text, word.help);
    }
    return lines;
}

void complete(const CompletionArguments& arguments, const CLI::App& program,
              const Globals& globals) {
    const Candidates candidates =
        candidatesOf(program, {arguments.words.begin() + 1, arguments.words.end()});
    if (!globals.json) return printText(linesOf(candidates, arguments.shell));
    nlohmann::ordered_json words = nlohmann::ordered_json::array();
    for (const Word& word : candidates.words)
        words.push_back({{"word", word.text}, {"help", word.help}});
    printJson({{"format", "hshfit-completion"}, {"version", 1}, {"words", words}});
}

std::vector<Word> shellWords() {
    return {{"bash"}, {"zsh"}, {"fish"}};
}

constexpr ArgumentRow completionArguments[] = {
    required("SHELL", at<&CompletionArguments::shell>, "The shell that runs the script",
             {.words = shellWords, .complete = true}),
    optional("WORDS", at<&CompletionArguments::words>,
             "After --: the words of a command line up to the one being typed. The "
             "answer is a line of flags, and the words that may stand in its place"),
    optionalOutput(at<&CompletionArguments::output>,
                   "File for the script (default: standard output)",
                   {.files = Files::written, .dash = ""}),
};

}  // namespace

CommandRows completionRows() {
    return {completionArguments, {}};
}

void addCompletion(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<CompletionArguments>();
    addArguments(command, completionArguments, *arguments);
    const CLI::App* const program = command.get_parent();
    command.callback([arguments, program, &globals] {
        if (!arguments->words.empty()) return complete(*arguments, *program, globals);
        const std::string script(scriptOf(arguments->shell));
        if (!arguments->output.empty()) return writeFile(arguments->output, script);
        if (!globals.json) return printText(script);
        printJson({{"format", "hshfit-completion"}, {"version", 1}, {"script", script}});
    });
}

}  // namespace hshfit::cli
