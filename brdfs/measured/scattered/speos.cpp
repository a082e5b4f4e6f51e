#include <brdfs/measured/scattered/number_lines.h>
#include <brdfs/measured/scattered/scattered.h>
#include <brdfs/measured/scattered/sides.h>
#include <brdfs/measured/scattered/speos.h>
#include <brdfs/measured/scattered/text_file.h>
#include <hshfit/files/printable.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace hshfit::brdfs {
namespace {

constexpr std::string_view spectralMark = "OPTIS - brdf surface file";
constexpr std::string_view anisotropicMark = "OPTIS - Anisotropic BSDF surface file";

/// One table: values over polar angle and azimuth in degrees, [theta][phi].
struct SpeosTable {
    std::vector<double> thetas, phis, values;
    std::vector<std::size_t> lines;  ///< of the rows
    /// Whether the polar angles of the file go from 90 to 180 degrees; `thetas` then belong to the
    /// directions mirrored at the surface, and ascend likewise.
    bool through = false;
};

/// The rows in the reverse order, with the supplements of their angles.
void mirrorThrough(SpeosTable& table) {
    const std::size_t phis = table.phis.size();
    std::vector<double> values;
    values.reserve(table.values.size());
    for (std::size_t t = table.thetas.size(); t-- > 0;)
        values.insert(values.end(), table.values.begin() + static_cast<std::ptrdiff_t>(t * phis),
                      table.values.begin() + static_cast<std::ptrdiff_t>((t + 1) * phis));
    table.values = std::move(values);
    std::ranges::reverse(table.thetas);
    std::ranges::reverse(table.lines);
    for (double& theta : table.thetas) theta = 180 - theta;
}

/// The integrals over [a, b] of (b - t)/(b - a) w(t) and of (t - a)/(b - a) w(t), w = sin t cos t
/// or sin t.
std::pair<double, double> shares(double a, double b, bool withCosine) {
    const auto zeroth = [&](double t) {
        return withCosine ? std::sin(t) * std::sin(t) / 2 : -std::cos(t);
    };
    const auto first = [&](double t) {
        return withCosine ? (std::sin(2 * t) - 2 * t * std::cos(2 * t)) / 8
                          : std::sin(t) - t * std::cos(t);
    };
    const double all = zeroth(b) - zeroth(a), moment = first(b) - first(a);
    const double right = (moment - a * all) / (b - a);
    return {all - right, right};
}

class SpeosReader {
public:
    SpeosReader(std::string_view text, const std::string& where, std::string_view side,
                bool zerosMeasured)
        : where_(where),
          reader_(text, where),
          numbers_(reader_, text.size()),
          side_(side),
          zerosMeasured_(zerosMeasured) {}

    Samples read();

private:
    void readHead();
    bool takeFlag(std::string_view what);
    void chooseSide();
    SpeosTable takeTable();
    SpeosTable takeWanted(double* percent);
    double integral(const SpeosTable& table) const;
    void readSpectral(Samples& samples);
    void readAnisotropic(Samples& samples);
    std::vector<double> readSpectrum(Samples& samples, double& incidence);
    double scaleAt(double incidence, const std::vector<double>& incidences,
                   const std::vector<SpeosTable>& tables);
    void addTable(double anisotropy, double incidence, const SpeosTable& first,
                  const std::vector<std::vector<double>>& channels,
                  const std::vector<unsigned char>& unmeasured, Samples& samples);

    const std::string& where_;
    TextReader reader_;
    NumberLines numbers_;
    std::string_view side_;
    bool zerosMeasured_;
    std::size_t zeros_ = 0;  ///< left out
    bool through_ = false;   ///< transmission is read
    bool anisotropic_ = false, reflects_ = false, transmits_ = false, ofBsdf_ = false;
};

bool SpeosReader::takeFlag(std::string_view what) {
    const double flag = numbers_.take(what);
    if (flag != 0 && flag != 1)
        throw reader_.error(fmt::format("{} is {}, expected 0 or 1", what, flag));
    return flag == 1;
}

// The description may have several lines; its length is announced in characters, line ends
// included.
void SpeosReader::readHead() {
    if (!reader_.next()) throw reader_.error("the file is empty");
    anisotropic_ = reader_.line().starts_with(anisotropicMark);
    if (!anisotropic_ && !reader_.line().starts_with(spectralMark))
        throw reader_.error(fmt::format("expected '{}' or '{}'", spectralMark, anisotropicMark));
    if (!reader_.next()) throw reader_.error("the file ends before its mode");
    if (takeFlag("the mode (0 text, 1 binary)"))
        throw reader_.error(
            "a binary Speos file, which is not read; save it as text in Speos' BSDF viewer");
    if (!reader_.next()) throw reader_.error("the file ends before its comment");
    if (!reader_.next()) throw reader_.error("the file ends before its description");
    const double length = numbers_.take("the length of the description");
    if (!(length >= 0 && length <= 1e6))
        throw reader_.error(fmt::format("the length of the description is {}", length));
    double taken = -1;
    do {
        if (!reader_.next()) throw reader_.error("the file ends in its description");
        taken += 1 + static_cast<double>(reader_.line().size());
    } while (taken < length);
    numbers_.nextLine("the kinds of data", "");
    if (anisotropic_) {
        numbers_.take(3, "the anisotropy vector");
        numbers_.nextLine("the kinds of data", "");
    }
    reflects_ = takeFlag("reflection (0 or 1)");
    transmits_ = takeFlag("transmission (0 or 1)");
    chooseSide();
    ofBsdf_ = takeFlag("the type of the values (1 BSDF, 0 intensity)");
}

void SpeosReader::chooseSide() {
    if (!reflects_ && !transmits_)
        throw reader_.error("the file says that it has neither reflection nor transmission");
    if (side_ == "auto") side_ = reflects_ ? sideWords[0] : sideWords[2];
    through_ = side_.starts_with("transmission");
    if (through_ ? !transmits_ : !reflects_)
        throw reader_.error(fmt::format("the file holds {} alone, and side={} is asked for",
                                        reflects_ ? "reflection" : "transmission", side_));
}

/// The next table of the kind that is read, with the percentage before it; a file with both kinds
/// tells them apart by their polar angles, in whatever order they come.
SpeosTable SpeosReader::takeWanted(double* percent) {
    while (true) {
        if (percent) *percent = numbers_.take("the percentage");
        SpeosTable table = takeTable();
        if (table.through == through_) {
            if (through_) mirrorThrough(table);
            return table;
        }
        if (!reflects_ || !transmits_)
            throw reader_.error(fmt::format(
                "the polar angles are from {} to {}, expected {} for {}", table.thetas.front(),
                table.thetas.back(), through_ ? "90 to 180" : "0 to 90",
                through_ ? "transmission" : "reflection"));
    }
}

SpeosTable SpeosReader::takeTable() {
    const std::size_t thetas = numbers_.takeCount("polar angles");
    const std::size_t phis = numbers_.takeCount("azimuths");
    SpeosTable table;
    table.phis = numbers_.takeAscending(phis, "azimuths");
    for (std::size_t t = 0; t < thetas; ++t) {
        const double theta = numbers_.take("a polar angle");
        if (t == 0) table.through = theta >= 90 - 1e-9;
        const double least = table.through ? 90 : 0;
        if (!(theta >= least - 1e-9 && theta <= least + 90 + 1e-9) ||
            (t > 0 && theta <= table.thetas.back()))
            throw reader_.error(
                fmt::format("a polar angle of {}, expected ascending ones from {} "
                            "to {} degrees",
                            theta, least, least + 90));
        table.thetas.push_back(theta);
        table.lines.push_back(reader_.lineNumber());
        const std::vector<double> row = numbers_.take(phis, "values");
        table.values.insert(table.values.end(), row.begin(), row.end());
    }
    const double around = table.phis.back() - table.phis.front();
    if (std::fabs(around - 360) > 1e-6 && std::fabs(around - 180) > 1e-6)
        throw reader_.error(fmt::format("azimuths from {} to {}, expected 360 or 180 degrees",
                                        table.phis.front(), table.phis.back()));
    return table;
}

/// The integral of the values, bilinear between the nodes, constant from the first polar angle to
/// the normal.
double SpeosReader::integral(const SpeosTable& table) const {
    const std::size_t phis = table.phis.size(), thetas = table.thetas.size();
    std::vector<double> rings(thetas, 0.0);
    for (std::size_t t = 0; t < thetas; ++t)
        for (std::size_t p = 0; p + 1 < phis; ++p)
            rings[t] += radians(table.phis[p + 1] - table.phis[p]) *
                        (table.values[t * phis + p] + table.values[t * phis + p + 1]) / 2;
    const bool half = std::fabs(table.phis.back() - table.phis.front() - 180) < 1e-6;
    double sum = 0;
    if (table.thetas[0] > 0) {
        const auto [left, right] = shares(0, radians(table.thetas[0]), ofBsdf_);
        sum += (left + right) * rings[0];
    }
    for (std::size_t t = 0; t + 1 < thetas; ++t) {
        const auto [left, right] =
            shares(radians(table.thetas[t]), radians(table.thetas[t + 1]), ofBsdf_);
        sum += left * rings[t] + right * rings[t + 1];
    }
    return half ? 2 * sum : sum;
}

void SpeosReader::addTable(double anisotropy, double incidence, const SpeosTable& first,
                           const std::vector<std::vector<double>>& channels,
                           const std::vector<unsigned char>& unmeasured, Samples& samples) {
    const double turn = -radians(anisotropy);
    const Direction wi = directionFromAngles(radians(incidence), pi + turn);
    const std::size_t phis = first.phis.size();
    std::vector<double> f(channels.size());
    for (std::size_t t = 0; t < first.thetas.size(); ++t)
        for (std::size_t p = 0; p < phis; ++p) {
            // At the normal all azimuths are one place, and 360 is 0.
            if (first.thetas[t] == 0 && p > 0) continue;
            if (p > 0 && first.phis[p] - first.phis[0] >= 360 - 1e-9) continue;
            const Direction wo =
                directionFromAngles(radians(first.thetas[t]), radians(first.phis[p]) + turn);
            const Row at{where_, "line", first.lines[t]};
            for (std::size_t c = 0; c < f.size(); ++c) f[c] = channels[c][t * phis + p];
            if (!ofBsdf_) {
                // On the horizon f cos does not determine f.
                if (!(wo.z > 1e-9)) {
                    samples.leaveOut(f, at);
                    continue;
                }
                for (double& value : f) value /= wo.z;
            }
            if (unmeasured[t * phis + p] && !zerosMeasured_)
                ++zeros_;
            else
                samples.add(wi, wo, f, at);
        }
}

void SpeosReader::readSpectral(Samples& samples) {
    const std::size_t incidences = numbers_.takeCount("incidences");
    const std::size_t wavelengths = numbers_.takeCount("wavelengths");
    const std::vector<double> angles = numbers_.takeAscending(incidences, "incidences");
    const std::vector<double> nanometres = numbers_.takeAscending(wavelengths, "wavelengths");
    if (!(angles[0] >= 0 && angles.back() <= 90))
        throw reader_.error("incidences have to be from 0 to 90 degrees");
    if (!(nanometres[0] > 0)) throw reader_.error("wavelengths have to be above 0");
    samples.channels = Channels::spectral(nanometres);
    samples.isotropic = true;
    for (const double incidence : angles) {
        SpeosTable first;
        std::vector<std::vector<double>> channels;
        std::vector<unsigned char> unmeasured;
        for (std::size_t c = 0; c < wavelengths; ++c) {
            double percent = 0;
            SpeosTable table = takeWanted(&percent);
            if (!(percent >= 0 && percent <= 1e6))
                throw reader_.error(fmt::format("{} percent is no reflectance", percent));
            const double whole = integral(table);
            if (percent > 0 && !(whole > 0))
                throw reader_.error(fmt::format(
                    "the table before this has an integral of {}, which {} percent do not scale",
                    whole, percent));
            if (c > 0 && (table.thetas != first.thetas || table.phis != first.phis))
                throw reader_.error(
                    fmt::format("the angles at {} nm are not those at {} nm; expected the same",
                                nanometres[c], nanometres[0]));
            const double scale = percent > 0 ? percent / 100 / whole : 0;
            if (c == 0) unmeasured.assign(table.values.size(), 1);
            for (std::size_t k = 0; k < table.values.size(); ++k)
                if (percent == 0 || table.values[k] != 0) unmeasured[k] = 0;
            channels.push_back(table.values);
            for (double& value : channels.back()) value *= scale;
            if (c == 0) first = std::move(table);
        }
        addTable(0, incidence, first, channels, unmeasured, samples);
    }
}

/// The share of the light that is reflected, by wavelength, and the incidence that it is for.
std::vector<double> SpeosReader::readSpectrum(Samples& samples, double& incidence) {
    incidence = numbers_.take("the incidence of the spectrum");
    numbers_.take("the azimuth of the spectrum");
    if (!reader_.next()) throw reader_.error("the file ends before the spectrum");
    if (!reader_.next()) throw reader_.error("the file ends before the spectrum");
    const std::size_t count = numbers_.takeCount("wavelengths");
    std::vector<double> nanometres, shares;
    for (std::size_t k = 0; k < count; ++k) {
        nanometres.push_back(numbers_.take("a wavelength"));
        const double percent = numbers_.take("a percentage");
        if (!(percent >= 0 && percent <= 1e6) || !(nanometres.back() > 0) ||
            (k > 0 && nanometres[k] <= nanometres[k - 1]))
            throw reader_.error(fmt::format("{} percent at {} nm, expected ascending wavelengths",
                                            percent, nanometres.back()));
        shares.push_back(percent / 100);
    }
    samples.facts.emplace_back("spectrum_incidence_degrees", incidence);
    if (std::ranges::all_of(shares, [&](double share) { return share == shares[0]; })) {
        samples.channels = Channels::grey();
        return {shares[0]};
    }
    samples.channels = Channels::spectral(nanometres);
    return shares;
}

double SpeosReader::scaleAt(double incidence, const std::vector<double>& incidences,
                            const std::vector<SpeosTable>& tables) {
    const auto above = std::ranges::lower_bound(incidences, incidence) - incidences.begin();
    const auto last = static_cast<std::ptrdiff_t>(incidences.size()) - 1;
    const auto at = [&](std::ptrdiff_t k) {
        const double whole = integral(tables[static_cast<std::size_t>(k)]);
        if (!(whole > 0))
            throw reader_.error(fmt::format(
                "the table at {} degrees, which the spectrum is for, has an integral of {}",
                incidences[static_cast<std::size_t>(k)], whole));
        return 1 / whole;
    };
    if (above > last) return at(last);
    const double right = incidences[static_cast<std::size_t>(above)];
    if (above == 0 || right == incidence) return at(above);
    const double left = incidences[static_cast<std::size_t>(above) - 1];
    const double t = (incidence - left) / (right - left);
    return (1 - t) * at(above - 1) + t * at(above);
}

void SpeosReader::readAnisotropic(Samples& samples) {
    const auto readAngles = [&](std::vector<double>& angles,
                                std::vector<std::vector<double>>& incidences) {
        const std::size_t count = numbers_.takeCount("anisotropy angles");
        angles = numbers_.takeAscending(count, "anisotropy angles");
        for (std::size_t k = 0; k < count; ++k) {
            const std::size_t angleCount = numbers_.takeCount("incidences");
            incidences.push_back(numbers_.takeAscending(angleCount, "incidences"));
            if (!(incidences.back()[0] >= 0 && incidences.back().back() <= 90))
                throw reader_.error("incidences have to be from 0 to 90 degrees");
        }
    };
    std::vector<double> angles, ignoredAngles;
    std::vector<std::vector<double>> incidences, ignored;
    const bool both = reflects_ && transmits_;
    if (both && through_) readAngles(ignoredAngles, ignored);
    readAngles(angles, incidences);
    if (both && !through_) readAngles(ignoredAngles, ignored);
    double spectrumIncidence = 0, otherIncidence = 0;
    Samples other;
    if (both && through_) readSpectrum(other, otherIncidence);
    const std::vector<double> shares = readSpectrum(samples, spectrumIncidence);
    if (both && !through_) readSpectrum(other, otherIncidence);
    samples.isotropic = angles.size() == 1;
    double scale = 0;
    for (std::size_t k = 0; k < angles.size(); ++k) {
        std::vector<SpeosTable> tables;
        for (std::size_t i = 0; i < incidences[k].size(); ++i)
            tables.push_back(takeWanted(nullptr));
        if (k == 0) scale = scaleAt(spectrumIncidence, incidences[0], tables);
        for (std::size_t i = 0; i < tables.size(); ++i) {
            std::vector<std::vector<double>> channels(shares.size(), tables[i].values);
            for (std::size_t c = 0; c < shares.size(); ++c)
                for (double& value : channels[c]) value *= shares[c] * scale;
            std::vector<unsigned char> unmeasured;
            for (const double value : tables[i].values) unmeasured.push_back(value == 0);
            addTable(angles[k], incidences[k][i], tables[i], channels, unmeasured, samples);
        }
    }
}

Samples SpeosReader::read() {
    readHead();
    Samples samples;
    samples.facts = {{"format", "speos"},
                     {"kind", anisotropic_ ? "anisotropic" : "spectral"},
                     {"values", ofBsdf_ ? "bsdf" : "intensity"}};
    if (anisotropic_)
        readAnisotropic(samples);
    else
        readSpectral(samples);
    if (reflects_ && transmits_)
        samples.leftOut.emplace_back(through_ ? "reflection (option side)"
                                              : "transmission (option side)");
    if (zeros_ > 0) samples.leftOut.push_back(zerosLeftOut(zeros_));
    samples.side = side_ == sideWords[3] ? sideWords[3] : through_ ? sideWords[2] : sideWords[0];
    return samples;
}

bool looksLikeSpeos(std::span<const unsigned char> head, std::uint64_t) {
    const std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
    return text.starts_with(spectralMark) || text.starts_with(anisotropicMark);
}

}  // namespace

Samples readSpeos(std::string_view text, const std::string& where, std::string_view side,
                  bool zerosMeasured) {
    return SpeosReader(text, where, side, zerosMeasured).read();
}

const Format& speosFormat() {
    static const Format format{
        .name = "speos",
        .help =
            "Surface files of Ansys Speos, .brdf and .anisotropicbsdf as text, grey or spectral",
        .extension = ".anisotropicbsdf",
        .recognises = looksLikeSpeos,
        .parameters = scatteredParameters(
            {{.name = "side",
              .help = "light comes from the front, unless stated otherwise; auto: reflection, or "
                      "transmission where the file has no other",
              .kind = Parameter::Kind::choice,
              .choices = {"auto", "reflection-front", "transmission-front", "transmission-back"}},
             zerosParameter()}),
        .open =
            [](const std::string& path, const Parameters& parameters) {
                const std::string side = parameters.choice("side");
                const bool zeros = zerosAreMeasured(parameters);
                return openTables(path, parameters,
                                  [&](std::string_view text, const std::string& where) {
                                      return readSpeos(text, where, side, zeros);
                                  });
            },
    };
    return format;
}

}  // namespace hshfit::brdfs
