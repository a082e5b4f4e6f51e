#include <brdfs/fit/sample_source.h>

#include <brdfs/measured/scattered/text_file.h>
#include <brdfs/measured/text_reader.h>
#include <hshfit/error.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>

namespace hshfit::brdfs {
namespace {

/// A companion file: columns by name.
struct Companion {
    std::vector<std::string> names;
    std::vector<std::vector<double>> rows;
    std::vector<std::size_t> lines;

    std::optional<std::size_t> find(std::string_view name) const {
        const auto found = std::ranges::find(names, name);
        if (found == names.end()) return std::nullopt;
        return static_cast<std::size_t>(found - names.begin());
    }
};

std::vector<std::string> namesIn(std::string_view line) {
    std::vector<std::string> names;
    while (true) {
        const std::size_t comma = std::min(line.find(','), line.size());
        std::string_view name = line.substr(0, comma);
        while (!name.empty() && name.front() == ' ') name.remove_prefix(1);
        while (!name.empty() && name.back() == ' ') name.remove_suffix(1);
        names.emplace_back(name);
        if (comma == line.size()) return names;
        line.remove_prefix(comma + 1);
    }
}

Companion readCompanion(const std::string& path) {
    Companion result;
    withTextFile(path, [&](std::string_view text, const std::string& where) {
        TextReader reader(text, where);
        if (!reader.next()) throw reader.error("expected a line with the names of the columns");
        result.names = namesIn(reader.line());
        while (reader.next()) {
            if (reader.blank()) continue;
            std::vector<double> row;
            reader.takeNumbers(row, ',');
            if (row.size() != result.names.size())
                throw reader.error(fmt::format("{} numbers, but the first line names {} columns",
                                               row.size(), result.names.size()));
            result.rows.push_back(std::move(row));
            result.lines.push_back(reader.lineNumber());
        }
    });
    return result;
}

/// The companion file of measured samples, with a row for each of them.
Companion companionOf(const std::string& path, const SampleSource& source) {
    if (!source.samples)
        throw UsageError(
            fmt::format("{}: is not a file of single samples; {} cannot have a row for each",
                        source.name, path));
    Companion companion = readCompanion(path);
    if (companion.rows.size() != source.samples->read)
        throw InputError(fmt::format("{}: {} rows, but {} has {} samples; expected a row for each",
                                     path, companion.rows.size(), source.name,
                                     source.samples->read));
    return companion;
}

/// The column of each channel.
std::vector<std::size_t> sigmaColumns(const Companion& companion, const std::string& path,
                                      const Channels& channels) {
    if (const auto one = companion.find("sigma"))
        return std::vector<std::size_t>(channels.count(), *one);
    std::vector<std::size_t> columns;
    for (const std::string& name : channels.names()) {
        const auto column = companion.find(name);
        if (!column)
            throw InputError(fmt::format(
                "{}: line 1: no column '{}'; expected sigma, or a column for each of {}", path,
                name, fmt::join(channels.names(), ", ")));
        columns.push_back(*column);
    }
    return columns;
}

void refuseConverted(const SampleSource& source) {
    if (source.converted && source.samples->channels.count() > 1)
        throw UsageError(
            fmt::format("{}: its uncertainties are those of the channels of the file, and the "
                        "errors of converted values are correlated; fit the channels of the file",
                        source.name));
}

void sigmasOfFile(const SigmaStatement& sigma, const SampleSource& source, FitSamples& samples) {
    refuseConverted(source);
    const Companion companion = companionOf(sigma.path, source);
    const std::vector<std::size_t> columns = sigmaColumns(companion, sigma.path, samples.channels);
    for (const std::size_t column : columns)
        for (const std::size_t place : source.places) {
            const std::size_t row = source.samples->order[place];
            const double value = companion.rows[row][column];
            if (!(value > 0) || !std::isfinite(value))
                throw InputError(fmt::format("{}: line {}: {} is {}, expected a number above 0",
                                             sigma.path, companion.lines[row],
                                             companion.names[column], value));
            samples.sigmas.push_back(value);
        }
}

void sigmasOfColumn(const SampleSource& source, FitSamples& samples) {
    if (!source.samples || source.samples->sigmas.empty())
        throw UsageError(
            fmt::format("{}: states no uncertainties; ASTM files and tables with named columns do "
                        "in a column sigma, or sigma_NAME for each "
                        "channel",
                        source.name));
    refuseConverted(source);
    const std::size_t channels = samples.channels.count();
    for (std::size_t c = 0; c < channels; ++c)
        for (const std::size_t place : source.places)
            samples.sigmas.push_back(source.samples->sigmas[place * channels + c]);
}

void sigmasOfFormula(const SigmaStatement& sigma, const SampleSource& source, FitSamples& samples) {
    for (std::size_t i = 0; i < samples.values.size(); ++i) {
        const double value = std::hypot(sigma.relative * samples.values[i], sigma.absolute);
        if (!(value > 0))
            throw InputError(fmt::format(
                "{}: {} {}: the value 0 has no relative uncertainty; add an absolute part, such as "
                "2%+0.001",
                source.name, samples.rows.empty() ? "sample" : "line",
                samples.rows.empty() ? i % samples.size() + 1 : samples.rows[i]));
        samples.sigmas.push_back(value);
    }
}

/// Weights are 1 / sigma^2, and their products have to be numbers.
void checkSizes(const SampleSource& source, const FitSamples& samples) {
    constexpr double least = 1e-30, most = 1e30;
    for (std::size_t i = 0; i < samples.sigmas.size(); ++i)
        if (!(samples.sigmas[i] >= least && samples.sigmas[i] <= most))
            throw InputError(
                fmt::format("{}: {} {}: its uncertainty is {}, expected {} to {} 1/sr", source.name,
                            samples.rows.empty() ? "sample" : "line",
                            samples.rows.empty() ? i % samples.size() + 1 : samples.rows[i],
                            samples.sigmas[i], least, most));
}

/// Numbers of equal keys, in the order of their first sample.
template <class Key>
std::vector<std::size_t> numbered(const std::vector<Key>& keys) {
    std::map<Key, std::size_t> known;
    std::vector<std::size_t> numbers;
    for (const Key& key : keys)
        numbers.push_back(known.try_emplace(key, known.size()).first->second);
    return numbers;
}

std::vector<double> scanColumn(const SigmaStatement& sigma, const SampleSource& source) {
    std::vector<double> result;
    if (sigma.from == SigmaStatement::From::file) {
        const Companion companion = companionOf(sigma.path, source);
        if (const auto column = companion.find("scan")) {
            for (const std::size_t place : source.places)
                result.push_back(companion.rows[source.samples->order[place]][*column]);
            return result;
        }
    }
    if (!source.samples || source.samples->scans.empty())
        throw UsageError(
            fmt::format("{}: has no column scan; ASTM files, tables with named columns and "
                        "companion files of uncertainties may have one",
                        source.name));
    for (const std::size_t place : source.places) result.push_back(source.samples->scans[place]);
    return result;
}

}  // namespace

void numberRows(const SampleSource& source, FitSamples& samples) {
    if (!source.samples || source.samples->rows.empty()) return;
    const std::size_t own = source.samples->channels.count();
    for (std::size_t c = 0; c < samples.channels.count(); ++c)
        for (const std::size_t place : source.places)
            samples.rows.push_back(source.samples->rows[place * own + (source.converted ? 0 : c)]);
}

void stateScans(const ScanStatement& scans, const SigmaStatement& sigma, const SampleSource& source,
                FitSamples& samples) {
    using From = ScanStatement::From;
    if (scans.from == From::nothing) return;
    if (scans.from == From::column) {
        samples.scans = numbered(scanColumn(sigma, source));
        return;
    }
    if (scans.from == From::incidence) {
        // To the resolution of instruments: 1e-4 in the components of a unit vector.
        std::vector<std::tuple<long, long>> keys;
        constexpr double steps = 1e4;
        for (std::size_t k = 0; k < samples.size(); ++k)
            keys.emplace_back(std::lround(samples.wiX[k] * steps),
                              std::lround(samples.wiY[k] * steps));
        samples.scans = numbered(keys);
        return;
    }
    if (!source.samples)
        throw UsageError(fmt::format(
            "{}: is not a file of single samples, which come after one another", source.name));
    std::vector<std::size_t> keys;
    for (const std::size_t place : source.places)
        keys.push_back(source.samples->order[place] / scans.length);
    samples.scans = numbered(keys);
}

void stateSigmas(const SigmaStatement& sigma, const SampleSource& source, FitSamples& samples) {
    using From = SigmaStatement::From;
    if (sigma.from == From::nothing) return;
    if (samples.solidAngles) std::ranges::fill(samples.weights, 1.0);
    samples.solidAngles = false;
    if (sigma.from == From::file)
        sigmasOfFile(sigma, source, samples);
    else if (sigma.from == From::column)
        sigmasOfColumn(source, samples);
    else
        sigmasOfFormula(sigma, source, samples);
    samples.correlation = sigma.correlation;
    checkSizes(source, samples);
}

}  // namespace hshfit::brdfs
