#pragma once

#include <jobs/common/bounds.h>
#include <jobs/common/option_members.h>

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <typeinfo>
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
    addedFolder,
};
constexpr bool isFolder(Files files) {
    return files == Files::readFolder || files == Files::folder || files == Files::addedFolder;
}

/// The syntax of a value.
enum class Syntax {
    word,      ///< one of the words
    list,      ///< several, with commas
    numbers,   ///< with commas, one value
    sum,       ///< several, with '+'
    outgoing,  ///< a set of outgoing directions
    brdf,      ///< a specification of a BRDF
    light,     ///< a specification of a light
    either,
};

/// Other ways to state a number.
enum class Unit {
    none,
    percent,  ///< 1% is 0.01
    bytes,    ///< 8G, on the command line alone
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

/// One option of a job. The command line with its help, its checks and its completion, the manual,
/// and arguments, defaults, docstrings and stubs of Python come from this row.
///
/// The default is what the struct starts with. A flag that is true at first is --no-NAME on the
/// command line, and an optional one has both; one with two words takes these, the first for true.
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
    Unit unit = Unit::none;
    std::string_view also = {};  ///< another name on the command line
    /// An option that it is given with, and one or more, with spaces, that it excludes.
    std::string_view needs = {}, excludes = {};

private:
    template <class Value>
    constexpr OptionRow having(Value OptionRow::*member,
                               const std::type_identity_t<Value>& said) const {
        OptionRow row = *this;
        row.*member = said;
        return row;
    }

public:
    // The row with one more statement.
    template <class Number>
    constexpr OptionRow within(const Bounds<Number>& bounds) const {
        return having(&OptionRow::range, Bounds<double>{static_cast<double>(bounds.least),
                                                        static_cast<double>(bounds.most)});
    }
    constexpr OptionRow takes(const Values& what) const { return having(&OptionRow::values, what); }
    constexpr OptionRow orWithout(std::string_view said) const {
        return having(&OptionRow::without, said);
    }
    constexpr OptionRow byDefault(std::string_view words) const {
        return having(&OptionRow::fallback, words);
    }
    constexpr OptionRow inPython(std::string_view word) const {
        return having(&OptionRow::keyword, word);
    }
    constexpr OptionRow onlyFor(unsigned kinds) const { return having(&OptionRow::inputs, kinds); }
    constexpr OptionRow in(Unit other) const { return having(&OptionRow::unit, other); }
    constexpr OptionRow orNamed(std::string_view word) const {
        return having(&OptionRow::also, word);
    }
    constexpr OptionRow with(std::string_view option) const {
        return having(&OptionRow::needs, option);
    }
    constexpr OptionRow notWith(std::string_view options) const {
        return having(&OptionRow::excludes, options);
    }
};

/// The rows of one options struct.
template <class Options>
struct OptionRows {
    std::span<const OptionRow> rows;
};

/// As "max_evaluations".
std::string keywordOf(const OptionRow& row);

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
