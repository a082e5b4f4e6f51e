#include <brdfs/measured/scattered/cornell.h>
#include <brdfs/measured/scattered/scattered.h>
#include <brdfs/measured/scattered/text_file.h>
#include <brdfs/measured/text_reader.h>

#include <fmt/format.h>

#include <cmath>
#include <vector>

namespace hshfit::brdfs {
namespace {

bool isComment(const TextReader& reader) {
    return reader.blank() || reader.line().substr(reader.line().find_first_not_of(" \t"))[0] == '#';
}

bool nextRow(TextReader& reader) {
    while (reader.next()) {
        if (!isComment(reader)) return true;
    }
    return false;
}

std::size_t readCount(TextReader& reader, std::size_t bytes) {
    if (!nextRow(reader)) throw reader.error("the file ends before the number of wavelengths");
    std::vector<double> numbers;
    reader.takeNumbers(numbers);
    const double count = numbers[0];
    // Each wavelength takes at least two characters.
    if (numbers.size() != 1 || !(count >= 1) || count != std::floor(count) ||
        count > static_cast<double>(bytes) / 2) {
        throw reader.error(
            fmt::format("'{}' is no number of wavelengths that a file of {} bytes "
                        "can hold",
                        reader.line().substr(0, 40), bytes));
    }
    return static_cast<std::size_t>(count);
}

std::vector<double> readWavelengths(TextReader& reader, std::size_t count) {
    std::vector<double> wavelengths, numbers;
    while (wavelengths.size() < count) {
        if (!nextRow(reader)) {
            throw reader.error(
                fmt::format("the file ends after {} of {} wavelengths", wavelengths.size(), count));
        }
        reader.takeNumbers(numbers);
        for (const double nm : numbers) {
            if (!(nm > (wavelengths.empty() ? 0 : wavelengths.back())) || !std::isfinite(nm)) {
                throw reader.error(
                    fmt::format("wavelength {} is {} nm, expected ascending positive numbers",
                                wavelengths.size(), nm));
            }
            wavelengths.push_back(nm);
        }
    }
    if (wavelengths.size() != count) {
        throw reader.error(
            fmt::format("{} wavelengths, but {} were announced", wavelengths.size(), count));
    }
    return wavelengths;
}

// A file is recognised by two or three lines of numbers: a single count, then wavelengths.
bool looksLikeCornell(std::span<const unsigned char> head, std::uint64_t) {
    const std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
    if (!text.starts_with("#") || text.starts_with("#ALTA") ||
        text.find("#DIM") != std::string_view::npos || text.find('\0') != std::string_view::npos) {
        return false;
    }
    TextReader reader(text, "");
    try {
        const std::size_t count = readCount(reader, text.size());
        std::vector<double> numbers;
        if (!nextRow(reader)) return false;
        reader.takeNumbers(numbers);
        return numbers.size() <= count && numbers[0] >= 100 && numbers[0] <= 1e5;
    } catch (const InputError&) {
        return false;
    }
}

}  // namespace

Samples readCornell(std::string_view text, const std::string& where) {
    TextReader reader(text, where);
    const std::size_t count = readCount(reader, text.size());
    Samples samples;
    samples.channels = Channels::spectral(readWavelengths(reader, count));
    samples.facts = {{"format", "cornell"}};
    std::vector<double> row;
    while (nextRow(reader)) {
        reader.takeNumbers(row);
        if (row.size() != count + 4) {
            throw reader.error(
                fmt::format("{} numbers, expected theta_i, phi_i, theta_s, phi_s "
                            "and {} values",
                            row.size(), count));
        }
        const Row at{where, "line", reader.lineNumber()};
        samples.add(directionFromAngles(checkedPolarAngle(row[0], at, "theta_i"),
                                        checkedAzimuth(row[1], at, "phi_i")),
                    directionFromAngles(checkedPolarAngle(row[2], at, "theta_s"),
                                        checkedAzimuth(row[3], at, "phi_s")),
                    std::span(row).subspan(4), at);
    }
    return samples;
}

const Format& cornellFormat() {
    static const Format format{
        .name = "cornell",
        .help = "Goniometer samples of Cornell's Program of Computer Graphics, spectral",
        .extension = ".brdf",
        .recognises = looksLikeCornell,
        .parameters = scatteredParameters(),
        .open =
            [](const std::string& path, const Parameters& parameters) {
                return openScattered(path, parameters, readCornell);
            },
    };
    return format;
}

}  // namespace hshfit::brdfs
