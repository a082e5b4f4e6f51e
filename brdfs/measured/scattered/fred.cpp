#include <brdfs/measured/scattered/fred.h>
#include <brdfs/measured/scattered/scattered.h>
#include <brdfs/measured/scattered/text_file.h>
#include <brdfs/measured/text_reader.h>
#include <hshfit/files/printable.h>

#include <fmt/format.h>

#include <cmath>
#include <optional>

namespace hshfit::brdfs {
namespace {

bool nextFredLine(TextReader& reader) {
    while (reader.next()) {
        const std::string_view line = withoutBlanks(reader.line());
        if (!line.empty() && line[0] != '#' && line[0] != '!' && !line.starts_with("//"))
            return true;
    }
    return false;
}

/// "format angles=deg bsdf=value scale=1": one unit of the angles in radians.
double readFredFormat(TextReader& reader) {
    double unit = 0;
    for (std::string_view word = reader.takeWord(); !word.empty(); word = reader.takeWord()) {
        const std::string text = lowerCase(word);
        if (text == "format" || text == "bsdf=value" || text == "scale=1") continue;
        if (text != "angles=deg" && text != "angles=rad")
            throw reader.error(
                fmt::format("'{}' is not read; expected angles=deg or angles=rad, bsdf=value and "
                            "scale=1 (the option scale is a factor)",
                            shortened(printable(word), 40)));
        unit = text == "angles=deg" ? pi / 180 : 1;
    }
    if (unit == 0) throw reader.error("the line has no angles=deg or angles=rad");
    return unit;
}

double fredPolar(double angle, double most, const Row& at, std::string_view field, double unit) {
    if (angle >= 0 && angle * unit <= most + 1e-3) return angle * unit;
    throw at.error(fmt::format("{} is {}, expected 0 to {:.5g} {}", field, angle, most / unit,
                               unit == 1 ? "radians" : "degrees"));
}

bool looksLikeFred(std::span<const unsigned char> head, std::uint64_t) {
    TextReader reader(asText(head), "");
    if (!nextFredLine(reader)) return false;
    return lowerCase(reader.takeWord()) == "type" &&
           lowerCase(reader.takeWord()).find("bsdf") != std::string::npos;
}

}  // namespace

Samples readFred(std::string_view text, const std::string& where) {
    TextReader reader(text, where);
    if (!nextFredLine(reader) || lowerCase(reader.takeWord()) != "type" ||
        lowerCase(reader.takeWord()) != "bsdf_data")
        throw reader.error("expected 'type bsdf_data'");
    if (!nextFredLine(reader)) throw reader.error("the file ends before the line 'format'");
    const double unit = readFredFormat(reader);
    Samples samples;
    samples.facts = {{"format", "fred"}};
    std::optional<Direction> wi;
    std::vector<double> row;
    std::size_t transmitted = 0;
    while (nextFredLine(reader)) {
        reader.takeNumbers(row);
        const Row at{where, "line", reader.lineNumber()};
        if (row.size() == 2) {
            const double theta = fredPolar(row[0], pi / 2, at, "theta_i", unit);
            wi = mirrored(directionFromAngles(theta, checkedAzimuth(row[1] * unit, at, "phi_i")));
            continue;
        }
        if (row.size() != 3 || !wi)
            throw reader.error(fmt::format("{} numbers, expected theta_i and phi_i{}", row.size(),
                                           wi ? ", or theta_s, phi_s and f" : ""));
        const double theta = fredPolar(row[0], pi, at, "theta_s", unit);
        const double phi = checkedAzimuth(row[1] * unit, at, "phi_s");
        if (theta > pi / 2 + 1e-3) {
            ++transmitted;
            continue;
        }
        samples.add(*wi, directionFromAngles(theta, phi), {&row[2], 1}, at);
    }
    if (transmitted > 0)
        samples.leftOut.push_back(fmt::format("{} samples of transmission", transmitted));
    return samples;
}

const Format& fredFormat() {
    static const Format format{
        .name = "fred",
        .help = "Tabulated scatter data of FRED, grey; reflection",
        .extension = ".txt",
        .recognises = looksLikeFred,
        .parameters = scatteredParameters(),
        .open = [](const std::string& path,
                   const Parameters& parameters) { return openTables(path, parameters, readFred); },
    };
    return format;
}

}  // namespace hshfit::brdfs
