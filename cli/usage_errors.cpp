#include "usage_errors.h"

#include "command_table.h"
#include "option_rows.h"

#include <hshfit/error.h>
#include <hshfit/spelling.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <optional>

namespace hshfit::cli {
namespace {

std::vector<std::string> optionNames(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::Option* option : app.get_options())
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    return names;
}

/// The first long option among `words` that `app` does not have; "" if there is none.
std::string unknownOption(const CLI::App& app, std::span<const std::string> words,
                          const std::string& owner) {
    const std::vector<std::string> names = optionNames(app);
    for (const std::string& each : words) {
        const std::string word = each.substr(0, each.find('='));
        if (word.size() > 2 && word.starts_with("--") &&
            std::ranges::find(names, word) == names.end())
            return fmt::format("{}unknown option '{}'{}", owner, word,
                               spelling::question(word, names));
    }
    return "";
}

/// The unknown command, or the unknown option of a known command or of the program.
std::string unknownWord(const CLI::App& app, std::span<const std::string> words) {
    if (words.empty() || words[0].empty()) return "";
    if (words[0].starts_with('-')) return unknownOption(app, words.first(1), "");
    const auto names = spelling::namesOf(commands());
    if (std::ranges::find(names, words[0]) == names.end())
        return spelling::unknown("command", words[0], names).what();
    return unknownOption(*app.get_subcommand(words[0]), words.subspan(1), words[0] + ": ");
}

/// "SECTION: base not in {bases,metrics}", as CLI11 has it, with the nearest choice; "" for other
/// messages.
std::string unknownChoice(const std::string& message) {
    constexpr std::string_view owner = ": ", middle = " not in {";
    const std::size_t begin = message.find(owner), end = message.find(middle);
    if (begin == std::string::npos || end == std::string::npos || begin > end) return "";
    const std::size_t word = begin + owner.size(), list = end + middle.size();
    const auto choices = CLI::detail::split(message.substr(list, message.rfind('}') - list), ',');
    return message.substr(0, word) +
           spelling::unknown("value", message.substr(word, end - word), choices).what();
}

/// The words between the two ends of a message; none if it has other ends.
std::optional<std::string> between(const std::string& message, std::string_view begin,
                                   std::string_view end) {
    if (!message.starts_with(begin) || !message.ends_with(end)) return std::nullopt;
    if (message.size() < begin.size() + end.size()) return std::nullopt;
    return message.substr(begin.size(), message.size() - begin.size() - end.size());
}

/// CLI11's messages about values and commands in words of a reader; "" for others.
std::string inPlainWords(const CLI::App& app, const std::string& message) {
    if (between(message, "A subcommand is required", ""))
        return "no command is given, as in hshfit list models";
    for (const std::string_view many : {" was", "s were"})
        if (const auto said = between(
                message, fmt::format("The following argument{} not expected: ", many), "")) {
            const auto left = app.remaining(true);  // CLI11's message has them from last to first
            return fmt::format("unexpected '{}'",
                               left.empty() ? *said : CLI::detail::join(left, " "));
        }
    constexpr std::string_view equals = " = ", colon = ": ";
    if (const auto said = between(message, "Could not convert: ", "")) {
        const std::size_t middle = said->find(equals);
        if (middle == std::string::npos) return "";
        const std::string name = said->substr(0, middle);
        const auto chosen = app.get_subcommands();
        const CLI::Option* option =
            chosen.empty() ? nullptr : chosen.front()->get_option_no_throw(name);
        const std::string type = option ? option->get_type_name() : "";
        const bool whole = type.starts_with("INT") || type.starts_with("UINT");
        return fmt::format("{} '{}': give {}", name, said->substr(middle + equals.size()),
                           whole ? "a whole number" : "a number");
    }
    if (const auto said = between(message, "", " missing")) {
        const std::size_t middle = said->find(colon);
        if (middle != std::string::npos)
            return fmt::format("{}: a value is missing", said->substr(0, middle));
    }
    const std::size_t middle = message.find(" excludes ");
    if (middle != std::string::npos)
        return fmt::format("{} and {} exclude one another; give one of them",
                           message.substr(0, middle),
                           message.substr(middle + std::string_view(" excludes ").size()));
    return "";
}

}  // namespace

std::string usageMessage(const CLI::App& app, const CLI::Error& error,
                         const std::vector<std::string>& words) {
    std::string message = unknownWord(app, words);
    if (message.empty()) message = unknownChoice(error.what());
    if (message.empty()) message = inPlainWords(app, error.what());
    if (message.empty()) message = error.what();
    std::ranges::replace(message, '\n', ' ');
    return message;
}

void refuseEmptyValues(const CLI::App& command) {
    for (const CLI::Option* option : command.get_options()) {
        if (option->count() == 0 || (option->get_positional() && !isWritten(command, *option)))
            continue;
        if (std::ranges::count(option->results(), std::string()) > 0)
            throw UsageError(fmt::format("{}: the value of {} is empty; give one{}",
                                         command.get_name(), option->get_name(),
                                         option->get_required() ? "" : ", or leave it out"));
    }
}

std::string withHelp(const std::string& message, const std::vector<std::string>& words) {
    const auto names = spelling::namesOf(commands());
    const bool known =
        !words.empty() && words[0] != "help" && std::ranges::find(names, words[0]) != names.end();
    return fmt::format("{}; see hshfit help{}", message, known ? " " + words[0] : "");
}

}  // namespace hshfit::cli
