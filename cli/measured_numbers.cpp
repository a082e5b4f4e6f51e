#include "measured_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>

namespace hshfit::cli {
namespace {

/// The power of ten of the first digit of a number that is not 0, once rounded to two digits.
int leadingPower(double number) {
    const std::string text = fmt::format("{:.1e}", std::abs(number));
    int power = 0;
    const char* begin = text.data() + text.find('e') + 1;
    std::from_chars(begin + (*begin == '+' ? 1 : 0), text.data() + text.size(), power);
    return power;
}

}  // namespace

std::string withError(double value, double error) {
    constexpr int mostDigits = 8;
    if (!std::isfinite(value)) return "none";
    if (!std::isfinite(error) || !(error > 0)) return fmt::format("{:.6g} +- {:.2g}", value, error);
    const int last = leadingPower(error) - 1;  // the power of the second digit of the error
    const int first = value == 0 ? last : std::max(leadingPower(value), last);
    const int digits = std::min(first - last + 1, mostDigits);
    constexpr int leastFixed = -4, mostFixed = 6;
    if (first < leastFixed || first >= mostFixed)
        return fmt::format("{:.{}e} +- {:.1e}", value, digits - 1, error);
    if (last > 0) {
        const double unit = std::pow(10, last);
        return fmt::format("{:.0f} +- {:.0f}", std::round(value / unit) * unit,
                           std::round(error / unit) * unit);
    }
    const int decimals = std::min(-last, mostDigits - 1 - first);
    // An error far below the number would have more zeros than digits.
    return -last > 8 || decimals < -last
               ? fmt::format("{:.{}f} +- {:.1e}", value, decimals, error)
               : fmt::format("{:.{}f} +- {:.{}f}", value, decimals, error, decimals);
}

std::string withShortNumbers(std::string_view text) {
    std::string out;
    for (std::size_t at = 0; at < text.size();) {
        const auto isWord = [](char c) {
            return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
        };
        const bool within = at > 0 && (isWord(text[at - 1]) || text[at - 1] == '.');
        double number = 0;
        const auto parsed = std::from_chars(text.data() + at, text.data() + text.size(), number);
        const bool digit = std::isdigit(static_cast<unsigned char>(text[at])) != 0;
        if (within || !digit || parsed.ec != std::errc()) {
            out += text[at++];
            continue;
        }
        const auto count = static_cast<std::size_t>(parsed.ptr - (text.data() + at));
        const std::string shorter = fmt::format("{:.6g}", number);
        out += shorter.size() < count ? shorter : std::string(text.substr(at, count));
        at += count;
    }
    return out;
}

}  // namespace hshfit::cli
