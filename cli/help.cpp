#include "command.h"
#include "command_table.h"
#include "help_pages.h"
#include "job_options.h"
#include "terminal.h"
#include "topics.h"

#include <hshfit/error.h>
#include <hshfit/specification/parameters.h>

#include <jobs/common/option_words.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace hshfit::cli {
namespace {

using Json = nlohmann::ordered_json;

Page topicPage(const Topic& topic) {
    Page page;
    addParagraph(page, fmt::format("{}: {}", topic.name, topic.help));
    const Page rest = topic.page();
    page.insert(page.end(), rest.begin(), rest.end());
    return page;
}

/// Throws UsageError for a word that is neither a command nor a topic.
Page pageOf(const std::string& word, const CLI::App& program) {
    std::vector<std::string_view> known;
    for (const Command& command : commands()) {
        if (command.name == word) return commandPage(*program.get_subcommand(word));
        known.emplace_back(command.name);
    }
    for (const Topic& topic : topics()) {
        if (topic.name == word) return topicPage(topic);
        known.emplace_back(topic.name);
    }
    throw UsageError(fmt::format("help: '{}' is neither a command nor a topic{}; known: {}", word,
                                 suggestion(word, known), joined(known)));
}

template <class Row>
Json rowsJson(std::span<const Row> rows) {
    Json json = Json::array();
    for (const Row& row : rows) json.push_back({{"name", row.name}, {"help", row.help}});
    return json;
}

struct HelpArguments {
    std::string word;
};

std::vector<Word> helpWords() {
    std::vector<Word> words = jobs::wordsOf(commands());
    for (const Topic& topic : topics()) words.push_back({topic.name, topic.help});
    return words;
}

constexpr ArgumentRow helpArguments[] = {
    optional("WORD", at<&HelpArguments::word>, "A command or a topic; all of them if left out",
             {.words = helpWords}),
};

}  // namespace

CommandRows helpRows() {
    return {helpArguments, {}};
}

void addHelp(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<HelpArguments>();
    addArguments(command, helpArguments, *arguments);
    const CLI::App* const program = command.get_parent();
    command.callback([arguments, program, &globals] {
        const std::string& word = arguments->word;
        const Page page = word.empty() ? programPage(*program) : pageOf(word, *program);
        if (!globals.json) return printHelp(textOf(page, columns(), hasColour(Stream::output)));
        printJson({{"format", "hshfit-help"},
                   {"version", 1},
                   {"text", textOf(page, columns(), false)},
                   {"commands", rowsJson(commands())},
                   {"topics", rowsJson(topics())}});
    });
}

}  // namespace hshfit::cli
