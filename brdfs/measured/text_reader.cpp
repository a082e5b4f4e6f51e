#include <brdfs/measured/text_reader.h>

#include <fmt/core.h>

#include <charconv>
#include <limits>

namespace hshfit::brdfs {
namespace {

bool isBlank(char c) {
    return c == ' ' || c == '\t';
}

/// from_chars tells neither overflow from underflow nor the sign: the exponent's sign does, since
/// no text in a data file has the 300 digits that would be needed without one.
double outOfRange(std::string_view number) {
    const std::size_t exponent = number.find_first_of("eE");
    const bool tiny = exponent != std::string_view::npos && exponent + 1 < number.size() &&
                      number[exponent + 1] == '-';
    const double size = tiny ? 0.0 : std::numeric_limits<double>::infinity();
    return number.front() == '-' ? -size : size;
}

}  // namespace

bool takeNumber(std::string_view& text, double& value) {
    const std::size_t sign = text.size() > 1 && text[0] == '+' && text[1] != '-' ? 1 : 0;
    const char* begin = text.data() + sign;
    const auto [end, code] = std::from_chars(begin, text.data() + text.size(), value);
    if (code == std::errc::invalid_argument) return false;
    const auto length = static_cast<std::size_t>(end - begin);
    if (code == std::errc::result_out_of_range) value = outOfRange({begin, length});
    text.remove_prefix(sign + length);
    return true;
}

TextReader::TextReader(std::string_view text, std::string where)
    : where_(std::move(where)), rest_(text) {}

bool TextReader::next() {
    if (rest_.empty()) return false;
    const std::size_t end = rest_.find_first_of("\r\n");
    line_ = rest_.substr(0, end);
    if (end == std::string_view::npos) {
        rest_ = {};
    } else {
        const bool two = rest_.substr(end).starts_with("\r\n");
        rest_.remove_prefix(end + (two ? 2 : 1));
    }
    ahead_ = line_;
    first_ = true;
    ++number_;
    return true;
}

bool TextReader::blank() const {
    return line_.find_first_not_of(" \t") == std::string_view::npos;
}

void TextReader::skipBlanks() {
    while (!ahead_.empty() && isBlank(ahead_.front())) ahead_.remove_prefix(1);
}

bool TextReader::takeNumber(double& value, char separator) {
    skipBlanks();
    if (ahead_.empty()) return false;
    if (separator && !first_ && ahead_.front() == separator) {
        ahead_.remove_prefix(1);
        skipBlanks();
    }
    const std::string_view from = ahead_;
    const bool taken = brdfs::takeNumber(ahead_, value);
    const bool ended = ahead_.empty() || isBlank(ahead_.front()) ||
                       (separator != 0 && ahead_.front() == separator);
    if (!taken || !ended) {
        const std::string_view word = from.substr(0, from.find_first_of(" \t,;"));
        throw error(fmt::format("'{}' is no number", word.substr(0, 40)));
    }
    first_ = false;
    return true;
}

std::string_view TextReader::takeWord() {
    skipBlanks();
    const std::string_view word = ahead_.substr(0, ahead_.find_first_of(" \t"));
    ahead_.remove_prefix(word.size());
    return word;
}

void TextReader::takeNumbers(std::vector<double>& values, char separator) {
    values.clear();
    for (double value; takeNumber(value, separator);) values.push_back(value);
}

InputError TextReader::error(std::string_view message) const {
    return InputError(fmt::format("{}: line {}: {}", where_, number_, message));
}

}  // namespace hshfit::brdfs
