#pragma once

#include <jobs/common/bounds.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <charconv>
#include <cmath>
#include <string>
#include <type_traits>

namespace hshfit::cli {

/// The check of a number, which is given as `Given`; help and message state its ends alike.
template <class Number, class Given = Number>
CLI::Validator within(const jobs::Bounds<Number>& bounds) {
    const auto text = [](Number end) {
        if constexpr (std::is_integral_v<Number>)
            return fmt::format("{}", end);
        else
            return fmt::format("{:g}", end);
    };
    const std::string least = text(bounds.least), most = text(bounds.most);
    const auto check = [bounds, least, most](const std::string& given) {
        Given number{};
        const bool in = CLI::detail::lexical_cast(given, number) &&
                        number >= static_cast<Given>(bounds.least) &&
                        number <= static_cast<Given>(bounds.most);
        if (in) return std::string();
        double written = 0;
        const bool fraction = std::is_integral_v<Given> &&
                              CLI::detail::lexical_cast(given, written) &&
                              written >= static_cast<double>(bounds.least) &&
                              written <= static_cast<double>(bounds.most);
        return fmt::format("'{}' is no{} within {} to {}", given,
                           fraction ? " whole number in digits alone" : "t", least, most);
    };
    return {check, fmt::format("in [{} - {}]", least, most)};
}

/// The check of a whole number, 1e6 among them.
inline CLI::Validator whole() {
    const auto check = [](const std::string& given) {
        double number = 0;
        const bool is = CLI::detail::lexical_cast(given, number) && number == std::floor(number);
        return is ? std::string() : fmt::format("'{}' is no whole number", given);
    };
    return {check, ""};
}

/// Lets "1%" stand for 0.01.
inline CLI::Validator percents() {
    const auto convert = [](std::string& text) {
        if (!text.ends_with('%')) return std::string();
        double percent = 0;
        const char* end = text.data() + text.size() - 1;
        const auto [next, error] = std::from_chars(text.data(), end, percent);
        if (error == std::errc() && next == end) text = fmt::format("{}", percent / 100);
        return std::string();
    };
    return {convert, ""};
}

}  // namespace hshfit::cli
