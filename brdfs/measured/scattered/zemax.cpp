#include <brdfs/measured/bsdf_xml/selection.h>
#include <brdfs/measured/scattered/number_lines.h>
#include <brdfs/measured/scattered/scattered.h>
#include <brdfs/measured/scattered/text_file.h>
#include <brdfs/measured/scattered/zemax.h>
#include <hshfit/files/printable.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace hshfit::brdfs {
namespace {

struct ZemaxHead {
    bool mirrored = false, tristimulus = false, through = false;
    std::vector<double> rotations, incidences, azimuths, radials;
};

/// The values of one rotation and incidence, [azimuth][radial][channel].
using ZemaxTable = std::vector<double>;

class ZemaxReader {
public:
    ZemaxReader(std::string_view text, const std::string& where)
        : where_(where), reader_(text, where), numbers_(reader_, text.size()) {}

    Samples read(bool zerosMeasured);

private:
    void readHead();
    void readKeyword(std::string_view keyword);
    std::vector<double> list(std::string_view name, double least, double most);
    void readBlock(std::size_t channel);
    void addTable(std::size_t table, bool zerosMeasured, Samples& samples);
    InputError wrong(std::string_view name, std::string_view value, std::string_view expected);
    std::size_t nodes() const { return head_.azimuths.size() * head_.radials.size(); }
    std::size_t channels() const { return head_.tristimulus ? 3 : 1; }

    const std::string& where_;
    TextReader reader_;
    NumberLines numbers_;
    ZemaxHead head_;
    bool seen_[4] = {};  ///< Symmetry, SpectralContent, ScatterType, lists
    std::vector<ZemaxTable> tables_;
    std::vector<std::vector<std::size_t>> lines_;  ///< of the rows of each table
    std::vector<double> tis_;
    std::size_t zeros_ = 0;
};

InputError ZemaxReader::wrong(std::string_view name, std::string_view value,
                              std::string_view expected) {
    return reader_.error(
        fmt::format("{} is '{}', expected {}", name, shortened(printable(value), 40), expected));
}

std::vector<double> ZemaxReader::list(std::string_view name, double least, double most) {
    const std::size_t count = numbers_.takeCount(name);
    std::vector<double> values = numbers_.takeAscending(count, name);
    numbers_.endLine(name);
    for (const double value : {values.front(), values.back()}) {
        if (value >= least && value <= most) continue;
        throw reader_.error(
            fmt::format("{} of {} degrees, expected {} to {}", name, value, least, most));
    }
    return values;
}

void ZemaxReader::readKeyword(std::string_view keyword) {
    const auto is = [&](std::string_view name) { return lowerCase(keyword) == lowerCase(name); };
    const auto word = [&] { return lowerCase(reader_.takeWord()); };
    if (is("Source")) return;
    if (is("Symmetry")) {
        const std::string symmetry = word();
        head_.mirrored = symmetry == "planesymmetrical";
        if (!head_.mirrored && symmetry != "asymmetrical" && symmetry != "asymmetrical4d")
            throw wrong("Symmetry", symmetry, "PlaneSymmetrical, ASymmetrical or ASymmetrical4D");
        seen_[0] = true;
    } else if (is("SpectralContent")) {
        const std::string content = word();
        head_.tristimulus = content == "xyz";
        if (!head_.tristimulus && content != "monochrome")
            throw wrong("SpectralContent", content, "Monochrome or XYZ");
        seen_[1] = true;
    } else if (is("ScatterType")) {
        const std::string type = word();
        head_.through = type == "btdf";
        if (!head_.through && type != "brdf") throw wrong("ScatterType", type, "BRDF or BTDF");
        seen_[2] = true;
    } else if (is("SampleRotation")) {
        head_.rotations = list("SampleRotation", -360, 360);
    } else if (is("AngleOfIncidence")) {
        head_.incidences = list("AngleOfIncidence", 0, 90);
    } else if (is("ScatterAzimuth")) {
        head_.azimuths = list("ScatterAzimuth", -360, 360);
    } else if (is("ScatterRadial")) {
        head_.radials = list("ScatterRadial", 0, 180);
    } else {
        throw reader_.error(fmt::format("'{}' is no keyword of a Zemax BSDF file",
                                        shortened(printable(keyword), 40)));
    }
}

void ZemaxReader::readHead() {
    while (true) {
        numbers_.nextLine("DataBegin");
        const std::string_view keyword = reader_.takeWord();
        const std::string word = lowerCase(keyword);
        if (word == "monochrome" || word.starts_with("tristimulus")) break;
        readKeyword(keyword);
    }
    const bool lists = !head_.rotations.empty() && !head_.incidences.empty() &&
                       !head_.azimuths.empty() && !head_.radials.empty();
    if (!seen_[0] || !seen_[1] || !seen_[2] || !lists)
        throw reader_.error(
            "the data begin before all of Symmetry, SpectralContent, ScatterType, SampleRotation, "
            "AngleOfIncidence, ScatterAzimuth and ScatterRadial");
}

void ZemaxReader::readBlock(std::size_t channel) {
    numbers_.nextLine("DataBegin");
    if (lowerCase(reader_.takeWord()) != "databegin") throw reader_.error("expected DataBegin");
    const std::size_t count = head_.rotations.size() * head_.incidences.size();
    const std::size_t radials = head_.radials.size();
    for (std::size_t k = 0; k < count; ++k) {
        numbers_.nextLine("TIS");
        if (lowerCase(reader_.takeWord()) != "tis")
            throw reader_.error(fmt::format("expected TIS before table {} of {}", k + 1, count));
        const double tis = numbers_.take("TIS");
        if (channel == 0) {
            tis_.push_back(tis);
            tables_.emplace_back();
            lines_.emplace_back();
        }
        // Rows come before memory: a count that the file does not hold ends at its end.
        for (std::size_t a = 0; a < head_.azimuths.size(); ++a) {
            const std::vector<double> row = numbers_.take(radials, "the values");
            numbers_.endLine("a row of values");
            if (channel == 0) {
                lines_[k].push_back(reader_.lineNumber());
                tables_[k].resize((a + 1) * radials * channels());
            }
            for (std::size_t r = 0; r < radials; ++r)
                tables_[k][(a * radials + r) * channels() + channel] = row[r];
        }
    }
    numbers_.nextLine("DataEnd");
    if (lowerCase(reader_.takeWord()) != "dataend")
        throw reader_.error("expected DataEnd after the values of all angles");
}

void ZemaxReader::addTable(std::size_t table, bool zerosMeasured, Samples& samples) {
    const double rotation = head_.rotations[table / head_.incidences.size()];
    const double incidence = head_.incidences[table % head_.incidences.size()];
    const std::size_t radials = head_.radials.size();
    for (std::size_t a = 0; a < head_.azimuths.size(); ++a)
        for (std::size_t r = 0; r < radials; ++r) {
            // At the specular direction all azimuths are one place, and 360 is 0.
            if (a > 0 && head_.radials[r] == 0) continue;
            if (head_.azimuths[a] - head_.azimuths[0] == 360) continue;
            std::array<double, 3> f{};
            const double* from = tables_[table].data() + (a * radials + r) * channels();
            std::copy(from, from + channels(), f.begin());
            if (head_.tristimulus) f = rgbOfXyz(f[0], f[1], f[2]);
            const std::span<const double> values(f.data(), channels());
            const Row at{where_, "line", lines_[table][a]};
            const auto add = [&](double azimuth) {
                const DirectionPair pair =
                    zemaxPair(rotation, incidence, azimuth, head_.radials[r]);
                const bool zero = std::ranges::all_of(values, [](double v) { return v == 0; });
                if (zero && !zerosMeasured && pair.wo.z > -1e-6) {
                    ++zeros_;
                    return;
                }
                samples.add(pair.wi, pair.wo, values, at);
            };
            const double azimuth = head_.azimuths[a];
            add(azimuth);
            const bool ownImage = head_.radials[r] == 0 || std::fmod(std::fabs(azimuth), 180) == 0;
            if (head_.mirrored && head_.rotations.size() > 1 && !ownImage) add(-azimuth);
        }
}

Samples ZemaxReader::read(bool zerosMeasured) {
    readHead();
    for (std::size_t channel = 0; channel < channels(); ++channel) {
        if (channel > 0) numbers_.nextLine("the next tristimulus value");
        readBlock(channel);
    }
    Samples samples;
    samples.channels = head_.tristimulus ? Channels::rgb() : Channels::grey();
    samples.isotropic = head_.rotations.size() == 1;
    for (std::size_t table = 0; table < tables_.size(); ++table)
        addTable(table, zerosMeasured, samples);
    const auto [least, most] = std::ranges::minmax(tis_);
    samples.facts = {{"format", "zemax"},
                     {"symmetry", head_.mirrored ? "plane" : "none"},
                     {"scatter_type", head_.through ? "BTDF" : "BRDF"},
                     {"tis", fmt::format("{:.4g} to {:.4g}, not applied", least, most)}};
    if (zeros_ > 0) samples.leftOut.push_back(zerosLeftOut(zeros_));
    return samples;
}

bool looksLikeZemax(std::span<const unsigned char> head, std::uint64_t) {
    const std::string text = lowerCase(asText(head));
    return text.find("scatterradial") != std::string::npos ||
           (text.find("spectralcontent") != std::string::npos &&
            text.find("symmetry") != std::string::npos);
}

}  // namespace

DirectionPair zemaxPair(double rotation, double incidence, double azimuth, double radial) {
    const double A = radians(incidence), a = radians(azimuth), r = radians(radial);
    const double sA = std::sin(A), cA = std::cos(A);
    const double along = std::sin(r) * std::cos(a);
    // s = (sin A, 0, cos A), s x u = (0, -1, 0).
    const Direction wo{std::cos(r) * sA - along * cA, -std::sin(r) * std::sin(a),
                       std::cos(r) * cA + along * sA};
    return {rotateAboutZ({-sA, 0, cA}, -radians(rotation)), rotateAboutZ(wo, -radians(rotation))};
}

Samples readZemax(std::string_view text, const std::string& where, bool zerosMeasured) {
    return ZemaxReader(text, where).read(zerosMeasured);
}

namespace {

std::unique_ptr<Brdf> openZemax(const std::string& path, const Parameters& parameters) {
    const bool zerosMeasured = zerosAreMeasured(parameters);
    Samples samples;
    withTextFile(path, [&](std::string_view text, const std::string& where) {
        samples = readZemax(text, where, zerosMeasured);
    });
    const bool through =
        std::ranges::find(samples.facts, Fact{"scatter_type", "BTDF"}) != samples.facts.end();
    const bool stated = parameters.choice("side") != "auto";
    if (stated && !through)
        throw InputError(fmt::format("{}: ScatterType is BRDF, a reflection; side={} is for BTDF",
                                     path, parameters.choice("side")));
    ScatteredOptions options = scatteredOptions(parameters);
    options.exchange = options.exchange && !through;
    options.tables = ScatteredOptions::Tables::aboutMirror;
    std::string words = parameters.canonical();
    if (through && !stated)
        words += fmt::format("{}side=transmission-front", words.empty() ? "" : ",");
    return std::make_unique<Scattered>(std::move(samples), options,
                                       words.empty() ? path : path + ":" + words);
}

}  // namespace

const Format& zemaxFormat() {
    static const Format format{
        .name = "zemax",
        .help = "Tabular BSDF data of Zemax and Radiant, grey or RGB",
        .extension = ".bsdf",
        .recognises = looksLikeZemax,
        .parameters =
            scatteredParameters({{.name = "side",
                                  .help = "of the light of a BTDF; auto: of a BTDF, front",
                                  .kind = Parameter::Kind::choice,
                                  .choices = {"auto", "transmission-front", "transmission-back"}},
                                 zerosParameter()}),
        .open = openZemax,
    };
    return format;
}

}  // namespace hshfit::brdfs
