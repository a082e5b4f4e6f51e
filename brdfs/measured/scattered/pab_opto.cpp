#include <brdfs/measured/bsdf_xml/selection.h>
#include <brdfs/measured/scattered/pab_opto.h>
#include <brdfs/measured/scattered/scattered.h>
#include <brdfs/measured/scattered/sides.h>
#include <brdfs/measured/scattered/text_file.h>
#include <brdfs/measured/text_reader.h>
#include <hshfit/files/printable.h>

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

namespace hshfit::brdfs {
namespace {

constexpr double horizon = 1e-6;  // cosines below do not determine f

/// The header that the present rows have.
struct PabHeader {
    std::optional<double> theta, phi;  ///< of the light, degrees
    std::optional<bool> withCosine;
    bool coloured = false;
};

class PabReader {
public:
    PabReader(std::string_view text, const std::string& where)
        : where_(where), reader_(text, where) {}
    Samples read(std::string_view side);

private:
    void takeHeader();
    void takeFormat();
    double takeAngle(std::string_view name);
    void takeRow();

    const std::string& where_;
    TextReader reader_;
    PabHeader header_;
    bool inRows_ = false;
    std::optional<bool> coloured_;  ///< of the rows so far
    std::optional<SidedSamples> sided_;
    std::set<std::pair<double, double>> incidences_;
    std::string sample_;
    std::size_t atHorizon_ = 0;
};

double PabReader::takeAngle(std::string_view name) {
    double angle = 0;
    if (!reader_.takeNumber(angle) || !(std::fabs(angle) <= 720))
        throw reader_.error(fmt::format("{} has to be an angle in degrees", name));
    return angle;
}

void PabReader::takeFormat() {
    const std::string first = lowerCase(reader_.takeWord()), second = lowerCase(reader_.takeWord()),
                      third = lowerCase(reader_.takeWord());
    const bool value = third == "bsdf" || third == "brdf" || third == "btdf";
    if (first != "theta" || second != "phi" || (!value && third != "dsf"))
        throw reader_.error(
            "#format has to be 'theta phi BSDF', BRDF or BTDF, or 'theta phi DSF' for f times "
            "the cosine");
    header_.withCosine = !value;
}

void PabReader::takeHeader() {
    // A header after rows begins another file behind this one.
    if (inRows_) header_ = {};
    inRows_ = false;
    std::string name = lowerCase(reader_.takeWord());
    if (name == "#") name += lowerCase(reader_.takeWord());
    if (name.ends_with(':')) name.pop_back();
    if (name == "#format") takeFormat();
    if (name == "#intheta") header_.theta = takeAngle(name);
    if (name == "#inphi") header_.phi = takeAngle(name);
    if (name == "#incident_angle") {
        header_.theta = takeAngle(name);
        header_.phi = takeAngle(name);
    }
    if (name == "#colorimetry") {
        const std::string word = lowerCase(reader_.takeWord());
        if (word != "cie-y" && word != "cie-xyz")
            throw reader_.error(fmt::format("#colorimetry is '{}', expected CIE-Y or CIE-XYZ",
                                            shortened(printable(word), 40)));
        header_.coloured = word == "cie-xyz";
    }
    if (name == "#sample_name") {
        const std::string_view line = reader_.line();
        const std::size_t quote = line.find('"');
        if (quote != std::string_view::npos)
            sample_ = std::string(line.substr(quote + 1, line.rfind('"') - quote - 1));
    }
    if (header_.theta && !(*header_.theta >= 0 && *header_.theta <= 180))
        throw reader_.error(
            fmt::format("the incidence is at {} degrees, expected 0 to 180", *header_.theta));
}

void PabReader::takeRow() {
    if (!header_.withCosine || !header_.theta)
        throw reader_.error(fmt::format(
            "rows begin before a line {}",
            header_.withCosine ? "#incident_angle or #intheta" : "#format: theta phi BSDF"));
    if (coloured_ && *coloured_ != header_.coloured)
        throw reader_.error("#colorimetry differs from that of the rows before");
    coloured_ = header_.coloured;
    inRows_ = true;
    if (!sided_) sided_.emplace(header_.coloured ? Channels::rgb() : Channels::grey());
    std::vector<double> row;
    reader_.takeNumbers(row);
    const std::size_t count = header_.coloured ? 3 : 1;
    if (row.size() != 2 + count)
        throw reader_.error(fmt::format("{} numbers, expected theta, phi and {}", row.size(),
                                        header_.coloured ? "X, Y, Z" : "a value"));
    if (!(std::fabs(row[0]) <= 180 + 1e-6) || !(std::fabs(row[1]) <= 720))
        throw reader_.error(
            fmt::format("theta {} and phi {}, expected degrees up to 180 and 720", row[0], row[1]));
    const double inTheta = *header_.theta, inPhi = header_.phi.value_or(0);
    incidences_.emplace(inTheta, inPhi);
    const Direction wi = directionFromAngles(radians(inTheta), radians(inPhi));
    const Direction wo = directionFromAngles(radians(row[0]), radians(row[1]));
    std::array<double, 3> f{row[2], count == 3 ? row[3] : 0, count == 3 ? row[4] : 0};
    if (*header_.withCosine) {
        if (std::fabs(wo.z) < horizon) {
            ++atHorizon_;
            return;
        }
        for (double& value : f) value /= std::fabs(wo.z);
    }
    if (header_.coloured) f = rgbOfXyz(f[0], f[1], f[2]);
    sided_->add(wi, wo, std::span<const double>(f.data(), count),
                {where_, "line", reader_.lineNumber()});
}

Samples PabReader::read(std::string_view side) {
    while (reader_.next()) {
        const std::string_view line = withoutBlanks(reader_.line());
        if (line.empty()) continue;
        if (line[0] == '#')
            takeHeader();
        else
            takeRow();
    }
    if (!sided_) throw reader_.error("the file ends without a row of theta, phi and a value");
    Samples samples = sided_->take(side, where_);
    samples.facts = {{"format", "pab-opto"},
                     {"incidences", static_cast<std::int64_t>(incidences_.size())}};
    if (!sample_.empty()) samples.facts.emplace_back("sample_name", sample_.substr(0, 200));
    if (atHorizon_ > 0)
        samples.leftOut.push_back(
            fmt::format("{} values at the horizon, which f cos does not determine", atHorizon_));
    return samples;
}

bool looksLikePabOpto(std::span<const unsigned char> head, std::uint64_t) {
    const std::string text = lowerCase(asText(head));
    const std::size_t at = text.find("#format");
    if (at == std::string::npos || (at > 0 && text[at - 1] != '\n' && text[at - 1] != '\r'))
        return false;
    return text.find("theta", at) < text.find_first_of("\r\n", at);
}

}  // namespace

Samples readPabOpto(std::string_view text, const std::string& where, std::string_view side) {
    return PabReader(text, where).read(side);
}

const Format& pabOptoFormat() {
    static const Format format{
        .name = "pab-opto",
        .help =
            "Scans of pab-opto's gonio-photometers (Mountain), one incidence or several behind "
            "each other, grey or RGB",
        .extension = ".txt",
        .recognises = looksLikePabOpto,
        .parameters =
            scatteredParameters({sideParameter("polar angles beyond 90 degrees are on the back; "
                                               "auto: the first that the file has, reflections "
                                               "first")}),
        .open =
            [](const std::string& path, const Parameters& parameters) {
                const std::string side = parameters.choice("side");
                return openScattered(path, parameters,
                                     [&](std::string_view text, const std::string& where) {
                                         return readPabOpto(text, where, side);
                                     });
            },
    };
    return format;
}

}  // namespace hshfit::brdfs
