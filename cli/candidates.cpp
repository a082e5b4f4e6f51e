#include "candidates.h"

#include "command_table.h"

#include <CLI/CLI.hpp>

#include <algorithm>

namespace hshfit::cli {
namespace {

/// Puts `prefix` before every word and leaves out words that do not begin with `typed`.
void keep(Candidates& candidates, const std::string& prefix, const std::string& typed) {
    for (Word& word : candidates.words) word.text = prefix + word.text;
    std::erase_if(candidates.words,
                  [&](const Word& word) { return !word.text.starts_with(typed); });
}

void addOptions(std::vector<Word>& words, const CLI::App& app) {
    for (const CLI::Option* option : app.get_options())
        for (const std::string& name : option->get_lnames())
            words.push_back({"--" + name, option->get_description()});
}

/// The option that a word names, "-o" or "--output"; null for other words.
const CLI::Option* optionOf(const CLI::App& command, const std::string& word) {
    return word.starts_with('-') ? command.get_option_no_throw(word) : nullptr;
}

bool takesValue(const CLI::Option* option) {
    return option && option->get_type_size() != 0;
}

/// The argument whose turn it is after `words`; the last one goes on if it takes several.
const CLI::Option* nextArgument(const CLI::App& command, std::span<const std::string> words) {
    std::size_t given = 0;
    for (std::size_t k = 0; k < words.size(); ++k) {
        if (takesValue(optionOf(command, words[k]))) {
            ++k;
        } else if (!words[k].starts_with('-') || words[k] == "-") {
            ++given;
        }
    }
    const auto arguments =
        command.get_options([](const CLI::Option* option) { return option->get_positional(); });
    for (std::size_t k = 0; k < arguments.size(); ++k) {
        const bool several =
            arguments[k]->get_expected_max() >= CLI::detail::expected_max_vector_size;
        if (k == given || several) return arguments[k];
    }
    return nullptr;
}

Candidates valuesOf(const CLI::App& command, const CLI::Option& option, const std::string& typed) {
    Candidates candidates;
    if (const Values* row = findValues(command, option)) return cli::valuesOf(*row, typed);
    for (const std::string& choice : choicesOf(option)) candidates.words.push_back({choice});
    keep(candidates, "", typed);
    return candidates;
}

}  // namespace

Candidates candidatesOf(const CLI::App& program, const std::vector<std::string>& words) {
    Candidates candidates;
    if (words.empty()) return candidates;
    const std::string& typed = words.back();
    if (words.size() == 1) {
        for (const Command& row : commands()) candidates.words.push_back({row.name, row.help});
        if (typed.starts_with('-')) candidates.words.clear(), addOptions(candidates.words, program);
        keep(candidates, "", typed);
        return candidates;
    }
    const auto named = program.get_subcommands(
        [&](const CLI::App* each) { return each->get_name() == words.front(); });
    if (named.empty()) return candidates;
    const CLI::App* const command = named.front();
    const CLI::Option* before = optionOf(*command, words[words.size() - 2]);
    if (words.size() > 2 && takesValue(before)) return valuesOf(*command, *before, typed);
    if (const std::size_t equals = typed.find('=');
        typed.starts_with("--") && equals != std::string::npos) {
        const CLI::Option* option = optionOf(*command, typed.substr(0, equals));
        if (!takesValue(option)) return candidates;
        candidates = valuesOf(*command, *option, typed.substr(equals + 1));
        keep(candidates, typed.substr(0, equals + 1), typed);
        return candidates;
    }
    if (typed.starts_with('-') && typed != "-") {
        addOptions(candidates.words, *command);
        keep(candidates, "", typed);
        return candidates;
    }
    const CLI::Option* argument =
        nextArgument(*command, std::span(words).subspan(1, words.size() - 2));
    return argument ? valuesOf(*command, *argument, typed) : candidates;
}

}  // namespace hshfit::cli
