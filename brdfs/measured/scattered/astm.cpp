#include <brdfs/measured/scattered/astm.h>
#include <brdfs/measured/scattered/scattered.h>
#include <brdfs/measured/scattered/sides.h>
#include <brdfs/measured/scattered/text_file.h>
#include <brdfs/measured/text_reader.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace hshfit::brdfs {
namespace {

constexpr std::array<std::string_view, 4> angleNames = {"theta_i", "phi_i", "theta_s", "phi_s"};

struct Columns {
    std::array<std::optional<std::size_t>, 4> angle;
    std::vector<std::size_t> values;
    std::vector<std::size_t> sigmas;  ///< of each value, or one for all
    std::optional<std::size_t> scan;
    std::size_t count = 0;
};

std::vector<std::string> splitNames(std::string_view list) {
    std::vector<std::string> names;
    while (true) {
        const std::size_t comma = list.find(',');
        names.emplace_back(withoutBlanks(list.substr(0, comma)));
        if (comma == std::string_view::npos) return names;
        list.remove_prefix(comma + 1);
    }
}

/// "400nm" or "400 nm".
std::optional<double> wavelengthOf(std::string_view name) {
    double nm = 0;
    if (!takeNumber(name, nm) || lowerCase(withoutBlanks(name)) != "nm") return std::nullopt;
    return nm;
}

Channels channelsOf(const std::vector<std::string>& names, const TextReader& reader) {
    std::vector<double> wavelengths;
    for (const std::string& name : names) {
        if (const auto nm = wavelengthOf(name)) wavelengths.push_back(*nm);
    }
    if (names.size() == 1 && wavelengths.empty()) return Channels::grey();
    if (wavelengths.size() == names.size()) {
        const bool ascending =
            std::ranges::is_sorted(wavelengths, std::less_equal<>()) && wavelengths[0] > 0;
        if (!ascending || !std::isfinite(wavelengths.back())) {
            throw reader.error("the wavelengths of VARS have to be positive and ascending");
        }
        return Channels::spectral(wavelengths);
    }
    if (names.size() == 3) {
        const std::string initials = {names[0][0], names[1][0], names[2][0]};
        if (lowerCase(initials) == "rgb") return Channels::rgb();
    }
    throw reader.error(
        fmt::format("the channels '{}' of VARS are neither one, nor R,G,B, nor wavelengths in nm",
                    fmt::format("{}", fmt::join(names, ",")).substr(0, 80)));
}

/// Moves the names sigma, sigma_CHANNEL and scan from the values to what is stated about them; a
/// single value may have any name.
void takeSigmas(const std::vector<std::string>& names, std::vector<std::string>& channelNames,
                Columns& columns, const TextReader& reader) {
    constexpr std::string_view prefix = "sigma_";
    std::vector<std::size_t> values;
    std::vector<std::pair<std::string, std::size_t>> stated;
    std::vector<std::string> kept;
    for (const std::size_t k : columns.values) {
        const std::string name = lowerCase(names[k]);
        if (columns.values.size() > 1 && name == "scan" && !columns.scan) {
            columns.scan = k;
        } else if (columns.values.size() > 1 && (name == "sigma" || name.starts_with(prefix))) {
            stated.emplace_back(name, k);
        } else {
            values.push_back(k);
            kept.push_back(names[k]);
        }
    }
    columns.values = values;
    channelNames = kept;
    if (stated.empty()) return;
    if (stated.size() == 1 && stated.front().first == "sigma") {
        columns.sigmas = {stated.front().second};
        return;
    }
    for (const std::string& name : kept) {
        const auto found = std::ranges::find(stated, std::string(prefix) + lowerCase(name),
                                             &std::pair<std::string, std::size_t>::first);
        if (found == stated.end() || stated.size() != kept.size())
            throw reader.error(
                fmt::format("the uncertainties of VARS have to be one column sigma, "
                            "or sigma_NAME for each value; there is none for {}",
                            name));
        columns.sigmas.push_back(found->second);
    }
}

Columns readColumns(std::string_view list, const TextReader& reader, Channels& channels) {
    const std::vector<std::string> names = splitNames(list);
    Columns columns;
    columns.count = names.size();
    std::vector<std::string> channelNames;
    for (std::size_t k = 0; k < names.size(); ++k) {
        if (names[k].empty()) throw reader.error(fmt::format("name {} of VARS is empty", k + 1));
        const auto found = std::ranges::find(angleNames, lowerCase(names[k]));
        if (found == angleNames.end()) {
            columns.values.push_back(k);
            channelNames.push_back(names[k]);
            continue;
        }
        auto& angle = columns.angle[static_cast<std::size_t>(found - angleNames.begin())];
        if (angle) throw reader.error(fmt::format("VARS names {} twice", *found));
        angle = k;
    }
    if (!columns.angle[0] || !columns.angle[2] || channelNames.empty()) {
        throw reader.error("VARS has to name theta_i, theta_s and at least one value");
    }
    takeSigmas(names, channelNames, columns, reader);
    if (channelNames.empty()) throw reader.error("VARS names no value beside sigma and scan");
    channels = channelsOf(channelNames, reader);
    return columns;
}

/// The uncertainties of one row, a value per channel, and its scan.
void addStatement(const Columns& columns, const std::vector<double>& row, const Row& at,
                  Samples& samples) {
    for (std::size_t c = 0; !columns.sigmas.empty() && c < columns.values.size(); ++c) {
        const double sigma = row[columns.sigmas[columns.sigmas.size() == 1 ? 0 : c]];
        if (!(sigma > 0) || !std::isfinite(sigma))
            throw at.error(fmt::format("sigma is {}, expected a number above 0", sigma));
        samples.sigmas.push_back(sigma);
    }
    if (!columns.scan) return;
    if (!std::isfinite(row[*columns.scan]))
        throw at.error(fmt::format("scan is {}, expected a number", row[*columns.scan]));
    samples.scans.push_back(row[*columns.scan]);
}

bool looksLikeAstm(std::span<const unsigned char> head, std::uint64_t) {
    std::string_view text = asText(head);
    TextReader reader(text, "");
    while (reader.next()) {
        if (reader.takeWord() != "VARS") continue;
        const std::string names = lowerCase(reader.line());
        return names.find("theta_i") != std::string::npos &&
               names.find("theta_s") != std::string::npos;
    }
    return false;
}

}  // namespace

Samples readAstm(std::string_view text, const std::string& where, bool inDegrees,
                 std::string_view side) {
    TextReader reader(text, where);
    std::vector<Fact> facts{{"format", "astm"}};
    Channels channels;
    std::optional<double> announced;
    std::optional<Columns> columns;
    while (!columns && reader.next()) {
        const std::string_view keyword = reader.takeWord();
        if (keyword.empty() || keyword[0] == '#') continue;
        const std::size_t at = static_cast<std::size_t>(keyword.data() - reader.line().data());
        std::string_view rest = withoutBlanks(reader.line().substr(at + keyword.size()));
        if (keyword == "VARS") {
            columns = readColumns(rest, reader, channels);
        } else if (keyword == "NUM_POINTS") {
            double count = 0;
            if (!takeNumber(rest, count) || !withoutBlanks(rest).empty() || !(count >= 0)) {
                throw reader.error("NUM_POINTS has to be a number from 0");
            }
            announced = count;
        } else if (keyword == "SAMPLE_NAME" || keyword == "LAB_NAME") {
            facts.emplace_back(lowerCase(keyword), std::string(rest.substr(0, 200)));
        }
    }
    if (!columns) throw reader.error("the file ends without a line VARS that names its columns");
    SidedSamples sided(channels);
    std::vector<double> row, values(columns->values.size());
    const double unit = inDegrees ? pi / 180 : 1;
    std::size_t rows = 0;
    while (reader.next()) {
        if (reader.blank()) continue;
        reader.takeNumbers(row, ',');
        if (row.size() != columns->count) {
            throw reader.error(
                fmt::format("{} numbers, but VARS names {}", row.size(), columns->count));
        }
        const Row at{where, "line", reader.lineNumber()};
        std::array<double, 4> angles{};
        for (std::size_t k = 0; k < 4; ++k) {
            if (!columns->angle[k]) continue;
            const double angle = row[*columns->angle[k]] * unit;
            angles[k] = k % 2 == 0 ? checkedSidedAngle(angle, at, angleNames[k])
                                   : checkedAzimuth(angle, at, angleNames[k]);
        }
        for (std::size_t c = 0; c < values.size(); ++c) values[c] = row[columns->values[c]];
        Samples* samples = sided.add(directionFromAngles(angles[0], angles[1]),
                                     directionFromAngles(angles[2], angles[3]), values, at);
        if (samples) addStatement(*columns, row, at, *samples);
        ++rows;
    }
    if (announced && *announced != static_cast<double>(rows)) {
        throw reader.error(fmt::format("{} rows, but NUM_POINTS announces {}", rows, *announced));
    }
    if (rows == 0) throw reader.error("the file has no row of numbers");
    Samples samples = sided.take(side, where);
    samples.facts = std::move(facts);
    return samples;
}

const Format& astmFormat() {
    static const Format format{
        .name = "astm",
        .help = "Scattered samples, ASTM E1392, grey, RGB or spectral",
        .extension = ".astm",
        .recognises = looksLikeAstm,
        .parameters = scatteredParameters({{.name = "angles",
                                            .help = "unit of the angles in the file",
                                            .kind = Parameter::Kind::choice,
                                            .choices = {"radians", "degrees"}},
                                           sideParameter("polar angles beyond 90 degrees are on "
                                                         "the back; auto: the first that the "
                                                         "file has, reflections first")}),
        .open =
            [](const std::string& path, const Parameters& parameters) {
                const bool inDegrees = parameters.choice("angles") == "degrees";
                const std::string side = parameters.choice("side");
                return openScattered(path, parameters,
                                     [=](std::string_view text, const std::string& where) {
                                         return readAstm(text, where, inDegrees, side);
                                     });
            },
    };
    return format;
}

}  // namespace hshfit::brdfs
