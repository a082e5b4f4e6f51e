#include "option_rows.h"

#include "command_table.h"
#include "job_options.h"

#include <CLI/CLI.hpp>

#include <algorithm>

namespace hshfit::cli {
namespace {

/// Null for what the type and the range of an option tell.
const Values* statedIn(const Values& values) {
    const bool plain = values.syntax == Syntax::word || values.syntax == Syntax::list ||
                       values.syntax == Syntax::numbers || values.syntax == Syntax::outgoing;
    return plain && !values.words && values.files == Files::none ? nullptr : &values;
}

}  // namespace

const jobs::OptionRow* findRow(const CLI::App& command, const CLI::Option& option) {
    const auto named = std::ranges::find(commands(), command.get_name(), &Command::name);
    if (named == commands().end() || !named->options) return nullptr;
    const CommandRows own = named->options();
    for (const ArgumentRow& argument : own.arguments)
        if (isOf(option, argument.row)) return &argument.row;
    for (const auto rows : own.options)
        if (const jobs::OptionRow* row = rowOf(rows, option)) return row;
    return nullptr;
}

const Values* findValues(const CLI::App& command, const CLI::Option& option) {
    const jobs::OptionRow* row = findRow(command, option);
    return row ? statedIn(row->values) : nullptr;
}

bool isWritten(const CLI::App& command, const CLI::Option& option) {
    const Values* row = findValues(command, option);
    return row && (row->files == Files::written || row->files == Files::folder ||
                   row->files == Files::added || row->files == Files::addedFolder);
}

std::vector<std::string> choicesOf(const CLI::Option& option) {
    const std::string type = option.get_type_name();
    const std::size_t open = type.find('{'), close = type.rfind('}');
    if (open == std::string::npos || close == std::string::npos) return {};
    return CLI::detail::split(type.substr(open + 1, close - open - 1), ',');
}

}  // namespace hshfit::cli
