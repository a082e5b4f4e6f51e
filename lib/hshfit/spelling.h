#pragma once

// Names that are misspelt: the nearest known one, and the message of every table of names.

#include <hshfit/error.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <numeric>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::spelling {

/// The least number of insertions, deletions and replacements that turns one into the other, where
/// capitals count as small letters.
inline std::size_t distance(std::string_view a, std::string_view b) {
    const auto same = [](unsigned char one, unsigned char other) {
        return std::tolower(one) == std::tolower(other);
    };
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i + 1;
        for (std::size_t j = 0; j < b.size(); ++j) {
            const std::size_t substituted = diagonal + (same(a[i], b[j]) ? 0 : 1);
            diagonal = row[j + 1];
            row[j + 1] = std::min({substituted, row[j] + 1, row[j + 1] + 1});
        }
    }
    return row.back();
}

/// The first name that begins with `word`, else the nearest within two edits; "" if there is none.
template <class Names>
std::string_view nearest(std::string_view word, const Names& known) {
    std::string_view best;
    std::size_t least = 3;
    for (const std::string_view candidate : known) {
        if (word.size() > 1 && candidate.starts_with(word)) return candidate;
        const std::size_t edits = distance(word, candidate);
        // Two edits turn any two-letter word into any other and are no sign of similarity.
        if (edits < least && edits < candidate.size()) {
            least = edits;
            best = candidate;
        }
    }
    return best;
}

/// " (did you mean 'ggx'?)", or "".
template <class Names>
std::string question(std::string_view word, const Names& known) {
    const std::string_view best = nearest(word, known);
    return best.empty() ? "" : fmt::format(" (did you mean '{}'?)", best);
}

/// "unknown basis 'hsw' (did you mean 'hsh'?); known: hsh, sh"
template <class Names>
UsageError unknown(std::string_view what, std::string_view word, const Names& known) {
    return UsageError(fmt::format("unknown {} '{}'{}; known: {}", what, word, question(word, known),
                                  fmt::join(known, ", ")));
}

/// The member `name` of every row of a table, after `first`.
template <class Rows>
std::vector<std::string_view> namesOf(const Rows& rows, std::vector<std::string_view> first = {}) {
    for (const auto& row : rows) first.emplace_back(row.name);
    return first;
}

}  // namespace hshfit::spelling
