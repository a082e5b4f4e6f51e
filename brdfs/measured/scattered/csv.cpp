#include <brdfs/measured/scattered/csv.h>
#include <brdfs/measured/scattered/csv_table.h>
#include <brdfs/measured/scattered/scattered.h>
#include <brdfs/measured/scattered/text_file.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace hshfit::brdfs {
namespace {

/// One unit of the file's angles in radians, and where it comes from.
std::pair<double, std::string> unitOfAngles(const SampleTable& table, const std::string& where,
                                            AngleUnit asked) {
    const auto result = [](AngleUnit unit, std::string_view from) {
        const bool inDegrees = unit == AngleUnit::degrees;
        return std::pair(inDegrees ? pi / 180 : 1.0,
                         fmt::format("{}{}", inDegrees ? "degrees" : "radians", from));
    };
    if (asked != AngleUnit::unstated) return result(asked, "");
    AngleUnit stated = AngleUnit::unstated;
    for (const AngleUnit unit : table.columns.units) {
        if (unit == AngleUnit::unstated || unit == stated) continue;
        if (stated != AngleUnit::unstated)
            throw InputError(
                fmt::format("{}: line {}: angles in degrees and in radians beside each other",
                            where, table.nameLine));
        stated = unit;
    }
    if (stated != AngleUnit::unstated) return result(stated, "");
    double polar = 0, around = 0;
    for (const TableRow& row : table.rows)
        for (std::size_t k = 0; k < TableColumns::angleCount; ++k) {
            const bool isPolar = k == TableColumns::thetaI || k == TableColumns::thetaO;
            double& largest = isPolar ? polar : around;
            largest = std::max(largest, std::fabs(row.angles[k]));
        }
    if (polar > pi / 2 + 1e-3 || around > 4 * pi + 1e-3)
        return result(AngleUnit::degrees, " (by their values)");
    if (polar >= 0.5) return result(AngleUnit::radians, " (by their values)");
    if (polar == 0 && around == 0) return result(AngleUnit::radians, " (all are 0)");
    throw InputError(fmt::format(
        "{}: line {}: angles up to {:.4g} may be degrees or radians; name the unit, theta_i (deg), "
        "or say angles=degrees or angles=radians",
        where, table.nameLine, polar));
}

/// Refuses angles past the horizon, and azimuths past two turns.
void checkAngles(const SampleTable& table, const std::string& where, double unit) {
    for (const TableRow& row : table.rows)
        for (std::size_t k = 0; k < TableColumns::angleCount; ++k) {
            const bool azimuthal =
                k == TableColumns::phiI || k == TableColumns::phiO || k == TableColumns::relative;
            const double most = azimuthal ? 4 * pi : pi / 2;
            if (std::fabs(row.angles[k]) * unit <= most + 1e-3) continue;
            throw Row{where, "line", row.line}.error(fmt::format(
                "{} is {}, expected at most {} {}", tableAngleNames[k], row.angles[k],
                unit == 1 ? most : std::round(degrees(most)), unit == 1 ? "radians" : "degrees"));
        }
}

/// Signed viewing angles without azimuth.
bool signedInPlane(const TableColumns& columns) {
    return !columns.hasVectors() && !columns.angles[TableColumns::phiO] &&
           !columns.angles[TableColumns::relative];
}

/// The viewing angle in the plane of incidence, above 0 on the side that is taken for the mirror
/// direction's; NaN out of that plane.
double inPlaneAngle(const TableRow& row, const TableColumns& columns, double unit) {
    const double out = row.angles[TableColumns::thetaO] * unit;
    const double across = std::cos(row.angles[TableColumns::relative] * unit);
    if (std::fabs(row.angles[TableColumns::outOfPlane] * unit) > radians(1) ||
        std::fabs(across) < std::cos(radians(2)))
        return std::numeric_limits<double>::quiet_NaN();
    return columns.angles[TableColumns::relative] && across > 0 ? -out : out;
}

/// Means of the samples within 10 degrees of equal angles, on the side of the mirror direction and
/// of the light.
std::pair<double, double> bothSides(const SampleTable& table, double unit) {
    double sums[2] = {0, 0}, counts[2] = {0, 0};
    for (const TableRow& row : table.rows) {
        const double in = row.angles[TableColumns::thetaI] * unit;
        const double out = inPlaneAngle(row, table.columns, unit);
        if (std::fabs(in) < radians(4) || std::isnan(out)) continue;
        for (int side = 0; side < 2; ++side) {
            if (std::fabs(out - (side == 0 ? in : -in)) > std::min(radians(10), std::fabs(in)))
                continue;
            for (const double value : row.values) {
                if (!std::isfinite(value)) continue;
                sums[side] += value;
                counts[side] += 1;
            }
        }
    }
    // Samples on the side of the light alone do not contradict an azimuth.
    if (counts[0] == 0 && table.columns.angles[TableColumns::relative]) return {0, 0};
    const auto mean = [&](int side) { return counts[side] > 0 ? sums[side] / counts[side] : 0; };
    return {mean(0), mean(1)};
}

/// Refuses samples that are brighter on the side of the light, unless an option states the side.
void checkSides(const SampleTable& table, const std::string& where, double unit,
                const CsvOptions& options) {
    const bool relative = table.columns.angles[TableColumns::relative].has_value();
    if (relative ? options.azimuth != CsvOptions::Azimuth::automatic
                 : options.forward != CsvOptions::Forward::automatic)
        return;
    const auto [mirror, light] = bothSides(table, unit);
    if (!(light > 2 * mirror)) return;
    throw InputError(fmt::format(
        "{}: samples at {} are brighter than at {} ({:.3g} and {:.3g}): say {} if the mirror "
        "direction is there, or {} if the sample reflects back to the light",
        where, relative ? "azimuth 0" : "theta_o = -theta_i", relative ? "azimuth 180" : "+theta_i",
        light, mirror, relative ? "azimuth=mirror" : "forward=minus",
        relative ? "azimuth=light" : "forward=plus"));
}

DirectionPair pairOf(const TableRow& row, const SampleTable& table, double unit, bool plus,
                     const CsvOptions& options, const Row& at) {
    const TableColumns& columns = table.columns;
    if (columns.hasVectors()) {
        const auto unitVector = [&](std::size_t from) {
            Direction d{row.vectors[from], row.vectors[from + 1], row.vectors[from + 2]};
            const double size = std::sqrt(dot(d, d));
            if (!(std::fabs(size - 1) < 1e-3))
                throw at.error(fmt::format("a direction has the length {}, expected 1", size));
            return Direction{d.x / size, d.y / size, d.z / size};
        };
        return {unitVector(0), unitVector(3)};
    }
    const auto angle = [&](std::size_t k) { return row.angles[k] * unit; };
    const double phiI = angle(TableColumns::phiI);
    const Direction wi = directionFromAngles(angle(TableColumns::thetaI), phiI);
    if (!signedInPlane(columns)) {
        const double offset = options.azimuth == CsvOptions::Azimuth::mirror ? pi : 0;
        const double phiO = columns.angles[TableColumns::relative]
                                ? phiI + angle(TableColumns::relative) + offset
                                : angle(TableColumns::phiO);
        return {wi, directionFromAngles(angle(TableColumns::thetaO), phiO)};
    }
    // In the frame whose plane of incidence is the xz plane, the light at +theta_i.
    const double out = angle(TableColumns::thetaO) * (plus ? -1 : 1),
                 off = angle(TableColumns::outOfPlane);
    const Direction wo{std::sin(out) * std::cos(off), std::sin(off), std::cos(out) * std::cos(off)};
    return {wi, rotateAboutZ(wo, phiI)};
}

void addCsvSigmas(const TableRow& row, const TableColumns& columns, const Row& at,
                  Samples& samples) {
    for (std::size_t c = 0; !row.sigmas.empty() && c < row.values.size(); ++c) {
        double sigma = row.sigmas[row.sigmas.size() == 1 ? 0 : c];
        if (columns.percent) sigma *= std::fabs(row.values[c]) / 100;
        if (!(sigma > 0) || !std::isfinite(sigma))
            throw at.error(fmt::format("sigma is {}, expected a number above 0", sigma));
        samples.sigmas.push_back(sigma);
    }
    if (columns.scan) samples.scans.push_back(row.scan);
}

/// The factor from the values of the file to f, unless an option states the quantity.
double quantityFactor(const SampleTable& table, const std::string& where, StatedQuantity asked,
                      Samples& samples) {
    using enum StatedQuantity;
    const auto fact = [&](std::string_view text) {
        samples.facts.emplace_back("quantity", std::string(text));
    };
    if (asked != none) {
        fact(asked == brdf ? "brdf (option)" : "radiance-factor (option)");
        return 1;  // every scattered format applies the option
    }
    StatedQuantity stated = table.columns.quantity;
    if (stated == none) stated = table.before;
    if (stated == unclear)
        throw InputError(fmt::format(
            "{}: the names do not tell whether the values are f in 1/sr or pi f: say quantity=brdf "
            "or quantity=radiance-factor",
            where));
    fact(stated == none   ? "brdf (not stated by the file)"
         : stated == brdf ? "brdf"
                          : "radiance-factor");
    return stated == radianceFactor ? 1 / pi : 1;
}

void addSamples(const SampleTable& table, const std::string& where, const CsvOptions& options,
                Samples& samples) {
    const auto [unit, unitText] = table.columns.hasVectors()
                                      ? std::pair(1.0, std::string("vectors"))
                                      : unitOfAngles(table, where, options.angles);
    samples.facts.emplace_back("angles", unitText);
    checkAngles(table, where, unit);
    const bool inPlane = signedInPlane(table.columns);
    const bool plus = options.forward != CsvOptions::Forward::minus;
    if (inPlane || table.columns.angles[TableColumns::relative])
        checkSides(table, where, unit, options);
    if (inPlane)
        samples.facts.emplace_back("mirror_direction",
                                   plus ? "theta_o = +theta_i" : "theta_o = -theta_i");
    std::size_t unmeasured = 0, zeros = 0;
    for (const TableRow& row : table.rows) {
        const Row at{where, "line", row.line};
        const DirectionPair pair = pairOf(row, table, unit, plus, options, at);
        const auto isNan = [](double value) { return std::isnan(value); };
        if (std::ranges::any_of(row.values, isNan)) {
            ++unmeasured;
            continue;
        }
        if (std::ranges::all_of(row.values, [](double value) { return value == 0; })) {
            ++zeros;
            if (!options.zerosMeasured) continue;
        }
        const std::size_t before = samples.size();
        samples.add(pair.wi, pair.wo, row.values, at);
        if (samples.size() > before) addCsvSigmas(row, table.columns, at, samples);
    }
    if (unmeasured > 0)
        samples.leftOut.push_back(fmt::format("{} rows without a value", unmeasured));
    if (zeros > 0 && !options.zerosMeasured)
        samples.leftOut.push_back(fmt::format("{} samples of 0", zeros));
    if (zeros > 0 && options.zerosMeasured)
        samples.facts.emplace_back("samples_of_0", static_cast<std::int64_t>(zeros));
}

bool looksLikeCsv(std::span<const unsigned char> head, std::uint64_t) {
    const std::string_view text = asText(head);
    if (text.starts_with('{')) return false;  // JSON
    // NIST's rows have a format of their own, with 15 elements more.
    return !text.starts_with("lambda,thetai,phi,thetar") && hasNamedColumns(text);
}

CsvOptions csvOptions(const Parameters& parameters) {
    CsvOptions options;
    const std::string angles = parameters.choice("angles");
    if (angles != "auto")
        options.angles = angles == "degrees" ? AngleUnit::degrees : AngleUnit::radians;
    const std::string quantity = parameters.choice("quantity");
    if (quantity != "auto")
        options.quantity =
            quantity == "brdf" ? StatedQuantity::brdf : StatedQuantity::radianceFactor;
    const std::string forward = parameters.choice("forward");
    if (forward != "auto")
        options.forward =
            forward == "plus" ? CsvOptions::Forward::plus : CsvOptions::Forward::minus;
    const std::string azimuth = parameters.choice("azimuth");
    if (azimuth != "auto")
        options.azimuth =
            azimuth == "mirror" ? CsvOptions::Azimuth::mirror : CsvOptions::Azimuth::light;
    options.zerosMeasured = parameters.choice("zeros") == "values";
    return options;
}

/// The options of every scattered format; the quantity may be left to the file.
std::vector<Parameter> csvParameters() {
    using Kind = Parameter::Kind;
    std::vector<Parameter> parameters = scatteredParameters(
        {{.name = "angles",
          .help = "unit of the angles; auto: as named, else degrees if one is above pi/2",
          .kind = Kind::choice,
          .choices = {"auto", "degrees", "radians"}},
         {.name = "forward",
          .help =
              "sign of in-plane viewing angles on the side of the mirror direction; auto: plus, "
              "unless the samples contradict",
          .kind = Kind::choice,
          .choices = {"auto", "plus", "minus"}},
         {.name = "azimuth",
          .help = "side where a relative azimuth is 0; auto: light, unless the samples contradict",
          .kind = Kind::choice,
          .choices = {"auto", "light", "mirror"}},
         {.name = "zeros",
          .help = "meaning of samples that are 0 in every channel",
          .kind = Kind::choice,
          .choices = {"values", "unmeasured"}}});
    for (Parameter& parameter : parameters) {
        if (parameter.name != "quantity") continue;
        parameter.help =
            "the values: f in 1/sr, or pi f, 1 for an ideal Lambert surface; auto: as "
            "named, else f";
        parameter.choices = {"auto", "brdf", "radiance-factor"};
    }
    return parameters;
}

}  // namespace

Samples readCsv(std::string_view text, const std::string& where, const CsvOptions& options) {
    const SampleTable table = readSampleTable(text, where);
    Samples samples;
    samples.facts = {{"format", "csv"}};
    samples.channels = table.columns.channels;
    const double factor = quantityFactor(table, where, options.quantity, samples);
    addSamples(table, where, options, samples);
    if (factor != 1) samples.scale(factor);
    if (table.incomplete > 0)
        samples.leftOut.push_back(fmt::format(
            "{} pairs of directions not measured at every wavelength", table.incomplete));
    if (!table.columns.unread.empty())
        samples.leftOut.push_back(fmt::format("columns {}", fmt::join(table.columns.unread, ", ")));
    return samples;
}

const Format& csvFormat() {
    static const Format format{
        .name = "csv",
        .help =
            "Tables of samples with named columns, in degrees or radians, f or pi f, grey, RGB "
            "or spectral",
        .extension = ".csv",
        .recognises = looksLikeCsv,
        .parameters = csvParameters(),
        .open =
            [](const std::string& path, const Parameters& parameters) {
                return openScattered(path, parameters,
                                     [=](std::string_view text, const std::string& where) {
                                         return readCsv(text, where, csvOptions(parameters));
                                     });
            },
    };
    return format;
}

}  // namespace hshfit::brdfs
