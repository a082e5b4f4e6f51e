#pragma once

#include <jobs/common/option_row.h>

#include <string>
#include <vector>

namespace hshfit::jobs {

/// Names and helps of a table.
template <class Rows>
std::vector<Word> wordsOf(const Rows& rows) {
    std::vector<Word> words;
    for (const auto& row : rows) words.push_back({std::string(row.name), std::string(row.help)});
    return words;
}

/// Names and helps of a table whose rows call the help a summary.
template <class Rows>
std::vector<Word> summariesOf(const Rows& rows) {
    std::vector<Word> words;
    for (const auto& row : rows) words.push_back({std::string(row.name), std::string(row.summary)});
    return words;
}

/// The words and "all".
std::vector<Word> withAll(std::vector<Word> words);

// Words of options that several commands have, from the catalogs and, of enumerations, in the order
// of their messages.
std::vector<Word> basisLists();  ///< with all
std::vector<Word> basisWords();
std::vector<Word> formWords();
std::vector<Word> lossWords();
std::vector<Word> metricLists();  ///< with all
std::vector<Word> metricWords();
std::vector<Word> modelWords();
std::vector<Word> numberWords();
std::vector<Word> precisionWords();
std::vector<Word> repairWords();  ///< with all
std::vector<Word> sigmaWords();
std::vector<Word> splitWords();
std::vector<Word> storageWords();
std::vector<Word> targetWords();
std::vector<Word> windowWords();
std::vector<Word> writerWords();

/// Uncertainties of samples.
inline constexpr Values sigmaValues{.words = sigmaWords, .files = Files::read, .dash = ".csv"};

}  // namespace hshfit::jobs
