#include "help_pages.h"

#include "command_table.h"
#include "option_rows.h"
#include "terminal.h"
#include "topics.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cctype>

namespace hshfit::cli {
namespace {

constexpr const char* summary =
    "hshfit turns BRDFs and lights into coefficients of hemispherical bases, and states the error "
    "of what it writes.";

std::vector<const char*> groupNames() {
    std::vector<const char*> names;
    for (const Command& command : commands())
        if (std::ranges::find(names, command.group) == names.end()) names.push_back(command.group);
    return names;
}

/// "FILE", "SPEC", … for an option of the table of values, else the type of its value.
std::string typeWord(const CLI::App& command, const CLI::Option& option) {
    if (const Values* row = findValues(command, option)) {
        if (row->syntax == Syntax::light) return "LIGHT";
        if (row->syntax == Syntax::brdf) return "SPEC";
        if (isFolder(row->files)) return "DIR";
        if (row->files != Files::none) return "FILE";
        if (row->words) return row->syntax == Syntax::list ? "NAMES" : "NAME";
    }
    const std::string type = option.get_type_name();
    const std::string word = type.substr(0, type.find(':'));
    if (word == "FLOAT") return "NUMBER";
    return word == "INT" || word == "UINT" ? "N" : word;
}

/// "{a,b}" as "a, b" and " in [0 - 1]" as "0 to 1"; "" where the help has said so.
std::string validValues(const CLI::Option& option) {
    const std::string type = option.get_type_name();
    const std::size_t colon = type.find(':');
    if (colon == std::string::npos) return "";
    const std::string valid = type.substr(colon + 1);
    if (valid == "POSITIVE") return "above 0";
    if (const auto choices = choicesOf(option); !choices.empty()) {
        const bool said = std::ranges::all_of(choices, [&](const std::string& word) {
            return option.get_description().find(word) != std::string::npos;
        });
        return said ? "" : fmt::format("{}", fmt::join(choices, ", "));
    }
    const std::size_t open = valid.find('['), gap = valid.find(" - ");
    if (open == std::string::npos || gap == std::string::npos) return "";
    return fmt::format("{} to {}", valid.substr(open + 1, gap - open - 1),
                       valid.substr(gap + 3, valid.size() - gap - 4));
}

std::string namesOf(const std::set<CLI::Option*>& options) {
    std::vector<std::string> names;
    for (const CLI::Option* option : options) names.push_back(option->get_name());
    std::ranges::sort(names);
    return fmt::format("{}", fmt::join(names, ", "));
}

std::string optionTerm(const CLI::App& command, const CLI::Option& option) {
    if (option.get_positional()) return option.get_name(true, false);
    std::vector<std::string> names;
    for (const std::string& name : option.get_snames()) names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
    std::string term = fmt::format("{}", fmt::join(names, ", "));
    const std::string type = option.get_type_size() != 0 ? typeWord(command, option) : "";
    if (!type.empty()) term += " " + type;
    const bool several = option.get_expected_max() >= CLI::detail::expected_max_vector_size;
    return several ? term + "…" : term;
}

std::string optionText(const CLI::Option& option) {
    std::vector<std::string> remarks;
    if (option.get_type_size() != 0) {
        if (const std::string valid = validValues(option); !valid.empty()) remarks.push_back(valid);
        const std::string fallback = option.get_default_str();
        if (!fallback.empty() && fallback != "[]" && fallback != "\"\"")
            remarks.push_back("default: " + fallback);
        if (option.get_required() && !option.get_positional()) remarks.emplace_back("required");
    }
    if (!option.get_needs().empty()) remarks.push_back("with " + namesOf(option.get_needs()));
    if (!option.get_excludes().empty())
        remarks.push_back("not with " + namesOf(option.get_excludes()));
    std::string text = option.get_description();
    if (!remarks.empty()) text += fmt::format(" ({})", fmt::join(remarks, "; "));
    return text;
}

void addOptions(Page& page, const CLI::App& app, const std::string& title,
                const std::function<bool(const CLI::Option*)>& belongs) {
    const auto options = app.get_options(belongs);
    if (options.empty()) return;
    addHeading(page, title);
    for (const CLI::Option* option : options)
        addRow(page, optionTerm(app, *option), optionText(*option));
}

class PageFormat final : public CLI::Formatter {
public:
    std::string make_help(const CLI::App* app, std::string, CLI::AppFormatMode) const override {
        const Page page = app->get_parent() ? commandPage(*app) : programPage(*app);
        return textOf(page, columns(), hasColour(Stream::output));
    }
};

/// The purpose of the program or of a command, its usage, and its sections.
Page helpPage(const std::string& purpose, const CLI::App& app, const Page& sections) {
    Page page;
    addParagraph(page, purpose);
    addParagraph(page, "Usage: " + usageLine(app));
    page.insert(page.end(), sections.begin(), sections.end());
    return page;
}

}  // namespace

std::string usageLine(const CLI::App& app) {
    std::string line = "hshfit " + (app.get_parent() ? app.get_name() : "COMMAND") + " [OPTIONS]";
    for (const CLI::Option* option : app.get_options()) {
        if (!option->get_positional()) continue;
        const bool several = option->get_expected_max() >= CLI::detail::expected_max_vector_size;
        const std::string name = option->get_name(true, false) + (several ? "…" : "");
        line += option->get_required() ? " " + name : " [" + name + "]";
    }
    return line;
}

std::string programSummary() {
    return summary;
}

Page programSections(const CLI::App& program) {
    Page page;
    for (const char* group : groupNames()) {
        addHeading(page, group);
        for (const Command& command : commands())
            if (command.group == std::string_view(group))
                addRow(page, command.name,
                       command.add ? std::string(command.help)
                                   : fmt::format("(not built: wing {}) {}", nameOf(*command.wing),
                                                 command.help));
    }
    addHeading(page, "Topics");
    for (const Topic& topic : topics()) addRow(page, topic.name, topic.help);
    addOptions(page, program, "Options", [](const CLI::Option*) { return true; });
    addHeading(page, "More");
    addCommand(page, "hshfit help COMMAND");
    addCommand(page, "hshfit help TOPIC");
    return page;
}

Page programPage(const CLI::App& program) {
    return helpPage(summary, program, programSections(program));
}

Page overviewPage() {
    Page page;
    addParagraph(page, summary);
    addHeading(page, "Commands");
    for (const char* group : groupNames()) {
        std::vector<std::string_view> names;
        for (const Command& command : commands())
            if (command.group == std::string_view(group)) names.emplace_back(command.name);
        addRow(page, group, fmt::format("{}", fmt::join(names, ", ")));
    }
    addHeading(page, "Examples");
    for (const char* name : {"project", "report", "info"})
        addCommand(page,
                   std::ranges::find(commands(), std::string_view(name), [](const Command& c) {
                       return std::string_view(c.name);
                   })->example);
    addHeading(page, "More");
    addCommand(page, "hshfit help");
    addCommand(page, "hshfit help project");
    return page;
}

Page commandPage(const CLI::App& command) {
    return helpPage(command.get_description(), command, commandSections(command));
}

Page commandSections(const CLI::App& command) {
    Page page;
    addOptions(page, command, "Arguments",
               [](const CLI::Option* option) { return option->get_positional(); });
    for (const std::string& group : command.get_groups())
        addOptions(page, command, group, [&](const CLI::Option* option) {
            return option->nonpositional() && option->get_group() == group;
        });
    addHeading(page, "Example");
    addCommand(page, command.get_footer());
    return page;
}

void usePagesForHelp(CLI::App& app) {
    app.formatter(std::make_shared<PageFormat>());
}

}  // namespace hshfit::cli
