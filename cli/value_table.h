#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace hshfit::cli {

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
    word,   ///< one of the words
    list,   ///< several, with commas
    sum,    ///< several, with '+'
    brdf,   ///< a specification of a BRDF
    light,  ///< a specification of a light
    either,
};

/// The values of an option, or of an argument by its place. Completion comes from these rows, and
/// from the choices and ranges that options state themselves.
struct ValueRow {
    std::string_view command;  ///< empty: every command that has the option
    std::string_view option;   ///< "--basis", or the name of an argument
    std::vector<Word> (*words)() = nullptr;
    Syntax syntax = Syntax::word;
    Files files = Files::none;
    /// "-" stands for standard input or output; the extension of what is written there. Null: it
    /// does not.
    const char* dash = nullptr;
};

std::span<const ValueRow> valueTable();

/// The row of an option of a command; null if there is none.
const ValueRow* findValues(const CLI::App& command, const CLI::Option& option);

/// Whether the option names a file or a folder that the command writes.
bool isWritten(const CLI::App& command, const CLI::Option& option);

/// The choices that the option checks its value against (CLI::IsMember); none if it does not.
std::vector<std::string> choicesOf(const CLI::Option& option);

}  // namespace hshfit::cli
