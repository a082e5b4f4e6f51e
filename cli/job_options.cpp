#include "job_options.h"

#include "within.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <functional>
#include <type_traits>
#include <utility>

namespace hshfit::cli {
namespace {

using jobs::OptionRow;

bool isPositional(const OptionRow& row) {
    return 'A' <= row.name[0] && row.name[0] <= 'Z';
}

std::string nameOf(const OptionRow& row) {
    return fmt::format("{}{}", isPositional(row) ? "" : "--", row.name);
}

/// With its other name.
std::string namesOf(const OptionRow& row) {
    if (row.also.empty()) return nameOf(row);
    return row.also.size() == 1 ? fmt::format("-{},{}", row.also, nameOf(row))
                                : fmt::format("{},--{}", nameOf(row), row.also);
}

std::string nameWithout(const OptionRow& row) {
    return fmt::format("--no-{}", row.name);
}

/// Adds one option by the type of its member.
class Adder {
public:
    Adder(CLI::App& command, const OptionRow& row, const std::string& group)
        : command_(command), row_(row), group_(group) {}

    void operator()(bool* value) const {
        if (row_.values.words)
            addWords(value);
        else if (*value)
            addFlag(nameWithout(row_), row_.without, [value] { *value = false; });
        else
            addFlag(nameOf(row_), row_.help, [value] { *value = true; });
    }
    void operator()(std::optional<bool>* value) const {
        CLI::Option& with = addFlag(nameOf(row_), row_.help, [value] { *value = true; });
        addFlag(nameWithout(row_), row_.without, [value] { *value = false; }).excludes(&with);
    }
    void operator()(const jobs::Spelled& value) const {
        const std::string fallback = value.word(value.at);
        CLI::Option& option = added(command_.add_option_function<std::string>(
            namesOf(row_), [value](const std::string& word) { value.set(value.at, word); }));
        if (!fallback.empty()) option.default_str(fallback);
    }
    /// Numbers that may be left out, and are given as 1e6, too.
    template <class Number>
    void operator()(std::optional<Number>* value) const {
        CLI::Option* option = command_.add_option_function<double>(
            namesOf(row_), [value](double given) { *value = static_cast<Number>(given); });
        checkRange<Number, double>(*option);
        if constexpr (std::is_integral_v<Number>) option->check(whole())->type_name("UINT");
        added(option);
    }
    /// Several, with commas or by an option for each.
    template <class Element>
    void operator()(std::vector<Element>* value) const {
        CLI::Option* option = command_.add_option(namesOf(row_), *value);
        // Specifications follow one another as words.
        if (!isPositional(row_) && row_.values.syntax != jobs::Syntax::sum)
            option->allow_extra_args(false);
        if (row_.values.syntax == jobs::Syntax::list) option->delimiter(',');
        checkRange<Element>(*option);
        if (!value->empty() && !saysDefault())
            option->default_str(fmt::format("{}", fmt::join(*value, ",")));
        added(option);
    }
    template <class Value>
    void operator()(Value* value) const {
        CLI::Option* option = command_.add_option(namesOf(row_), *value);
        checkRange<Value>(*option);
        if (*value != Value{}) option->capture_default_str();
        added(option);
    }

private:
    bool saysDefault() const { return row_.help.find("(default") != std::string_view::npos; }
    /// Two words, the first for true.
    void addWords(bool* value) const {
        const std::vector<jobs::Word> words = row_.values.words();
        CLI::Option* option = command_.add_option_function<std::string>(
            nameOf(row_),
            [value, yes = words[0].text](const std::string& word) { *value = word == yes; });
        added(option).default_str(words[*value ? 0 : 1].text);
    }
    CLI::Option& addFlag(const std::string& name, std::string_view help,
                         std::function<void()> set) const {
        CLI::Option& flag = added(command_.add_flag_callback(name, std::move(set)));
        flag.description(std::string(help));
        return flag;
    }
    /// States the range, and lets numbers have their unit.
    template <class Value, class Given = Value>
    void checkRange(CLI::Option& option) const {
        if constexpr (std::is_arithmetic_v<Value>) {
            if (row_.range)
                option.check(within<Value, Given>(
                    {static_cast<Value>(row_.range->least), static_cast<Value>(row_.range->most)}));
            if (row_.unit == jobs::Unit::percent) option.transform(percents());
            if (row_.unit == jobs::Unit::bytes) option.transform(CLI::AsSizeValue(false));
        }
    }
    /// States the help, the default in words and the choices.
    CLI::Option& added(CLI::Option* option) const {
        option->description(std::string(row_.help));
        if (!group_.empty()) option->group(group_);
        if (!row_.fallback.empty()) option->default_str(std::string(row_.fallback));
        if (row_.values.complete) {
            std::vector<std::string> words;
            for (const jobs::Word& word : row_.values.words()) words.push_back(word.text);
            option->check(CLI::IsMember(words));
        }
        return *option;
    }

    CLI::App& command_;
    const OptionRow& row_;
    const std::string& group_;
};

void relate(CLI::App& command, const OptionRow& row) {
    if (row.needs.empty() && row.excludes.empty()) return;
    CLI::Option* option = command.get_option(nameOf(row));
    if (!row.needs.empty()) option->needs(command.get_option(fmt::format("--{}", row.needs)));
    for (const std::string& other : CLI::detail::split(std::string(row.excludes), ' '))
        if (!other.empty()) option->excludes(command.get_option("--" + other));
}

}  // namespace

void addOptions(CLI::App& command, const std::vector<jobs::BoundOption>& options,
                const std::string& group) {
    for (const jobs::BoundOption& option : options)
        std::visit(Adder(command, *option.row, group), option.value);
    for (const jobs::BoundOption& option : options) relate(command, *option.row);
}

void addArguments(CLI::App& command, std::span<const ArgumentRow> rows, void* arguments,
                  const std::type_info& type) {
    for (const ArgumentRow& each : rows) {
        addOptions(command, jobs::boundOptions({&each.row, 1}, arguments, type), "");
        if (each.required) command.get_option(nameOf(each.row))->required();
    }
}

bool isOf(const CLI::Option& option, const OptionRow& row) {
    if (option.get_positional()) return option.get_name(true, false) == row.name;
    return option.check_lname(std::string(row.name)) ||
           (!row.without.empty() && option.check_lname(nameWithout(row).substr(2)));
}

const OptionRow* rowOf(std::span<const OptionRow> rows, const CLI::Option& option) {
    const auto row =
        std::ranges::find_if(rows, [&](const OptionRow& each) { return isOf(option, each); });
    return row == rows.end() ? nullptr : &*row;
}

std::optional<GivenOption> misplacedOption(const CLI::App& command, std::span<const OptionRow> rows,
                                           unsigned inputs) {
    for (const CLI::Option* option : command.get_options()) {
        const OptionRow* row = option->count() > 0 ? rowOf(rows, *option) : nullptr;
        if (row && (row->inputs & inputs) == 0)
            return GivenOption{"--" + option->get_lnames().front(), row};
    }
    return std::nullopt;
}

}  // namespace hshfit::cli
