#pragma once

#include "option_rows.h"

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace hshfit::cli {

/// The words that may stand in the place of a word that is being typed.
struct Candidates {
    std::vector<Word> words;  ///< whole ones, of which the typed word is the beginning
    Files files = Files::none;
    bool open = false;  ///< a word may go on, so that no space belongs behind it
};

/// `words` follow the name of the program; the last, perhaps empty, is the one being typed.
Candidates candidatesOf(const CLI::App& program, const std::vector<std::string>& words);

/// Completions of the value of an option.
Candidates valuesOf(const Values& row, const std::string& typed);

}  // namespace hshfit::cli
