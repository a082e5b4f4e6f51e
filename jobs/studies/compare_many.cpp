#include "compare.h"

#include <jobs/common/kept_outputs.h>

#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <string_view>
#include <utility>

namespace hshfit::jobs {
namespace {

struct Pair {
    std::string name, a, b;
};

/// Inputs by the names of their results. Throws UsageError where two have one name.
std::map<std::string, std::string> byName(const std::vector<std::string>& specs) {
    std::map<std::string, std::string> named;
    for (const std::string& spec : specs) {
        const auto [other, isNew] = named.try_emplace(nameOf(spec), spec);
        if (!isNew)
            throw UsageError(fmt::format("compare: '{}' and '{}' have one name, {}", other->second,
                                         spec, other->first));
    }
    return named;
}

/// Files of two folders by their names; those that stand alone are failures.
std::vector<Pair> pairsByName(const std::string& a, const std::string& b,
                              std::vector<InputFailure>& failures) {
    const auto references = byName(expandInputs({a}, Members::both));
    const auto others = byName(expandInputs({b}, Members::both));
    std::vector<Pair> pairs;
    const auto fail = [&](const std::string& spec, const std::string& where) {
        failures.push_back(
            {spec, fmt::format("{}: no file of this name in {}", spec, where), ExitCode::input});
    };
    for (const auto& [name, spec] : references) {
        const auto other = others.find(name);
        if (other == others.end())
            fail(spec, b);
        else
            pairs.push_back({name, spec, other->second});
    }
    for (const auto& [name, spec] : others)
        if (!references.contains(name)) fail(spec, a);
    if (pairs.empty())
        throw InputError(fmt::format("no file of {} has the name of one of {}", a, b));
    return pairs;
}

std::vector<Pair> pairsOf(const std::string& a, const std::vector<std::string>& others,
                          std::vector<InputFailure>& failures) {
    if (areMany({a})) {
        if (others.size() != 1 || !areMany(others))
            throw UsageError(
                "compare: several references are compared with files of the same names: give one "
                "folder or pattern for B, or one reference");
        return pairsByName(a, others[0], failures);
    }
    std::vector<Pair> pairs;
    for (const auto& [name, spec] : byName(expandInputs(others, Members::both)))
        pairs.push_back({name, a, spec});
    return pairs;
}

/// A cell of a CSV table (RFC 4180).
std::string cell(const std::string& text) {
    if (text.find_first_of(",\"\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + "\"";
}

}  // namespace

ManyCompared compareMany(const std::string& a, const std::vector<std::string>& others,
                         const std::string& output, const CompareOptions& options,
                         const Listener& listener) {
    selectMetrics(options.metrics);  // a word that is none fails before any file is opened
    ManyCompared many;
    std::vector<InputFailure> alone;
    const std::vector<Pair> pairs = pairsOf(a, others, alone);
    std::vector<std::string> specs;
    std::vector<bool> isKept(pairs.size());
    if (!output.empty()) requireFolder(output);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        specs.push_back(pairs[i].b);
        many.names.push_back(pairs[i].name);
        if (output.empty()) continue;
        many.folders.push_back((std::filesystem::path(output) / pairs[i].name).string());
        isKept[i] =
            findOutputs({many.folders[i]}, keyOf({pairs[i].a, pairs[i].b})).found == Found::valid;
        if (isKept[i]) many.kept.push_back(many.folders[i]);
    }
    if (!output.empty()) std::filesystem::create_directories(output);
    many.results.resize(pairs.size());
    many.failures =
        forEachInput(specs, listener, "compare", [&](std::size_t i, const ProgressCall& progress) {
            progress(0, 1);
            const OutputKey key(keyOf({pairs[i].a, pairs[i].b}));
            const Listener each{.note = listener.note};
            const bool page = !output.empty() && !isKept[i];
            many.results[i] = compare(pairs[i].a, pairs[i].b,
                                      page ? many.folders[i] : std::string(), options, each);
            progress(1, 1);
        });
    std::ranges::move(alone, std::back_inserter(many.failures));
    return many;
}

namespace {

constexpr std::string_view columns = "name,a,b,outgoing";
constexpr std::string_view pictureColumns = ",FLIP,false dip,false peak";

std::string tableOf(const ManyCompared& many) {
    std::string table;
    for (std::size_t i = 0; i < many.results.size(); ++i) {
        const auto& compared = many.results[i];
        if (!compared) continue;
        if (table.empty()) {
            table = columns;
            for (const MetricValue& metric : compared->metrics)
                table += fmt::format(",{0},{0} error", metric.metric->name);
            table += pictureColumns;
            table += "\n";
        }
        table += fmt::format("{},{},{},{}", cell(many.names[i]), cell(compared->a),
                             cell(compared->b), cell(compared->outgoing.spec()));
        for (const MetricValue& metric : compared->metrics)
            table += metric.value ? fmt::format(",{},{}", *metric.value, metric.error) : ",,";
        const auto& picture = compared->picture;
        table += picture ? fmt::format(",{},{},{}", picture->flip.mean, picture->dip.value,
                                       picture->peak.value)
                         : ",,,";
        table += "\n";
    }
    return table;
}

bool isTable(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    file.exceptions(std::ios::badbit);
    std::string line;
    return std::getline(file, line) && line.starts_with(columns);
}

}  // namespace

void writeComparisonTable(const ManyCompared& many, const std::string& path) {
    AtomicFile file(path,
                    isTable(path) ? AtomicFile::Existing::always : AtomicFile::Existing::replace);
    file.write(tableOf(many));
    file.commit();
}

}  // namespace hshfit::jobs
