#include "completion.h"

#include "command_table.h"

#include <CLI/CLI.hpp>
#include <kainjow/mustache.hpp>

#include <string_view>

namespace hshfit::embedded {
extern const std::string_view completion_bash;
}

namespace hshfit::cli {
namespace {

using kainjow::mustache::data;

/// "--one --two"
std::string optionNames(const CLI::App& command) {
    std::string names;
    for (const CLI::Option* option : command.get_options())
        for (const std::string& name : option->get_lnames())
            names += (names.empty() ? "--" : " --") + name;
    return names;
}

}  // namespace

std::string bashCompletion(const CLI::App& app) {
    data rows(data::type::list);
    for (const Command& command : commands()) {
        data row;
        row.set("name", command.name);
        row.set("options", optionNames(*app.get_subcommand(command.name)));
        rows.push_back(row);
    }
    data script;
    script.set("commands", rows);
    script.set("options", optionNames(app));
    return kainjow::mustache::mustache(std::string(embedded::completion_bash)).render(script);
}

}  // namespace hshfit::cli
