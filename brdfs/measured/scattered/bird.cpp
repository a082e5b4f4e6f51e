#include <brdfs/measured/scattered/bird.h>
#include <brdfs/measured/scattered/csv_table.h>
#include <brdfs/measured/scattered/scattered.h>
#include <brdfs/measured/scattered/text_file.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/files/json_format.h>
#include <hshfit/files/printable.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

namespace hshfit::brdfs {
namespace {

using Json = nlohmann::json;
using Stokes = std::array<double, 3>;  ///< S1, S2, S3 of light with S0 = 1

constexpr int deepestBird = 24;
constexpr std::size_t mostBirdBytes = std::size_t{1} << 28;

/// The values of one variable, which has to have as many as the variable BRDF.
std::vector<double> valuesOf(const JsonFields& variable, std::size_t count) {
    std::vector<double> values = variable.numbers("values");
    if (values.size() != count)
        variable.fail(fmt::format("has {} values, and BRDF has {}", values.size(), count),
                      "values");
    return values;
}

/// Angles in radians, checked.
std::vector<double> anglesOf(const JsonFields& data, const char* name, std::size_t count,
                             const std::string& where) {
    const JsonFields variable = data.object(name);
    const std::string unit = variable.word("unit");
    if (unit != "rad" && unit != "deg" && unit != "\u00b0")
        variable.fail("has to be \"deg\", \"\u00b0\" or \"rad\"", "unit");
    std::vector<double> angles = valuesOf(variable, count);
    const bool polar = name[0] == 't';
    for (std::size_t k = 0; k < count; ++k) {
        if (unit != "rad") angles[k] = radians(angles[k]);
        const Row at{where, "value", k};
        angles[k] =
            polar ? checkedPolarAngle(angles[k], at, name) : checkedAzimuth(angles[k], at, name);
    }
    return angles;
}

/// The wavelengths, and nanometres of one unit; empty where there are none.
std::vector<double> wavelengthsOf(const JsonFields& data, std::size_t count, double& nanometres) {
    for (const char* name : {"wavelength_i", "wavelength_r"}) {
        if (!data.has(name)) continue;
        const JsonFields variable = data.object(name);
        const std::string unit = variable.word("unit");
        const bool micro = unit == "\u03bcm" || unit == "\u00b5m" || unit == "um";
        if (unit != "nm" && !micro) variable.fail("has to be \"nm\" or \"\u03bcm\"", "unit");
        nanometres = micro ? 1e3 : 1;
        return valuesOf(variable, count);
    }
    return {};
}

Stokes stokesOf(const JsonFields& variable, const Json& value) {
    if (value == "u") return {0, 0, 0};
    if (value == "s") return {1, 0, 0};
    if (value == "p") return {-1, 0, 0};
    Stokes stokes{};
    const bool vector = value.is_array() && value.size() == 4 &&
                        std::ranges::all_of(value, [](const Json& v) { return v.is_number(); });
    if (!vector)
        variable.fail("has to hold \"s\", \"p\", \"u\" or four numbers of a Stokes vector",
                      "values");
    for (std::size_t k = 0; k < 3; ++k) {
        stokes[k] = value[k + 1].get<double>();
        if (!(std::fabs(stokes[k]) <= 1)) variable.fail("has a Stokes vector beyond 1", "values");
    }
    return stokes;
}

/// One for each value; empty where the file states no polarization.
std::vector<Stokes> polarizationOf(const JsonFields& data, const char* name, std::size_t count) {
    if (!data.has(name)) return {};
    const JsonFields variable = data.object(name);
    const Json& values = variable.at("values");
    if (!values.is_array() || values.size() != count)
        variable.fail(fmt::format("has to have {} values, as BRDF has", count), "values");
    std::vector<Stokes> all;
    for (const Json& value : values) all.push_back(stokesOf(variable, value));
    return all;
}

/// Standard uncertainties; empty where the file states none.
std::vector<double> sigmasOf(const JsonFields& data, const std::vector<double>& values) {
    const JsonFields brdf = data.object("BRDF");
    std::vector<double> sigmas;
    std::string unit;
    if (data.has("uBRDF")) {
        const JsonFields stated = data.object("uBRDF");
        unit = stated.word("unit");
        sigmas = valuesOf(stated, values.size());
    } else if (brdf.has("uncertainty")) {
        const JsonFields stated = brdf.object("uncertainty");
        unit = stated.word("unit");
        sigmas.assign(values.size(), stated.number("value"));
    }
    if (unit == "%")
        for (std::size_t k = 0; k < values.size(); ++k)
            sigmas[k] = std::fabs(values[k]) * sigmas[k] / 100;
    // Uncertainties of 0 are none.
    if (std::ranges::any_of(sigmas, [](double sigma) { return !(sigma > 0); })) sigmas.clear();
    return sigmas;
}

/// Rows that differ by polarization alone, as their means.
void averagePolarizations(SampleTable& table, const std::vector<Stokes>& polarization,
                          const std::string& where) {
    using Key = std::tuple<double, double, double, double, double>;
    struct Group {
        std::size_t first = 0, count = 0;
        Stokes sum{};
        double value = 0, variance = 0;
    };
    std::map<Key, Group> groups;
    for (std::size_t k = 0; k < table.rows.size(); ++k) {
        const TableRow& row = table.rows[k];
        const auto& a = row.angles;
        Group& group = groups[{row.wavelength, a[TableColumns::thetaI], a[TableColumns::phiI],
                               a[TableColumns::thetaO], a[TableColumns::phiO]}];
        if (group.count++ == 0) group.first = k;
        for (std::size_t s = 0; s < 3; ++s) group.sum[s] += polarization[k][s];
        group.value += row.values[0];
        if (!row.sigmas.empty()) group.variance += row.sigmas[0] * row.sigmas[0];
    }
    std::vector<std::pair<std::size_t, TableRow>> means;
    for (const auto& entry : groups) {
        const Group& group = entry.second;
        const auto n = static_cast<double>(group.count);
        for (const double s : group.sum)
            if (std::fabs(s) > 1e-6 * n)
                throw Row{where, "value", group.first}.error(
                    "polarization_i is of polarised light, and the file has no value for the "
                    "opposite polarization; their mean, or \"u\", is read");
        TableRow row = table.rows[group.first];
        row.values[0] = group.value / n;
        if (!row.sigmas.empty()) row.sigmas[0] = std::sqrt(group.variance) / n;
        means.emplace_back(group.first, std::move(row));
    }
    std::ranges::sort(means, {}, &std::pair<std::size_t, TableRow>::first);
    table.rows.clear();
    for (auto& mean : means) table.rows.push_back(std::move(mean.second));
}

SampleTable tableOf(const JsonFields& data, const std::string& where) {
    const JsonFields brdf = data.object("BRDF");
    const std::string unit = brdf.word("unit");
    if (unit != "1/sr" && unit != "sr^-1") brdf.fail("has to be \"1/sr\" or \"sr^-1\"", "unit");
    const std::vector<double> values = brdf.numbers("values");
    if (values.empty()) brdf.fail("is empty", "values");
    const std::size_t count = values.size();
    const auto thetaI = anglesOf(data, "theta_i", count, where),
               phiI = anglesOf(data, "phi_i", count, where),
               thetaR = anglesOf(data, "theta_r", count, where),
               phiR = anglesOf(data, "phi_r", count, where);
    SampleTable table;
    const auto wavelengths = wavelengthsOf(data, count, table.columns.nanometres);
    const auto sigmas = sigmasOf(data, values);
    const auto light = polarizationOf(data, "polarization_i", count);
    for (const Stokes& seen : polarizationOf(data, "polarization_r", count))
        if (seen != Stokes{})
            throw InputError(where +
                             ": polarization_r: values seen through an analyser are not "
                             "read; unpolarised observation is");
    for (std::size_t k = 0; k < count; ++k) {
        TableRow row;
        row.line = k;
        row.angles[TableColumns::thetaI] = thetaI[k];
        row.angles[TableColumns::phiI] = phiI[k];
        row.angles[TableColumns::thetaO] = thetaR[k];
        row.angles[TableColumns::phiO] = phiR[k];
        row.values = {values[k]};
        if (!sigmas.empty()) row.sigmas = {sigmas[k]};
        if (!wavelengths.empty()) row.wavelength = wavelengths[k];
        table.rows.push_back(std::move(row));
    }
    if (!light.empty()) averagePolarizations(table, light, where);
    if (!wavelengths.empty()) gatherWavelengths(table, {where, "value", 0});
    return table;
}

/// Facts of the metadata that are words.
void addFacts(const Json& root, Samples& samples) {
    const auto word = [&](const char* pointer) -> std::string {
        const Json::json_pointer place(pointer);
        if (!root.contains(place) || !root.at(place).is_string()) return {};
        return root.at(place).get<std::string>().substr(0, 200);
    };
    for (const auto& [key, pointer] : {std::pair("material", "/metadata/sample/name"),
                                       std::pair("laboratory", "/metadata/provenance/organization"),
                                       std::pair("method", "/metadata/method")})
        if (std::string text = word(pointer); !text.empty()) samples.facts.emplace_back(key, text);
    samples.isotropic = word("/metadata/sample/properties_symmetry") == "isotropic";
}

bool looksLikeBird(std::span<const unsigned char> head, std::uint64_t) {
    const std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
    if (!beginsAsJson(text)) return false;
    return text.find("brdf_json_schema") != std::string_view::npos ||
           (text.find("\"theta_r\"") != std::string_view::npos &&
            text.find("\"BRDF\"") != std::string_view::npos);
}

}  // namespace

Samples readBird(std::string_view text, const std::string& where) {
    if (text.size() > mostBirdBytes)
        throw InputError(fmt::format("{}: {} bytes are too many for a BRDF of BiRD (at most {})",
                                     where, text.size(), mostBirdBytes));
    const Json root = parseJson(text, where, deepestBird);
    if (!root.is_object()) throw InputError(where + ": has to be an object");
    const JsonFields fields(root, "", where);
    const SampleTable table = tableOf(fields.object("data"), where);
    Samples samples;
    samples.facts = {{"format", "bird"}};
    addFacts(root, samples);
    samples.channels = table.columns.channels;
    for (const TableRow& row : table.rows) {
        const auto& a = row.angles;
        const std::size_t before = samples.size();
        samples.add(directionFromAngles(a[TableColumns::thetaI], a[TableColumns::phiI]),
                    directionFromAngles(a[TableColumns::thetaO], a[TableColumns::phiO]), row.values,
                    {where, "value", row.line});
        if (samples.size() > before)
            samples.sigmas.insert(samples.sigmas.end(), row.sigmas.begin(), row.sigmas.end());
    }
    if (table.incomplete > 0)
        samples.leftOut.push_back(fmt::format(
            "{} pairs of directions not measured at every wavelength", table.incomplete));
    return samples;
}

const Format& birdFormat() {
    static const Format format{
        .name = "bird",
        .help = "Universal BRDF file of the BiRD project (JSON), grey or spectral",
        .extension = ".brdf",
        .recognises = looksLikeBird,
        .parameters = scatteredParameters(),
        .open =
            [](const std::string& path, const Parameters& parameters) {
                return openScattered(path, parameters, readBird);
            },
    };
    return format;
}

}  // namespace hshfit::brdfs
