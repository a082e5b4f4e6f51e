#pragma once

// Enumerations as words of options.

#include <jobs/common/option_row.h>

#include <hshfit/spelling.h>

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::jobs {

/// The word of one value of an enumeration.
struct EnumWord {
    std::string_view name, help = {};
};

/// An enumeration by a table of EnumWord, in the order of its values from 0.
template <const auto& rows, class Enumeration>
struct EnumWords {
    /// Throws UsageError for a word that is not in the table.
    static Enumeration parse(const std::string& word) {
        for (std::size_t k = 0; k < std::size(rows); ++k)
            if (rows[k].name == word) return static_cast<Enumeration>(k);
        throw spelling::unknown("value", word, spelling::namesOf(rows));
    }
    static std::string_view name(Enumeration value) {
        return rows[static_cast<std::size_t>(value)].name;
    }
    static std::vector<Word> words() {
        std::vector<Word> all;
        for (const EnumWord& row : rows)
            all.push_back({std::string(row.name), std::string(row.help)});
        return all;
    }
};

}  // namespace hshfit::jobs
