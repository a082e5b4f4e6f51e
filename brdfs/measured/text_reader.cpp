#include <brdfs/measured/text_reader.h>

#include <fmt/core.h>

#include <charconv>
#include <cstdint>
#include <cstring>
#include <limits>

namespace hshfit::brdfs {
namespace {

bool isBlank(char c) {
    return c == ' ' || c == '\t';
}

/// from_chars reports neither the sign nor whether a number overflowed or underflowed. The
/// exponent's sign decides, since a number without an exponent would need 300 digits.
double outOfRange(std::string_view number) {
    const std::size_t exponent = number.find_first_of("eE");
    const bool tiny = exponent != std::string_view::npos && exponent + 1 < number.size() &&
                      number[exponent + 1] == '-';
    const double size = tiny ? 0.0 : std::numeric_limits<double>::infinity();
    return number.front() == '-' ? -size : size;
}

/// The length of a decimal number without exponent whose value is the quotient of an integer below
/// 2^53 and a power of ten up to 10^22: both are doubles, and one division rounds correctly
/// (Clinger 1990, 10.1145/93542.93557). 0 if the number at the front is not of this kind.
std::size_t takeShort(const char* begin, const char* end, double& value) {
    static constexpr double powers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                        1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                        1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    const char* at = begin + (begin != end && *begin == '-' ? 1 : 0);
    const char* const first = at;
    std::uint64_t digits = 0;
    const auto takeDigits = [&] {
        for (; at != end && static_cast<unsigned char>(*at - '0') < 10; ++at) {
            digits = 10 * digits + static_cast<unsigned char>(*at - '0');
        }
    };
    takeDigits();
    std::ptrdiff_t whole = at - first, decimals = 0;
    if (at != end && *at == '.') {
        const char* const point = ++at;
        takeDigits();
        decimals = at - point;
    }
    // Nineteen digits fit into 64 bits.
    const std::ptrdiff_t count = whole + decimals;
    if (count == 0 || count > 19 || digits > (std::uint64_t{1} << 53)) return 0;
    if (at != end && (*at == 'e' || *at == 'E')) return 0;
    const double size = static_cast<double>(digits) / powers[decimals];
    value = first == begin ? size : -size;
    return static_cast<std::size_t>(at - begin);
}

}  // namespace

bool takeNumber(std::string_view& text, double& value) {
    if (const std::size_t length = takeShort(text.data(), text.data() + text.size(), value)) {
        text.remove_prefix(length);
        return true;
    }
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
    const char* const begin = rest_.data();
    const char* const last = begin + rest_.size();
    const auto find = [](const char* from, const char* to, char c) {
        const void* at = std::memchr(from, c, static_cast<std::size_t>(to - from));
        return at ? static_cast<const char*>(at) : to;
    };
    // The position is kept, so that a file with CR line ends is not searched for LF on every line.
    if (!feed_ || feed_ < begin) feed_ = find(begin, last, '\n');
    const char* const end = find(begin, feed_, '\r');
    line_ = {begin, static_cast<std::size_t>(end - begin)};
    if (end == last) {
        rest_ = {};
    } else {
        const bool two = *end == '\r' && end + 1 == feed_ && feed_ != last;
        rest_.remove_prefix(line_.size() + (two ? 2 : 1));
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
