#pragma once

#include <jobs/common/bounds.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <charconv>
#include <string>

namespace hshfit::cli {

/// The check of an option whose bounds other front ends have too.
template <class Number>
CLI::Range within(const jobs::Bounds<Number>& bounds) {
    return CLI::Range(bounds.least, bounds.most);
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
    return {convert, "", "percents"};
}

}  // namespace hshfit::cli
