#include <brdfs/measured/bsdf_xml/data_cursor.h>
#include <brdfs/measured/text_reader.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {

char DataCursor::next() {
    const std::size_t found = rest_.find_first_not_of(" \t\r\n");
    rest_.remove_prefix(std::min(found, rest_.size()));
    return rest_.empty() ? '\0' : rest_.front();
}

std::string DataCursor::found() {
    if (next() == 0) return "the end of the data";
    std::string word(rest_.substr(0, std::min<std::size_t>(rest_.find_first_of(" \t\r\n,"), 20)));
    for (char& c : word)
        if (static_cast<unsigned char>(c) < 32 || c == 127) c = '?';
    return fmt::format("'{}'", word);
}

bool DataCursor::take(double& value) {
    const char first = next();
    if (first == 0 || first == '{' || first == '}') return false;
    const std::string_view before = rest_;
    const std::size_t start = offset();
    constexpr std::string_view ends = " \t\r\n,{}";
    const bool taken = takeNumber(rest_, value);
    if (!taken || (!rest_.empty() && ends.find(rest_.front()) == std::string_view::npos)) {
        rest_ = before;
        throw error(fmt::format("{} is no number", found()));
    }
    if (std::isfinite(value) && std::abs(value) > 1e30) {
        rest_ = before;
        throw error(fmt::format("{} is too large for a BSDF in 1/sr (at most 1e30)", found()));
    }
    if (!std::isfinite(value) && corruptOffset_ == 0) corruptOffset_ = start;
    skipComma();
    return true;
}

}  // namespace hshfit::brdfs
