#include <brdfs/composed/sum.h>
#include <brdfs/measured/scattered/alta.h>
#include <brdfs/measured/scattered/alta_coordinates.h>
#include <brdfs/measured/scattered/alta_parameters.h>
#include <brdfs/measured/scattered/scattered.h>
#include <brdfs/measured/scattered/text_file.h>
#include <brdfs/measured/text_reader.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

namespace hshfit::brdfs {
namespace {

constexpr std::string_view functionMark = "#ALTA FUNC HEADER";
constexpr std::size_t mostColumns = 64;

struct AltaHeader {
    std::size_t in = 0, out = 0, bounds = 0;
    std::string parameters = "UNKNOWN_INPUT", output;
    bool binary = false, bigEndian = false;
    bool marked = true;        ///< the stream stands between #BEGIN_STREAM and #END_STREAM
    std::size_t count = 0;     ///< of samples, binary
    std::size_t streamAt = 0;  ///< offset of the first byte of the stream
    std::string sample;

    std::size_t columns() const { return in + out + bounds; }
};

std::size_t wholeNumber(double value, double most, const TextReader& reader,
                        std::string_view what) {
    if (!(value >= 0 && value <= most) || value != std::floor(value)) {
        throw reader.error(
            fmt::format("{} is {}, expected a whole number up to {}", what, value, most));
    }
    return static_cast<std::size_t>(value);
}

void readSegments(TextReader& reader, AltaHeader& header) {
    std::vector<double> kinds;
    for (double kind; reader.takeNumber(kind);) kinds.push_back(kind);
    if (kinds.size() != 1 && kinds.size() != header.out) {
        throw reader.error(
            fmt::format("#VS has {} numbers, expected one, or one for each of the "
                        "{} values",
                        kinds.size(), header.out));
    }
    header.bounds = 0;
    for (std::size_t c = 0; c < header.out; ++c) {
        header.bounds += wholeNumber(kinds[kinds.size() == 1 ? 0 : c], 2, reader, "#VS");
    }
}

std::string expectWord(TextReader& reader, std::string_view key,
                       std::initializer_list<std::string_view> valid) {
    const std::string_view word = reader.takeWord();
    if (std::ranges::find(valid, word) == valid.end()) {
        throw reader.error(fmt::format("{} is '{}', expected {}", key, word.substr(0, 40),
                                       fmt::join(valid, " or ")));
    }
    return std::string(word);
}

/// Takes one line of the header; true at #BEGIN_STREAM.
bool readKey(TextReader& reader, AltaHeader& header) {
    const std::string_view key = reader.takeWord();
    double value = 0;
    if (key == "#DIM") {
        double out = 0;
        if (!reader.takeNumber(value) || !reader.takeNumber(out)) {
            throw reader.error("#DIM has to give the numbers of coordinates and of values");
        }
        header.in = wholeNumber(value, mostColumns, reader, "#DIM");
        header.out = wholeNumber(out, mostColumns, reader, "#DIM");
    } else if (key == "#PARAM_IN") {
        header.parameters = reader.takeWord();
    } else if (key == "#PARAM_OUT") {
        header.output = reader.takeWord();
    } else if (key == "#VS") {
        readSegments(reader, header);
    } else if (key == "#FORMAT") {
        header.binary = expectWord(reader, key, {"binary", "text"}) == "binary";
    } else if (key == "#VERSION") {
        if (!reader.takeNumber(value) || value != 0) {
            throw reader.error("#VERSION has to be 0");
        }
    } else if (key == "#PRECISION") {
        expectWord(reader, key, {"ieee754-double"});
    } else if (key == "#ENDIAN") {
        header.bigEndian = expectWord(reader, key, {"little", "big"}) == "big";
    } else if (key == "#SAMPLE_COUNT") {
        if (!reader.takeNumber(value)) throw reader.error("#SAMPLE_COUNT has no number");
        header.count = wholeNumber(value, 1e15, reader, "#SAMPLE_COUNT");
    } else if (key == "#SAMPLE") {
        header.sample = reader.line().substr(key.size()).substr(0, 200);
        header.sample.erase(0, header.sample.find_first_not_of(" \t"));
    }
    return key == "#BEGIN_STREAM";
}

Samples declare(const AltaHeader& header, const TextReader& reader,
                const AltaParameters*& parameters) {
    if (header.in == 0 || header.out == 0) {
        throw reader.error("no line #DIM with the numbers of coordinates and of values");
    }
    parameters = altaParameters(header.parameters);
    if (!parameters) {
        throw reader.error(fmt::format(
            "#PARAM_IN {} does not say which directions the rows are for; readable are {}",
            header.parameters.substr(0, 40), altaParameterNames()));
    }
    if (parameters->count != header.in) {
        throw reader.error(fmt::format("#DIM gives {} coordinates, but {} has {}", header.in,
                                       parameters->name, parameters->count));
    }
    constexpr std::array<std::string_view, 6> outputs = {
        "",          "INV_STERADIAN", "INV_STERADIAN_COSINE_FACTOR",
        "RGB_COLOR", "XYZ_COLOR",     "UNKNOWN_OUTPUT"};
    if (std::ranges::find(outputs, header.output) == outputs.end()) {
        throw reader.error(fmt::format("#PARAM_OUT {} is no BRDF; readable are {}",
                                       header.output.substr(0, 40),
                                       fmt::join(outputs.begin() + 1, outputs.end(), ", ")));
    }
    const bool colour = header.output == "RGB_COLOR" || header.output == "XYZ_COLOR";
    if (header.out != 3 && (header.out != 1 || colour)) {
        throw reader.error(fmt::format("#DIM gives {} values, expected {}", header.out,
                                       colour ? "3" : "1 (grey) or 3 (R, G, B)"));
    }
    Samples samples;
    samples.channels = header.out == 1 ? Channels::grey() : Channels::rgb();
    samples.isotropic = parameters->chart == Chart::isotropic;
    samples.chart = samples.isotropic ? Chart::anisotropic : parameters->chart;
    samples.facts = {{"format", "alta"}, {"parametrisation", header.parameters}};
    if (!header.sample.empty()) samples.facts.emplace_back("sample", header.sample);
    if (header.bounds > 0) samples.leftOut.push_back("vertical segments (#VS)");
    return samples;
}

/// Linear Rec. 709 of XYZ, D65 (IEC 61966-2-1).
void toRgb(double* v) {
    const double x = v[0], y = v[1], z = v[2];
    v[0] = 3.2406 * x - 1.5372 * y - 0.4986 * z;
    v[1] = -0.9689 * x + 1.8758 * y + 0.0415 * z;
    v[2] = 0.0557 * x - 0.2040 * y + 1.0570 * z;
}

void addRow(const AltaHeader& header, const AltaParameters& parameters, std::vector<double>& row,
            const Row& at, Samples& samples) {
    Direction wi, wo;
    for (std::size_t k = 0; k < header.in; ++k) {
        if (!std::isfinite(row[k])) {
            throw at.error(
                fmt::format("coordinate {} is {}, expected a finite number", k + 1, row[k]));
        }
    }
    altaDirections(parameters, row.data(), at, wi, wo);
    const std::span<double> f = std::span(row).subspan(header.in, header.out);
    if (header.output == "XYZ_COLOR") toRgb(f.data());
    if (header.output == "INV_STERADIAN_COSINE_FACTOR") {
        // On the horizon, where the cosine may round to either side of 0, f cos does not determine
        // f.
        if (!(wo.z > 1e-9)) return samples.leaveOut(f, at);
        for (double& value : f) value /= wo.z;
    }
    samples.add(wi, wo, f, at);
}

void readStream(std::string_view text, const std::string& where, const AltaHeader& header,
                const AltaParameters& parameters, const TextReader& reader, Samples& samples) {
    constexpr std::string_view end = "\n#END_STREAM";
    const std::size_t rowBytes = header.columns() * sizeof(double);
    const std::size_t present = text.size() - std::min(text.size(), header.streamAt);
    if (header.count > present / rowBytes) {
        throw reader.error(
            fmt::format("the stream (offset {}) has {} bytes, too few for {} samples of {} doubles",
                        header.streamAt, present, header.count, header.columns()));
    }
    if (header.marked && !text.substr(header.streamAt + header.count * rowBytes).starts_with(end)) {
        throw reader.error(fmt::format("no #END_STREAM after {} samples of {} doubles (offset {})",
                                       header.count, header.columns(),
                                       header.streamAt + header.count * rowBytes));
    }
    if (!header.marked && header.count == 0) {
        throw reader.error(
            "#FORMAT binary, but neither #SAMPLE_COUNT nor #BEGIN_STREAM before this");
    }
    if (!header.marked && present - header.count * rowBytes > 1) {
        throw reader.error(fmt::format(
            "{} bytes after {} samples of {} doubles (offset {}), expected the end of the file",
            present - header.count * rowBytes, header.count, header.columns(), header.streamAt));
    }
    std::vector<double> row(header.columns());
    const char* from = text.data() + header.streamAt;
    for (std::size_t k = 0; k < header.count; ++k, from += rowBytes) {
        for (std::size_t c = 0; c < row.size(); ++c) {
            std::uint64_t bits = 0;
            std::memcpy(&bits, from + c * sizeof bits, sizeof bits);
            if (header.bigEndian == (std::endian::native == std::endian::little)) {
                bits = __builtin_bswap64(bits);
            }
            row[c] = std::bit_cast<double>(bits);
        }
        addRow(header, parameters, row, {where, "sample", k}, samples);
    }
}

/// Whether the stream of a file without marks begins after the line that was read: ALTA takes the
/// first byte that is no '#' as data.
bool streamBegins(std::string_view text, const AltaHeader& header, const TextReader& reader) {
    if (!header.binary || text.find("\n#BEGIN_STREAM") != std::string_view::npos) return false;
    const auto next = static_cast<std::size_t>(reader.line().end() - text.begin()) + 1;
    const bool ended = reader.line().starts_with("#ALTA_END_HEADER");
    return ended || (next < text.size() && text[next] != '#');
}

bool looksLikeAlta(std::span<const unsigned char> head, std::uint64_t) {
    const std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
    if (text.starts_with(functionMark)) return true;
    for (std::string_view rest = text;
         rest.starts_with('#') || rest.starts_with('\n') || rest.starts_with('\r');) {
        const std::string_view line = firstLine(rest);
        if (line.starts_with("#DIM ") || line.starts_with("#DIM\t") ||
            line.starts_with("#PARAM_IN")) {
            return true;
        }
        rest.remove_prefix(std::min(rest.size(), line.size() + 1));
    }
    return false;
}

/// "file" and the names of parametrisations.
std::vector<std::string_view> inputChoices() {
    std::vector<std::string_view> choices{"file"};
    for (const AltaCoordinates& row : allAltaCoordinates()) choices.push_back(row.name);
    return choices;
}

}  // namespace

Samples readAlta(std::string_view text, const std::string& where) {
    TextReader reader(text, where);
    AltaHeader header;
    const AltaParameters* parameters = nullptr;
    Samples samples;
    std::vector<double> row;
    while (reader.next()) {
        if (reader.blank()) continue;
        if (reader.line().starts_with('#')) {
            if (parameters) continue;
            const bool begins = readKey(reader, header);
            header.marked = begins;
            if (!begins && !streamBegins(text, header, reader)) continue;
            samples = declare(header, reader, parameters);
            if (!header.binary) throw reader.error("#BEGIN_STREAM, but no #FORMAT binary");
            header.streamAt = static_cast<std::size_t>(reader.line().end() - text.begin()) + 1;
            if (header.streamAt > text.size()) throw reader.error("the file ends here");
            readStream(text, where, header, *parameters, reader, samples);
            return samples;
        }
        if (!parameters) samples = declare(header, reader, parameters);
        if (header.binary) throw reader.error("#FORMAT binary, but no #BEGIN_STREAM before this");
        reader.takeNumbers(row);
        if (row.size() != header.columns()) {
            throw reader.error(
                fmt::format("{} numbers, expected {} coordinates, {} values and {} "
                            "bounds",
                            row.size(), header.in, header.out, header.bounds));
        }
        addRow(header, *parameters, row, {where, "line", reader.lineNumber()}, samples);
    }
    if (!parameters) samples = declare(header, reader, parameters);
    return samples;
}

const Format& altaFormat() {
    static const Format format{
        .name = "alta",
        .help =
            "ALTA samples, text or binary stream, grey or RGB; rational and other functions that "
            "it fitted",
        .extension = ".alta",
        .recognises = looksLikeAlta,
        .parameters = scatteredParameters(
            {{.name = "input",
              .help = "parametrisation of a rational function whose file does not state it",
              .kind = Parameter::Kind::choice,
              .choices = inputChoices()}}),
        .open = [](const std::string& path, const Parameters& parameters) -> std::unique_ptr<Brdf> {
            std::unique_ptr<Brdf> function;
            const std::string input(parameters.choice("input"));
            withTextFile(path, [&](std::string_view text, const std::string& where) {
                if (text.starts_with(functionMark))
                    function = readAltaFunction(text, where, input == "file" ? "" : input);
            });
            if (!function && input != "file")
                throw UsageError(fmt::format(
                    "{}: input is for fitted functions; this is a file of samples", path));
            if (!function) return openScattered(path, parameters, readAlta);
            const double scale = scaleOf(parameters);
            if (scale == 1) return function;
            std::vector<Sum::Term> terms;
            terms.push_back({scale, std::move(function)});
            return std::make_unique<Sum>(std::move(terms));
        },
    };
    return format;
}

}  // namespace hshfit::brdfs
