#include "usage_errors.h"

#include "command_table.h"

#include <hshfit/spelling.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>

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

}  // namespace

std::string usageMessage(const CLI::App& app, const CLI::Error& error,
                         const std::vector<std::string>& words) {
    std::string message = unknownWord(app, words);
    if (message.empty()) message = unknownChoice(error.what());
    if (message.empty()) message = error.what();
    std::ranges::replace(message, '\n', ' ');
    return message;
}

std::string withHelp(const std::string& message, const std::vector<std::string>& words) {
    const auto names = spelling::namesOf(commands());
    const bool known =
        !words.empty() && words[0] != "help" && std::ranges::find(names, words[0]) != names.end();
    return fmt::format("{}; see hshfit help{}", message, known ? " " + words[0] : "");
}

}  // namespace hshfit::cli
