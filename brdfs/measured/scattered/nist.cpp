#include <brdfs/measured/scattered/nist.h>
#include <brdfs/measured/scattered/scattered.h>
#include <brdfs/measured/scattered/text_file.h>
#include <brdfs/measured/text_reader.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace hshfit::brdfs {
namespace {

constexpr std::string_view beginning = "lambda,thetai,phi";

/// The character between the cells, by the first two names: a comma, a semicolon or a tab; 0 for
/// other text.
char nistSeparator(std::string_view text) {
    for (const char separator : {',', ';', '\t'}) {
        std::string names(beginning);
        std::ranges::replace(names, ',', separator);
        if (text.starts_with(names)) return separator;
    }
    return 0;
}
constexpr std::size_t columnCount = 21;

/// Polar and azimuth angles of both directions in degrees, rounded to the resolution of
/// instruments.
using Geometry = std::array<double, 4>;

struct Reading {
    Geometry at;
    std::size_t line = 0;
    struct Value {
        std::vector<double> f;  ///< one for each of the quantities
        std::size_t line = 0;
    };
    std::map<double, Value> values;  ///< by wavelength in nm
};

bool looksLikeNist(std::span<const unsigned char> head, std::uint64_t) {
    return nistSeparator(asText(head)) != 0;
}

/// The elements of a row, whose matrix begins at its sixth number and has f_r11 in place of m_11.
std::vector<double> valuesOf(const std::vector<double>& row, const MuellerElements& elements) {
    if (elements.isReflectance()) return {row[5]};  // also below 0, to be counted
    MuellerElements::Matrix matrix{row[5]};
    for (std::size_t place = 1; place < matrix.size(); ++place)
        matrix[place] = row[5] * row[5 + place];
    std::vector<double> values;
    for (std::size_t k = 0; k < elements.size(); ++k) values.push_back(elements.value(k, matrix));
    return values;
}

/// Checks the angles and appends the row to the readings of its geometry.
void addRow(const std::vector<double>& row, const MuellerElements& elements,
            const TextReader& reader, std::map<Geometry, std::size_t>& known,
            std::vector<Reading>& readings) {
    constexpr std::array<std::string_view, 5> names = {"lambda", "thetai", "phii", "thetar",
                                                       "phir"};
    constexpr std::array<double, 5> most = {1000, 90, 720, 90, 720};
    for (std::size_t k = 0; k < names.size(); ++k) {
        if (std::fabs(row[k]) <= most[k]) continue;
        throw reader.error(fmt::format("{} is {}, expected at most {} {}", names[k], row[k],
                                       most[k], k == 0 ? "um" : "degrees"));
    }
    // In nm to a thousandth: 0.351 um is 351 nm.
    const double nm = std::round(row[0] * 1e6) / 1e3;
    if (!(nm > 0)) throw reader.error(fmt::format("lambda is {} um, expected above 0", row[0]));
    Geometry at;
    for (std::size_t k = 0; k < 4; ++k) at[k] = std::round(row[k + 1] * 1e4) / 1e4;
    const auto [place, isNew] = known.try_emplace(at, readings.size());
    if (isNew) readings.push_back({at, reader.lineNumber(), {}});
    if (!readings[place->second]
             .values.try_emplace(nm, Reading::Value{valuesOf(row, elements), reader.lineNumber()})
             .second) {
        throw reader.error(fmt::format("a second row for these angles at {} nm", nm));
    }
}

}  // namespace

Samples readNist(std::string_view text, const std::string& where, const MuellerElements& elements) {
    TextReader reader(text, where);
    const char separator = reader.next() ? nistSeparator(reader.line()) : 0;
    if (separator == 0) {
        throw reader.error(fmt::format("expected the names of the columns, '{},...'", beginning));
    }
    std::map<Geometry, std::size_t> known;
    std::vector<Reading> readings;
    std::map<double, std::size_t> wavelengths;
    std::vector<double> row;
    while (reader.next()) {
        if (reader.blank()) continue;
        reader.takeNumbers(row, separator);
        if (row.size() != columnCount) {
            throw reader.error(fmt::format("{} numbers, expected {}", row.size(), columnCount));
        }
        addRow(row, elements, reader, known, readings);
        ++wavelengths[std::round(row[0] * 1e6) / 1e3];
    }
    Samples samples;
    std::vector<double> nanometres;
    for (const auto& [nm, count] : wavelengths) nanometres.push_back(nm);
    if (nanometres.empty()) throw reader.error("the file has no rows");
    samples.channels = elements.channels(Channels::spectral(nanometres));
    samples.elements = elements;
    samples.facts = {{"format", "nist"}, muellerFact(elements)};
    std::size_t incomplete = 0;
    std::vector<double> values;
    for (const Reading& reading : readings) {
        if (reading.values.size() != nanometres.size()) {
            ++incomplete;
            continue;
        }
        values.clear();
        for (std::size_t k = 0; k < elements.size(); ++k)
            for (const auto& [nm, value] : reading.values) values.push_back(value.f[k]);
        const std::size_t before = samples.size();
        const Geometry& at = reading.at;
        samples.add(directionFromAngles(radians(at[0]), radians(at[1])),
                    directionFromAngles(radians(at[2]), radians(at[3])), values,
                    {where, "line", reading.line});
        auto line = samples.rows.begin() + static_cast<std::ptrdiff_t>(before * values.size());
        for (std::size_t k = 0; k < elements.size(); ++k)
            for (const auto& [nm, value] : reading.values)
                if (line != samples.rows.end()) *line++ = value.line;
    }
    if (incomplete > 0) {
        samples.leftOut.push_back(
            fmt::format("{} pairs of directions not measured at every wavelength", incomplete));
    }
    return samples;
}

const Format& nistFormat() {
    static const Format format{
        .name = "nist",
        .help = "Mueller-matrix samples of NIST (CSV), spectral",
        .extension = ".csv",
        .recognises = looksLikeNist,
        .parameters = scatteredParameters({muellerParameter()}),
        .open =
            [](const std::string& path, const Parameters& parameters) {
                return openScattered(path, parameters,
                                     [&](std::string_view text, const std::string& where) {
                                         return readNist(text, where, muellerElements(parameters));
                                     });
            },
    };
    return format;
}

}  // namespace hshfit::brdfs
