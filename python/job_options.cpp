#include "job_options.h"

#include "arrays.h"

#include <hshfit/coefficients/outgoing.h>
#include <hshfit/error.h>
#include <hshfit/spelling.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <optional>
#include <regex>
#include <type_traits>

namespace hshfit::python {
namespace {

using jobs::OptionRow;

/// The beginning of pybind11's own message, for which hshfit/_arguments.py looks.
[[noreturn]] void refuseType(const std::string& what) {
    throw py::type_error("incompatible function arguments: " + what);
}

/// A word, a path, a number, an outgoing set, or a sequence of them with commas; "" for None.
std::string textOf(const py::handle& value) {
    if (value.is_none()) return {};
    if (py::isinstance<py::str>(value)) return value.cast<std::string>();
    if (py::isinstance<OutgoingSet>(value)) return value.cast<const OutgoingSet&>().spec();
    if (py::hasattr(value, "__fspath__"))
        return py::module_::import("os").attr("fspath")(value).cast<std::string>();
    if (!py::hasattr(value, "__iter__")) return py::str(value).cast<std::string>();
    std::string text;
    for (const py::handle each : value) text += (text.empty() ? "" : ",") + textOf(each);
    return text;
}

/// Sets a member from an object of Python.
struct Setter {
    const OptionRow& row;
    const std::string keyword;
    const py::object& given;

    template <class Value>
    Value cast() const {
        try {
            return given.cast<Value>();
        } catch (const py::cast_error&) {
            refuseType(fmt::format("{} is {}", keyword, py::repr(given).cast<std::string>()));
        }
    }
    void operator()(std::string* value) const {
        *value = textOf(given);
        if (row.values.files != jobs::Files::none && value->empty() && !given.is_none())
            throw UsageError(fmt::format("{}: an empty path; valid: None or a name", keyword));
        requireKnown(*value);
    }
    void requireKnown(const std::string& word) const {
        if (!row.values.complete) return;
        std::vector<std::string> known;
        for (const jobs::Word& each : row.values.words()) known.push_back(each.text);
        if (std::ranges::find(known, word) == known.end())
            throw spelling::unknown(keyword, word, known);
    }
    void operator()(std::vector<std::string>* value) const {
        value->clear();
        if (given.is_none()) return;
        const bool one = py::isinstance<py::str>(given) || py::hasattr(given, "__fspath__") ||
                         py::isinstance<OutgoingSet>(given);
        if (one)
            value->push_back(textOf(given));
        else
            for (const py::handle each : given) value->push_back(textOf(each));
    }
    template <class Number>
    void operator()(std::vector<Number>* value) const {
        if (given.is_none())
            value->clear();
        else if (py::hasattr(given, "__iter__"))
            *value = cast<std::vector<Number>>();
        else
            *value = {cast<Number>()};
        if (row.range)
            for (const Number each : *value) requireWithin(keyword.c_str(), each, *row.range);
    }
    template <class Number>
    void operator()(std::optional<Number>* value) const {
        *value = cast<std::optional<Number>>();
        if (*value && row.range) requireWithin(keyword.c_str(), **value, *row.range);
    }
    void operator()(const jobs::Spelled& value) const {
        const std::string word = textOf(given);
        if (!word.empty()) requireKnown(word);
        value.set(value.at, word);
    }
    template <class Value>
    void operator()(Value* value) const {
        const auto asked = cast<Value>();
        if constexpr (std::is_arithmetic_v<Value>) {
            if (row.range && asked != *value) requireWithin(keyword.c_str(), asked, *row.range);
        }
        *value = asked;
    }
};

/// Type and default in a signature.
struct Stater {
    const OptionRow& row;

    static std::string stated(std::string_view type, const py::object& value) {
        return fmt::format("{} = {}", type, py::repr(value).cast<std::string>());
    }
    std::string operator()(const bool* value) const { return stated("bool", py::bool_(*value)); }
    std::string operator()(const std::optional<bool>* value) const {
        return stated("Optional[bool]", py::cast(*value));
    }
    std::string operator()(const double* value) const {
        return stated("float", py::float_(*value));
    }
    std::string operator()(const std::optional<std::size_t>* value) const {
        return stated("Optional[int]", py::cast(*value));
    }
    std::string operator()(const std::optional<double>* value) const {
        return stated("Optional[float]", py::cast(*value));
    }
    template <class Number>
    std::string operator()(const std::vector<Number>* value) const {
        const char* const type = std::is_integral_v<Number> ? "Union[int, Sequence[int]]"
                                                            : "Union[float, Sequence[float]]";
        return stated(type, py::tuple(py::cast(*value)));
    }
    std::string operator()(const std::vector<std::string>* value) const {
        const bool lights = row.values.syntax == jobs::Syntax::light;
        return stated(lights ? "Lights" : "Names", py::tuple(py::cast(*value)));
    }
    std::string operator()(const std::string* value) const {
        switch (row.values.syntax) {
            case jobs::Syntax::outgoing:
                return stated("OutgoingLike", py::none());
            case jobs::Syntax::list:
                return stated("Names", py::str(*value));
            default:
                break;
        }
        if (row.values.files == jobs::Files::none) return stated("str", py::str(*value));
        return stated("Optional[Path]",
                      value->empty() ? py::object(py::none()) : py::object(py::str(*value)));
    }
    std::string operator()(const jobs::Spelled& value) const {
        const std::string word = value.word(value.at);
        if (row.values.syntax != jobs::Syntax::numbers) return stated("str", py::str(word));
        return stated("Numbers", word.empty() ? py::object(py::none()) : py::str(word));
    }
    template <class Value>
    std::string operator()(const Value* value) const {
        return stated("int", py::int_(*value));
    }
};

/// Options in a help as arguments: "--rank-error" as "rank_error".
std::string withKeywords(std::string_view help) {
    static const std::regex option("--([a-z][a-z-]*[a-z])");
    std::string text(help), out;
    for (std::smatch found; std::regex_search(text, found, option); text = found.suffix()) {
        std::string word = found[1];
        std::ranges::replace(word, '-', '_');
        out += found.prefix().str() + word;
    }
    return out + text;
}

/// The words of a flag that has two on the command line.
std::string flagWords(const jobs::BoundOption& option) {
    if (!std::holds_alternative<bool*>(option.value) || !option.row->values.words) return {};
    const std::vector<jobs::Word> words = option.row->values.words();
    return fmt::format("True for {}, False for {}; ", words[0].text, words[1].text);
}

}  // namespace

Options joined(std::initializer_list<Options> parts) {
    Options all;
    for (const Options& part : parts) all.insert(all.end(), part.begin(), part.end());
    return all;
}

Options without(Options options, std::initializer_list<std::string_view> names) {
    std::erase_if(options, [&](const jobs::BoundOption& option) {
        return std::ranges::find(names, option.row->name) != names.end();
    });
    return options;
}

Options only(Options options, std::initializer_list<std::string_view> names) {
    std::erase_if(options, [&](const jobs::BoundOption& option) {
        return std::ranges::find(names, option.row->name) == names.end();
    });
    return options;
}

void Keywords::dropNone() {
    py::dict given;
    for (const auto& [name, value] : left_)
        if (!value.is_none()) given[name] = value;
    left_ = given;
}

void Keywords::set(const Options& options) {
    for (const jobs::BoundOption& option : options) {
        const std::string keyword = keywordOf(*option.row);
        if (!left_.contains(keyword)) continue;
        const py::object given = left_.attr("pop")(keyword);
        std::visit(Setter{*option.row, keyword, given}, option.value);
        set_.push_back(option.row);
    }
}

const OptionRow* Keywords::misplaced(unsigned inputs) const {
    const auto found = std::ranges::find_if(
        set_, [&](const OptionRow* row) { return (row->inputs & inputs) == 0; });
    return found == set_.end() ? nullptr : *found;
}

py::object Keywords::take(const char* name) {
    return left_.attr("pop")(name, py::none());
}

void Keywords::finish(std::string_view name, const Options& options) const {
    std::vector<std::string> known;
    for (const jobs::BoundOption& option : options) known.push_back(keywordOf(*option.row));
    for (const auto& [key, value] : left_)
        throw UsageError(fmt::format("{}: '{}' is none of {}", name,
                                     py::str(key).cast<std::string>(), fmt::join(known, ", ")));
}

void Keywords::finish() const {
    for (const auto& [name, value] : left_)
        refuseType(fmt::format("no argument {}", py::str(name).cast<std::string>()));
}

py::object optionsFrom(const py::kwargs& keywords, const Options& options) {
    Keywords given(keywords);
    given.set(options);
    py::object progress = given.take("progress");
    given.finish();
    return progress;
}

std::string docstring(const OptionFunction& function) {
    std::string signature = fmt::format("{}({}, *", function.name, function.before), lines;
    for (const jobs::BoundOption& option : function.options) {
        const std::string keyword = keywordOf(*option.row);
        signature +=
            fmt::format(", {}: {}", keyword, std::visit(Stater{*option.row}, option.value));
        lines += fmt::format("\n{:<11} {}{}", keyword, flagWords(option),
                             withKeywords(option.row->help));
    }
    for (const auto& [name, type] : function.others)
        signature += fmt::format(", {}: {} = None", name, type);
    if (function.progress) {
        signature += ", progress: Progress = None";
        lines +=
            "\nprogress    called as progress(part, done, total) from this thread; an exception "
            "from it stops";
    }
    return fmt::format("{}) -> {}\n\n{}\n{}", signature, function.result, function.text, lines);
}

}  // namespace hshfit::python
