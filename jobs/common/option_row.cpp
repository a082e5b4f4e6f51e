#include "option_row.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace hshfit::jobs {

std::string keywordOf(const OptionRow& row) {
    std::string word(row.keyword.empty() ? row.name : row.keyword);
    std::ranges::replace(word, '-', '_');
    return word;
}

std::vector<BoundOption> boundOptions(std::span<const OptionRow> rows, void* options,
                                      const std::type_info& type) {
    std::vector<BoundOption> bound;
    for (const OptionRow& row : rows) {
        if (*row.value.owner != type)
            throw std::logic_error(fmt::format("option {}: a member of another struct", row.name));
        bound.push_back({&row, row.value.in(options)});
    }
    return bound;
}

}  // namespace hshfit::jobs
