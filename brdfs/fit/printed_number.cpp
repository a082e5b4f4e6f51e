#include <brdfs/fit/printed_number.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

namespace hshfit::brdfs {
namespace {

/// The signs of one kind of text.
struct Signs {
    std::string (*power)(int);  ///< "times ten to the"
    std::string_view minus, either, infinite, none;
};

std::string latexPower(int power) {
    return fmt::format("\\times10^{{{}}}", power);
}

std::string plainPower(int power) {
    constexpr std::array<std::string_view, 10> raised{"⁰", "¹", "²", "³", "⁴",
                                                      "⁵", "⁶", "⁷", "⁸", "⁹"};
    std::string text = "×10";
    for (const char c : std::to_string(power))
        text += c == '-' ? "⁻" : raised[static_cast<std::size_t>(c - '0')];
    return text;
}

constexpr Signs latex{latexPower, "-", "\\pm ", "\\infty", "\\mathrm{nan}"};
constexpr Signs plain{plainPower, "−", " ± ", "∞", "none"};

/// The exponent behind the 'e' of a number in scientific form.
int exponentOf(const std::string& text, std::size_t e) {
    int power = 0;
    std::from_chars(text.data() + e + (text[e + 1] == '+' ? 2 : 1), text.data() + text.size(),
                    power);
    return power;
}

/// The power of ten of the first digit of a number that is not 0, once rounded to so many digits.
int powerOf(double number, int digits) {
    const std::string text = fmt::format("{:.{}e}", std::abs(number), digits - 1);
    return exponentOf(text, text.find('e'));
}

std::string withPower(std::string number, int power, const Signs& signs) {
    if (number.starts_with('-')) number.replace(0, 1, signs.minus);
    return power == 0 ? number : number + signs.power(power);
}

std::string bare(double value, int digits, const Signs& signs) {
    if (std::isnan(value)) return std::string(signs.none);
    if (std::isinf(value)) return std::string(value > 0 ? "" : signs.minus) += signs.infinite;
    const std::string text = fmt::format("{:.{}g}", value, digits);
    const std::size_t e = text.find('e');
    return e == text.npos ? withPower(text, 0, signs)
                          : withPower(text.substr(0, e), exponentOf(text, e), signs);
}

std::string bareError(double error, const Signs& signs) {
    if (!std::isfinite(error) || !(error > 0)) return bare(error, 2, signs);
    constexpr int leastFixed = -4, mostFixed = 5;
    const int power = powerOf(error, 2);
    if (power < leastFixed || power >= mostFixed)
        return withPower(fmt::format("{:.1f}", error / std::pow(10, power)), power, signs);
    const double unit = std::pow(10, power - 1);
    return fmt::format("{:.{}f}", std::round(error / unit) * unit, std::max(1 - power, 0));
}

std::string withError(double value, double error, const Signs& signs) {
    constexpr int ofAlone = 6, ofError = 2;
    if (!std::isfinite(value) || !std::isfinite(error) || !(error > 0))
        return bare(value, ofAlone, signs);
    const int last = powerOf(error, ofError) - 1;  // of the second digit of the error
    const double unit = std::pow(10, last), rounded = std::round(value / unit) * unit;
    const int first = rounded == 0 ? last + 1 : std::max(powerOf(rounded, 15), last + 1);
    constexpr int mostDigits = 9, leastFixed = -3, mostFixed = 5;
    if (first - last >= mostDigits)
        return bare(value, ofAlone, signs) + std::string(signs.either) +
               bare(error, ofError, signs);
    const bool fixed = last <= 0 && first >= leastFixed && first < mostFixed;
    const int power = fixed ? 0 : first;
    return withPower(
        fmt::format("{:.{}f}({:.0f})", value / std::pow(10, power), power - last, error / unit),
        power, signs);
}

}  // namespace

std::string latexNumber(double value, double error) {
    return withError(value, error, latex);
}
std::string latexValue(double value, int digits) {
    return bare(value, digits, latex);
}
std::string plainNumber(double value, double error) {
    return withError(value, error, plain);
}
std::string plainValue(double value, int digits) {
    return bare(value, digits, plain);
}
std::string latexError(double error) {
    return bareError(error, latex);
}
std::string plainError(double error) {
    return bareError(error, plain);
}

}  // namespace hshfit::brdfs
