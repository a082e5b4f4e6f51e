#pragma once

#include <jobs/common/bounds.h>

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <typeinfo>
#include <variant>
#include <vector>

namespace hshfit::jobs {

/// A word that an option takes.
struct Word {
    std::string text;
    std::string help = {};
};

/// The files that an option takes beside its words.
enum class Files {
    none,
    read,
    readFolder,
    written,
    folder,  ///< that is written
    added,   ///< read if it is there, and added to from run to run
};

/// The syntax of a value.
enum class Syntax {
    word,      ///< one of the words
    list,      ///< several, with commas
    sum,       ///< several, with '+'
    outgoing,  ///< a set of outgoing directions
    brdf,      ///< a specification of a BRDF
    light,     ///< a specification of a light
    either,
};

/// The values of an option, beside those that its type and range state.
struct Values {
    std::vector<Word> (*words)() = nullptr;
    Syntax syntax = Syntax::word;
    Files files = Files::none;
    /// "-" stands for standard input or output; the extension of what is written there. Null: it
    /// does not.
    const char* dash = nullptr;
    bool complete = false;  ///< no other words than these
};

/// A member that is read and set as a word, such as an enumeration; "" stands for none.
struct Spelled {
    void* at;
    std::string (*word)(const void* at);
    void (*set)(void* at, const std::string& word);  ///< throws UsageError
};

/// A member of an options struct, where front ends read its default and set its value.
using OptionValue =
    std::variant<bool*, std::optional<bool>*, int*, std::size_t*, double*,
                 std::optional<std::size_t>*, std::optional<double>*, std::string*,
                 std::vector<std::string>*, std::vector<int>*, std::vector<std::size_t>*, Spelled>;

/// The way to the member in a struct of the type `owner`.
struct Member {
    const std::type_info* owner;
    OptionValue (*in)(void* options);
};

/// One option of a job. The command line with its help, its checks and its completion, the manual,
/// and arguments, defaults, docstrings and stubs of Python come from this row.
///
/// The default is what the struct starts with. A flag that is true at first is --no-NAME on the
/// command line, and an optional one has both.
struct OptionRow {
    std::string_view name;  ///< "max-evaluations": --max-evaluations, and max_evaluations in Python
    Member value;
    std::string_view help;                     ///< other options stand in it as --name
    std::optional<Bounds<double>> range = {};  ///< of numbers
    Values values = {};
    std::string_view without = {};   ///< the help of --no-NAME
    std::string_view fallback = {};  ///< the default in words, where the member does not tell it
    std::string_view keyword = {};   ///< of Python, where it is another word
    unsigned inputs = ~0U;           ///< kinds of inputs that it is for, bits of the job's own

    // The same row with more said.
    template <class Number>
    constexpr OptionRow within(const Bounds<Number>& bounds) const {
        OptionRow row = *this;
        row.range = {static_cast<double>(bounds.least), static_cast<double>(bounds.most)};
        return row;
    }
    constexpr OptionRow takes(const Values& what) const { return with(&OptionRow::values, what); }
    constexpr OptionRow orWithout(std::string_view help_) const {
        return with(&OptionRow::without, help_);
    }
    constexpr OptionRow byDefault(std::string_view words) const {
        return with(&OptionRow::fallback, words);
    }
    constexpr OptionRow inPython(std::string_view word) const {
        return with(&OptionRow::keyword, word);
    }
    constexpr OptionRow onlyFor(unsigned kinds) const { return with(&OptionRow::inputs, kinds); }

private:
    template <class Value>
    constexpr OptionRow with(Value OptionRow::*member, const Value& value) const {
        OptionRow row = *this;
        row.*member = value;
        return row;
    }
};

/// The rows of one options struct.
template <class Options>
struct OptionRows {
    std::span<const OptionRow> rows;
};

/// As "max_evaluations".
std::string keywordOf(const OptionRow& row);

namespace options {

template <class Struct, class Value>
Struct ownerOf(Value Struct::*member);

template <class Struct>
auto& memberOf(Struct& options, auto first, auto... rest) {
    if constexpr (sizeof...(rest) == 0)
        return options.*first;
    else
        return memberOf(options.*first, rest...);
}

template <auto First, auto... Rest>
auto& memberIn(void* options) {
    using Struct = decltype(ownerOf(First));
    return memberOf(*static_cast<Struct*>(options), First, Rest...);
}

/// A member, or a member of a member.
template <auto First, auto... Rest>
constexpr Member at = {&typeid(decltype(ownerOf(First))), [](void* options) -> OptionValue {
                           return &memberIn<First, Rest...>(options);
                       }};

/// The same of a member that `parse` reads and `name` writes as a word.
template <auto parse, auto name, auto First, auto... Rest>
constexpr Member spelled = {
    &typeid(decltype(ownerOf(First))), [](void* options) -> OptionValue {
        auto& member = memberIn<First, Rest...>(options);
        using Type = std::remove_reference_t<decltype(member)>;
        return Spelled{&member,
                       [](const void* at) {
                           const auto& value = *static_cast<const Type*>(at);
                           if constexpr (std::is_enum_v<Type>)
                               return std::string(name(value));
                           else
                               return value ? std::string(name(*value)) : std::string();
                       },
                       [](void* at, const std::string& word) {
                           auto& value = *static_cast<Type*>(at);
                           if constexpr (std::is_enum_v<Type>)
                               value = parse(word);
                           else if (word.empty())
                               value.reset();
                           else
                               value = parse(word);
                       }};
    }};

}  // namespace options

/// An option of an options struct, in the place where its value lies.
struct BoundOption {
    const OptionRow* row;
    OptionValue value;
};
std::vector<BoundOption> boundOptions(std::span<const OptionRow> rows, void* options,
                                      const std::type_info& type);
template <class Options>
std::vector<BoundOption> boundOptions(OptionRows<Options> table, Options& options) {
    return boundOptions(table.rows, &options, typeid(Options));
}

}  // namespace hshfit::jobs
