#include <brdfs/measured/scattered/csv_table.h>
#include <brdfs/measured/scattered/scattered.h>
#include <brdfs/measured/scattered/text_file.h>
#include <brdfs/measured/scattered/xompt.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/files/json_format.h>

#include <fmt/format.h>

#include <cmath>

namespace hshfit::brdfs {
namespace {

using Json = nlohmann::json;

constexpr int deepestXompt = 16;
constexpr std::size_t mostXomptBytes = std::size_t{1} << 28;

/// Takes one row of the table; false if it has a null.
bool takeXomptRow(const Json& row, const Row& at, TableRow& to) {
    if (!row.is_array() || row.size() != 5)
        throw at.error(
            "expected 5 numbers: wavelength in m, theta_i, theta_o, phi_o in radians, f in 1/sr");
    double numbers[5] = {};
    for (std::size_t k = 0; k < 5; ++k) {
        if (row[k].is_null()) return false;
        if (!row[k].is_number()) throw at.error(fmt::format("column {} is no number", k + 1));
        numbers[k] = row[k].get<double>();
        if (!std::isfinite(numbers[k]))
            throw at.error(
                fmt::format("column {} is {}, expected a finite number", k + 1, numbers[k]));
    }
    to.line = at.number;
    to.wavelength = numbers[0];
    to.angles[TableColumns::thetaI] = checkedPolarAngle(numbers[1], at, "theta_i");
    to.angles[TableColumns::thetaO] = checkedPolarAngle(numbers[2], at, "theta_o");
    to.angles[TableColumns::phiO] = checkedAzimuth(numbers[3], at, "phi_o");
    to.values = {numbers[4]};
    return true;
}

SampleTable readXomptRows(const Json& lookup, const std::string& where, std::size_t& nulls) {
    SampleTable table;
    table.columns.nanometres = 1e9;
    std::size_t number = 0;
    for (const Json& row : lookup) {
        TableRow taken;
        if (takeXomptRow(row, {where, "row", number}, taken))
            table.rows.push_back(std::move(taken));
        else
            ++nulls;
        ++number;
    }
    if (table.rows.empty()) throw InputError(where + ": lookupTable has no row of numbers");
    gatherWavelengths(table, {where, "row", 0});
    return table;
}

bool looksLikeXompt(std::span<const unsigned char> head, std::uint64_t) {
    const std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
    if (!beginsAsJson(text)) return false;
    for (const std::string_view mark : {"\"lookupTable\"", "openMaterial3dVersion", "OpenMATERIAL"})
        if (text.find(mark) != std::string_view::npos) return true;
    return false;
}

}  // namespace

Samples readXompt(std::string_view text, const std::string& where) {
    if (text.size() > mostXomptBytes)
        throw InputError(fmt::format("{}: {} bytes are too many for a look-up table (at most {})",
                                     where, text.size(), mostXomptBytes));
    const Json root = parseJson(text, where, deepestXompt);
    const auto lookup = [&](const Json& object, const char* key) -> const Json* {
        const auto found = object.is_object() ? object.find(key) : object.end();
        return object.is_object() && found != object.end() ? &*found : nullptr;
    };
    const Json* brdf = lookup(root, "brdf");
    const Json* rows = brdf ? lookup(*brdf, "lookupTable") : nullptr;
    if (!rows || !rows->is_array())
        throw InputError(fmt::format(
            "{}: no brdf.lookupTable; of OpenMATERIAL's tables those of BRDFs are read", where));
    std::size_t nulls = 0;
    const SampleTable table = readXomptRows(*rows, where, nulls);
    Samples samples;
    samples.facts = {{"format", "xompt"}};
    if (const Json* metadata = lookup(root, "metadata"))
        if (const Json* name = lookup(*metadata, "name"); name && name->is_string())
            samples.facts.emplace_back("material", name->get<std::string>().substr(0, 200));
    samples.channels = table.columns.channels;
    samples.isotropic = true;
    for (const TableRow& row : table.rows) {
        const auto& angles = row.angles;
        samples.add(directionFromAngles(angles[TableColumns::thetaI], 0),
                    directionFromAngles(angles[TableColumns::thetaO], angles[TableColumns::phiO]),
                    row.values, {where, "row", row.line});
    }
    if (nulls > 0) samples.leftOut.push_back(fmt::format("{} rows with null", nulls));
    if (table.incomplete > 0)
        samples.leftOut.push_back(fmt::format(
            "{} pairs of directions not measured at every wavelength", table.incomplete));
    return samples;
}

const Format& xomptFormat() {
    static const Format format{
        .name = "xompt",
        .help = "BRDF look-up tables of ASAM OpenMATERIAL 3D (JSON), spectral",
        .extension = ".xompt",
        .recognises = looksLikeXompt,
        .parameters = scatteredParameters(),
        .open =
            [](const std::string& path, const Parameters& parameters) {
                return openScattered(path, parameters, readXompt);
            },
    };
    return format;
}

}  // namespace hshfit::brdfs
