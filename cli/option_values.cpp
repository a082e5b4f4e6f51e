#include "option_values.h"

#include "option_rows.h"

#include <hshfit/accuracy/metrics.h>
#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/gpu/containers/targets.h>
#include <hshfit/representation/forms/form.h>
#include <hshfit/tradeoff/sweep.h>
#include <hshfit/wings.h>

#include <brdfs/repair.h>
#include <brdfs/rows/spec.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <charconv>
#include <string_view>

namespace hshfit::cli {
namespace {

bool takesCommas(const CLI::App& command, const std::string& name) {
    const CLI::Option* option = command.get_option_no_throw(name);
    const jobs::OptionRow* row = option ? findRow(command, *option) : nullptr;
    constexpr Syntax withCommas[] = {Syntax::list, Syntax::numbers, Syntax::outgoing,
                                     Syntax::light};
    return row && std::ranges::find(withCommas, row->values.syntax) != std::end(withCommas);
}

bool isNumber(std::string_view word) {
    double number = 0;
    const char* end = word.data() + word.size();
    const auto parsed = std::from_chars(word.data(), end, number);
    return parsed.ec == std::errc() && parsed.ptr == end;
}

template <class Parse>
bool parses(Parse parse, const std::string& word) {
    try {
        parse(word);
        return true;
    } catch (const Error&) {
        return false;
    }
}

bool isConstraint(const std::string& word) {
    if constexpr (isBuilt(Wing::studies)) return parses(tradeoff::parseConstraint, word);
    return false;
}

/// A word that options with lists know and that is no BRDF.
bool isListed(const std::string& word) {
    const auto isNamed = [&](const auto& row) { return row.name == word; };
    return word == "all" || word == "none" || std::ranges::any_of(bases::catalog(), isNamed) ||
           std::ranges::any_of(metricCatalog(), isNamed) ||
           std::ranges::any_of(gpu::targets(), isNamed) ||
           std::ranges::any_of(brdfs::repairs(), isNamed) || parses(parseKind, word) ||
           parses(parsePrecision, word) || parses(parseWindow, word) || isConstraint(word);
}

/// Whether `word` goes on with the list that ends with `before`.
bool goesOn(const std::string& before, const std::string& word) {
    if (word.empty() || (word[0] == '-' && !isNumber(word)) || !brdfs::pathIn(word).empty())
        return false;
    if (before.ends_with(',') || word[0] == ',') return true;
    const std::string first = word.substr(0, word.find(','));
    const std::string last = before.substr(before.rfind(',') + 1);
    return isNumber(first) ? isNumber(last) : isListed(first) && isListed(last);
}

}  // namespace

void refuseSpacedLists(const CLI::App& app, const std::vector<std::string>& words) {
    const auto chosen = app.get_subcommands([&](const CLI::App* subcommand) {
        return !words.empty() && subcommand->get_name() == words[0];
    });
    if (chosen.empty()) return;
    for (std::size_t k = 1; k < words.size(); ++k) {
        const std::size_t equals = words[k].find('=');
        const std::string name = words[k].substr(0, equals);
        if (!name.starts_with("--") || !takesCommas(*chosen.front(), name)) continue;
        std::size_t at = equals == std::string::npos ? k + 1 : k;
        if (at >= words.size()) return;
        std::string list = at == k ? words[k].substr(equals + 1) : words[at], given = list;
        while (++at < words.size() && goesOn(list, words[at])) {
            given += " " + words[at];
            const bool comma = list.ends_with(',') || words[at][0] == ',';
            list += (comma ? "" : ",") + words[at];
        }
        if (given != list)
            throw UsageError(fmt::format("{} {}: commas separate the values, without spaces: {} {}",
                                         name, given, name, list));
    }
}

}  // namespace hshfit::cli
