#include <hshfit/specification/parameters.h>

#include <hshfit/error.h>
#include <hshfit/spelling.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <system_error>

namespace hshfit::inline specification {
namespace {

std::vector<std::string_view> split(std::string_view text, char separator) {
    std::vector<std::string_view> parts;
    while (true) {
        const std::size_t end = text.find(separator);
        parts.push_back(text.substr(0, end));
        if (end == std::string_view::npos) return parts;
        text.remove_prefix(end + 1);
    }
}

double parseNumber(std::string_view owner, const Parameter& parameter, std::string_view value,
                   std::string_view part) {
    double number = 0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), number);
    const std::string valid = validValues(parameter);
    // "1e999" is a number, but one that no double holds.
    if (error == std::errc::result_out_of_range || !std::isfinite(number))
        throw UsageError(fmt::format("{}: {}={} is not a finite number; valid: {}", owner,
                                     parameter.name, value, valid));
    if (error != std::errc{} || end != part.data() + part.size())
        throw UsageError(fmt::format("{}: {}='{}' is not a number; valid: {}", owner,
                                     parameter.name, value, valid));
    if (number < parameter.min || number > parameter.max)
        throw UsageError(fmt::format("{}: {}={} is out of range; valid: {}", owner, parameter.name,
                                     value, valid));
    return number + 0.0;  // -0 becomes 0
}

std::vector<double> greyAsOne(std::vector<double> values) {
    if (values.size() == 3 && values[0] == values[1] && values[1] == values[2]) values.resize(1);
    return values;
}

std::vector<double> parseNumbers(std::string_view owner, const Parameter& parameter,
                                 std::string_view value) {
    const std::vector<std::string_view> parts = split(value, '/');
    const bool colour = parameter.kind == Parameter::Kind::colour;
    if (parts.size() != 1 && !(colour && parts.size() == 3))
        throw UsageError(fmt::format(
            "{}: {}={} has {} values; {}; valid: {}", owner, parameter.name, value, parts.size(),
            colour ? "it takes one, or three for R/G/B" : "it takes one number for all channels",
            validValues(parameter)));
    std::vector<double> numbers;
    for (const std::string_view part : parts)
        numbers.push_back(parseNumber(owner, parameter, value, part));
    return greyAsOne(std::move(numbers));
}

std::string parseChoice(std::string_view owner, const Parameter& parameter,
                        std::string_view value) {
    if (parameter.kind == Parameter::Kind::text) return std::string(value);
    if (std::ranges::find(parameter.choices, value) == parameter.choices.end())
        throw UsageError(fmt::format("{}: {}='{}' is unknown; valid: {}", owner, parameter.name,
                                     value, validValues(parameter)));
    return std::string(value);
}

bool isWord(const Parameter& parameter) {
    return parameter.kind == Parameter::Kind::choice || parameter.kind == Parameter::Kind::text;
}

const Parameter& findParameter(std::string_view owner, std::span<const Parameter> declared,
                               std::string_view key) {
    std::vector<std::string_view> names;
    for (const Parameter& parameter : declared) {
        if (parameter.name == key) return parameter;
        names.push_back(parameter.name);
    }
    throw UsageError(fmt::format("{}: unknown key '{}'{}; valid: {}", owner, key,
                                 suggestion(key, names),
                                 names.empty() ? std::string("none") : joined(names)));
}

void readItem(std::string_view owner, std::span<const Parameter> declared, std::string_view item,
              Parameters& parsed) {
    const std::size_t equals = item.find('=');
    if (equals == std::string_view::npos || equals == 0 || equals + 1 == item.size())
        throw UsageError(fmt::format("{}: '{}' is not of the form key=value", owner, item));
    const Parameter& parameter = findParameter(owner, declared, item.substr(0, equals));
    const std::string_view value = item.substr(equals + 1);
    const bool fresh =
        isWord(parameter)
            ? parsed.words
                  .try_emplace(std::string(parameter.name), parseChoice(owner, parameter, value))
                  .second
            : parsed.numbers
                  .try_emplace(std::string(parameter.name), parseNumbers(owner, parameter, value))
                  .second;
    if (!fresh) throw UsageError(fmt::format("{}: {} is given twice", owner, parameter.name));
    parsed.stated.insert(std::string(parameter.name));
}

/// Throws UsageError for "alpha=0,3", whose comma is a decimal point.
void refuseDecimalComma(std::string_view owner, std::string_view before, std::string_view item) {
    constexpr std::string_view digits = "0123456789";
    const bool isFraction = item.find_first_not_of(digits) == std::string_view::npos;
    if (!isFraction || before.find('=') == std::string_view::npos ||
        digits.find(before.back()) == std::string_view::npos)
        return;
    throw UsageError(
        fmt::format("{0}: '{1},{2}': commas stand between keys; a number has a point: "
                    "{1}.{2}",
                    owner, before, item));
}

/// Fills in the default of one parameter, or adds its value to the canonical text.
void complete(std::string_view owner, const Parameter& parameter, Parameters& parsed) {
    const std::string separator = parsed.text.empty() ? "" : ",";
    const std::string name(parameter.name);
    if (isWord(parameter)) {
        const bool choice = parameter.kind == Parameter::Kind::choice;
        const std::string fallback(choice ? parameter.choices.front() : "");
        const std::string& word = parsed.words.try_emplace(name, fallback).first->second;
        if (word != fallback) parsed.text += fmt::format("{}{}={}", separator, name, word);
        return;
    }
    const auto found = parsed.numbers.find(name);
    if (found == parsed.numbers.end()) {
        if (!parameter.fallback)
            throw UsageError(fmt::format("{}: {} has to be given; valid: {}", owner, name,
                                         validValues(parameter)));
        parsed.numbers.emplace(name, std::vector<double>{*parameter.fallback});
        return;
    }
    const std::vector<double>& values = found->second;
    if (values.size() == 1 && parameter.fallback && values[0] == *parameter.fallback) return;
    parsed.text += fmt::format("{}{}={}", separator, name, fmt::join(values, "/"));
}

}  // namespace

std::string_view pathIn(std::string_view spec) {
    std::error_code error;
    for (std::size_t end = spec.size(); end > 0; end = spec.rfind(':', end - 1)) {
        if (end == std::string_view::npos) break;
        if (std::filesystem::exists(spec.substr(0, end), error)) return spec.substr(0, end);
    }
    return {};
}

double Parameters::number(std::string_view name) const {
    const auto found = numbers.find(name);
    assert(found != numbers.end() && found->second.size() == 1);
    return found->second.front();
}

std::vector<double> Parameters::colour(std::string_view name) const {
    const auto found = numbers.find(name);
    assert(found != numbers.end());
    return found->second;
}

std::string Parameters::choice(std::string_view name) const {
    const auto found = words.find(name);
    assert(found != words.end());
    return found->second;
}

bool Parameters::given(std::string_view name) const {
    return stated.contains(name);
}

std::string Parameters::canonical() const {
    return text;
}

void Parameters::set(std::string_view name, std::vector<double> values) {
    for (double& value : values) value += 0.0;  // -0 becomes 0
    numbers.insert_or_assign(std::string(name), greyAsOne(std::move(values)));
    stated.insert(std::string(name));
}

Parameters readParameters(std::string_view owner, std::span<const Parameter> declared,
                          std::string_view text) {
    Parameters parsed;
    if (text.empty()) return parsed;
    const std::vector<std::string_view> items = split(text, ',');
    for (std::size_t k = 1; k < items.size(); ++k)
        if (!items[k].empty() && !items[k - 1].empty())
            refuseDecimalComma(owner, items[k - 1], items[k]);
    for (const std::string_view item : items) readItem(owner, declared, item, parsed);
    return parsed;
}

Parameters completed(std::string_view owner, std::span<const Parameter> declared,
                     Parameters stated) {
    for (const Parameter& parameter : declared) complete(owner, parameter, stated);
    return stated;
}

Parameters parseParameters(std::string_view owner, std::span<const Parameter> declared,
                           std::string_view text) {
    return completed(owner, declared, readParameters(owner, declared, text));
}

std::string validValues(const Parameter& parameter) {
    if (parameter.kind == Parameter::Kind::text)
        return fmt::format("a text such as {}", parameter.choices.front());
    if (parameter.kind == Parameter::Kind::choice)
        return fmt::format("{}", fmt::join(parameter.choices, "|"));
    const std::string range = fmt::format("{} to {}", parameter.min, parameter.max);
    return parameter.kind == Parameter::Kind::colour ? range + ", or three such values as r/g/b"
                                                     : range;
}

std::size_t editDistance(std::string_view a, std::string_view b) {
    return spelling::distance(a, b);
}

std::string suggestion(std::string_view word, std::span<const std::string_view> known) {
    return spelling::question(word, known);
}

std::string joined(std::span<const std::string_view> words) {
    return fmt::format("{}", fmt::join(words, ", "));
}

}  // namespace hshfit::inline specification
