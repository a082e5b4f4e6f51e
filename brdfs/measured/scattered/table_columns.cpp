#include <brdfs/measured/scattered/table_columns.h>
#include <brdfs/measured/scattered/text_file.h>
#include <brdfs/measured/text_reader.h>
#include <hshfit/files/printable.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

namespace hshfit::brdfs {
namespace {

/// A list of words with blanks between them.
using Words = std::string_view;

/// Names without blanks and signs, and without units.
constexpr std::string_view thetaINames =
    "thetai thetain theta1 incident incidence incidentangle incidenceangle incangle "
    "angleofincidence aoi incidentzenith incidencezenith incidentzenithangle incidentpolar "
    "incidentpolarangle zenithi zenithin srcz sourcezenith sourceangle sza solarzenith "
    "solarzenithangle sunzenith illuminationangle illuminationzenith lightangle lightzenith "
    "thetainc thetaincident thetasrc thetal polarin polari";
constexpr std::string_view phiINames =
    "phii phiin phi1 incidentazimuth incidenceazimuth azimuthi azimuthin srca sourceazimuth "
    "saa solarazimuth solarazimuthangle sunazimuth illuminationazimuth lightazimuth phiinc "
    "phiincident incidentazimuthangle phisrc phil";
constexpr std::string_view thetaONames =
    "thetao thetaout thetar thetas thetav theta2 view viewangle viewingangle viewzenith "
    "viewingzenith viewzenithangle viewz vza measureangle measuredangle measurementangle "
    "detectorangle detectorzenith receiverangle receiverzenith scatterangle scatteredangle "
    "scatterzenith scatterpolarangle reflectedangle reflectionangle reflectedzenith exitangle "
    "exitzenith exitzenithangle observationangle observerangle emissionangle outgoingangle "
    "outgoingzenith zenitho zenithout zenithr thetareflected thetascatter thetaview thetadet "
    "polarout polaro polarr";
constexpr std::string_view phiONames =
    "phio phiout phir phis phiv phi2 viewazimuth viewingazimuth viewazimuthangle viewa vaa "
    "azimutho azimuthout azimuthr detectorazimuth receiverazimuth scatterazimuth "
    "reflectedazimuth reflectionazimuth exitazimuth exitazimuthangle observationazimuth "
    "outgoingazimuth phireflected phiscatter phiview phidet";
constexpr std::string_view relativeNames =
    "phi deltaphi dphi phirel raa relativeazimuth relaz relativeazimuthangle azimuth "
    "azimuthangle azimuthdifference";
constexpr std::string_view outOfPlaneNames =
    "outofplane outofplaneangle oop offplane offplaneangle";
constexpr std::string_view vectorNames = "wix wiy wiz wox woy woz";

constexpr std::string_view brdfWords = "brdf bsdf f fr brdfvalue bsdfvalue";
constexpr std::string_view factorWords =
    "brf brfvalue reflectancefactor radiancefactor bidirectionalreflectancefactor hcrf pif "
    "pibrdf";
constexpr std::string_view unclearWords = "reflectance refl rho";
constexpr std::string_view plainWords = "value values grey gray";
constexpr std::string_view refusedWords =
    "btdf btf transmittance ccbrdf ccbsdf brdfcos cosbrdf bsdfcos cosinecorrectedbrdf arsf "
    "ars intensity";
constexpr std::string_view sigmaWords =
    "sigma uncertainty std stdev stddev sd standarddeviation standarduncertainty unc u";
constexpr std::string_view scanWords = "scan scanid scannumber run series";
constexpr std::string_view wavelengthWords = "wavelength wavelengths lambda wl wvl";

bool isAmong(std::string_view word, Words words) {
    for (std::size_t at = words.find(word); at != Words::npos && !word.empty();
         at = words.find(word, at + 1)) {
        const std::size_t end = at + word.size();
        if ((at == 0 || words[at - 1] == ' ') && (end == words.size() || words[end] == ' '))
            return true;
    }
    return false;
}

/// The name of a column: its letters and digits, and its unit.
struct ColumnName {
    std::string word;  ///< letters and digits in lower case, without the unit
    std::string unit;  ///< "deg", "nm", "%", "1/sr", …; empty: none
    std::optional<double> nanometres;
};

bool isDigit(char c) {
    return c >= '0' && c <= '9';
}

void replaceAll(std::string& text, std::string_view from, std::string_view to) {
    for (std::size_t at = text.find(from); at != std::string::npos;
         at = text.find(from, at + to.size()))
        text.replace(at, from.size(), to);
}

std::string latin(std::string_view cell) {
    std::string text(cell);
    constexpr std::pair<std::string_view, std::string_view> letters[] = {
        {"\u03b8", "theta"}, {"\u03d1", "theta"}, {"\u0398", "theta"},   {"\u03c6", "phi"},
        {"\u03d5", "phi"},   {"\u03a6", "phi"},   {"\u03bb", "lambda"},  {"\u03c3", "sigma"},
        {"\u03c0", "pi"},    {"\u00b5", "u"},     {"\u03bc", "u"},       {"\u00b0", "deg"},
        {"\u0394", "delta"}, {"\u00b7", " "},     {"\u207b\u00b9", "-1"}};
    for (const auto& [from, to] : letters) replaceAll(text, from, to);
    return lowerCase(text);
}

/// Takes a length off the front of `text`: "550nm", "0.55 um"; where it stands alone, "550".
std::optional<double> takeWavelength(std::string_view& text, bool alone) {
    std::string_view rest = text;
    double number = 0;
    if (!takeNumber(rest, number) || !(number > 0) || !std::isfinite(number)) return std::nullopt;
    rest = withoutBlanks(rest);
    constexpr std::pair<std::string_view, double> units[] = {
        {"nanometers", 1}, {"nm", 1},        {"micrometers", 1000},
        {"microns", 1000}, {"micron", 1000}, {"um", 1000}};
    for (const auto& [unit, scale] : units) {
        if (!rest.starts_with(unit)) continue;
        rest.remove_prefix(unit.size());
        if (!rest.empty() && std::isalnum(static_cast<unsigned char>(rest.front()))) continue;
        text = rest;
        // To a thousandth of a nm: 0.351 um is 351 nm.
        return scale == 1 ? number : std::round(number * 1e6) / 1e3;
    }
    // A name that is a number alone is one of nm.
    if (!alone || !rest.empty() || !(number >= 100 && number <= 50000)) return std::nullopt;
    text = rest;
    return number;
}

ColumnName parsedName(std::string_view cell) {
    const std::string text = latin(withoutBlanks(cell));
    ColumnName name;
    for (std::size_t at = 0; at < text.size(); ++at) {
        const char c = text[at];
        const bool digit = isDigit(c);
        const bool starts = digit && (at == 0 || (!isDigit(text[at - 1]) && text[at - 1] != '.'));
        if (starts && !name.nanometres) {
            std::string_view rest = std::string_view(text).substr(at);
            const bool alone = at == 0 || !std::isalnum(static_cast<unsigned char>(text[at - 1]));
            if (const auto nm = takeWavelength(rest, alone)) {
                name.nanometres = nm;
                at = text.size() - rest.size() - 1;
                continue;
            }
        }
        if (c == '(' || c == '[' || c == '{') {
            const std::size_t end = text.find_first_of(")]}", at);
            const std::size_t stop = std::min(end, text.size());
            std::string_view inside = std::string_view(text).substr(at + 1, stop - at - 1);
            std::string_view length = withoutBlanks(inside);
            if (const auto nm = takeWavelength(length, true); nm && !name.nanometres)
                name.nanometres = nm;
            else
                name.unit = withoutBlanks(inside);
            at = stop;
            continue;
        }
        if (std::isalnum(static_cast<unsigned char>(c))) name.word.push_back(c);
        if (c == '%') name.unit.assign(1, '%');
    }
    return name;
}

AngleUnit unitOf(std::string_view unit) {
    if (unit.starts_with("deg")) return AngleUnit::degrees;
    if (unit.starts_with("rad")) return AngleUnit::radians;
    return AngleUnit::unstated;
}

/// Moves a unit from the end of an angle's name to its unit.
void separateUnit(ColumnName& name, Words known) {
    if (!name.unit.empty() || isAmong(name.word, known)) return;
    for (const std::string_view unit : {"degrees", "degree", "deg", "radians", "radian", "rad"}) {
        if (!name.word.ends_with(unit)) continue;
        const std::string rest = name.word.substr(0, name.word.size() - unit.size());
        if (!isAmong(rest, known)) continue;
        name.word = rest;
        name.unit = unit;
        return;
    }
}

Words namesOfAngle(std::size_t angle) {
    constexpr Words names[] = {thetaINames, phiINames,     thetaONames,
                               phiONames,   relativeNames, outOfPlaneNames};
    return names[angle];
}

std::optional<std::size_t> angleOf(ColumnName& name) {
    for (std::size_t k = 0; k < TableColumns::angleCount; ++k) {
        ColumnName own = name;
        separateUnit(own, namesOfAngle(k));
        if (own.nanometres || !isAmong(own.word, namesOfAngle(k))) continue;
        name = own;
        return k;
    }
    return std::nullopt;
}

StatedQuantity quantityOf(const ColumnName& name, std::string_view word) {
    if (isAmong(word, factorWords)) return StatedQuantity::radianceFactor;
    if (isAmong(word, unclearWords)) return StatedQuantity::unclear;
    const bool perSteradian = name.unit.find("sr") != std::string::npos;
    if (isAmong(word, brdfWords) || perSteradian) return StatedQuantity::brdf;
    return StatedQuantity::none;
}

bool isQuantity(std::string_view word) {
    return word.empty() || isAmong(word, brdfWords) || isAmong(word, factorWords) ||
           isAmong(word, unclearWords) || isAmong(word, plainWords);
}

/// 0, 1, 2 for R, G, B, with the name of a quantity before or after it.
std::optional<std::size_t> colourOf(std::string_view word, std::string_view& rest) {
    constexpr std::string_view names[3][2] = {{"red", "r"}, {"green", "g"}, {"blue", "b"}};
    for (std::size_t c = 0; c < 3; ++c)
        for (const std::string_view name : names[c]) {
            if (word == name) {
                rest = {};
                return c;
            }
            if (word.ends_with(name) && isQuantity(word.substr(0, word.size() - name.size()))) {
                rest = word.substr(0, word.size() - name.size());
                return c;
            }
        }
    return std::nullopt;
}

/// A column of values, or of their uncertainties, before all columns are known.
struct ValueColumn {
    std::size_t column = 0;
    std::string word;  ///< of the quantity
    std::optional<double> nanometres;
    std::optional<std::size_t> colour;
    bool percent = false;
};

struct ValueColumns {
    std::vector<ValueColumn> values, sigmas;
};

std::string quotedName(std::string_view name) {
    return shortened(printable(name), 60);
}

void addQuantity(StatedQuantity& all, StatedQuantity one) {
    if (all == one || one == StatedQuantity::none) return;
    all = all == StatedQuantity::none ? one : StatedQuantity::unclear;
}

/// Takes the name of a column of wavelengths: wavelength, lambda_nm, wl (um).
bool takeWavelengthName(const ColumnName& name, TableColumns& columns) {
    std::string_view word = name.word, unit = name.unit;
    if (!isAmong(word, wavelengthWords) && word.size() > 2) {
        unit = word.substr(word.size() - 2);
        word.remove_suffix(2);
    }
    if (!isAmong(word, wavelengthWords)) return false;
    columns.nanometres = unit == "nm" ? 1 : unit == "um" ? 1e3 : unit == "m" ? 1e9 : 0;
    return true;
}

/// Takes the name as one of values or of uncertainties; false if it is neither.
bool takeValue(const ColumnName& name, std::size_t column, TableColumns& columns,
               ValueColumns& found) {
    const std::string_view word = name.word;
    for (std::size_t size = 1; size <= word.size(); ++size) {
        if (!isAmong(word.substr(0, size), sigmaWords)) continue;
        const std::string_view rest = word.substr(size);
        std::string_view quantity = rest;
        const auto colour = colourOf(rest, quantity);
        if (!colour && !isQuantity(rest)) continue;
        found.sigmas.push_back(
            {column, std::string(quantity), name.nanometres, colour, name.unit == "%"});
        return true;
    }
    std::string_view quantity = name.word;
    std::optional<std::size_t> colour;
    if (!name.nanometres && !isAmong(name.word, brdfWords)) colour = colourOf(name.word, quantity);
    if (!colour && !(isQuantity(name.word) && (name.nanometres || !name.word.empty())))
        return false;
    found.values.push_back({column, std::string(quantity), name.nanometres, colour, false});
    addQuantity(columns.quantity, quantityOf(name, quantity));
    return true;
}

/// The channels of the values, in ascending order of wavelengths or as R, G, B.
void orderValues(TableColumns& columns, std::vector<ValueColumn>& values, const Row& row) {
    const auto all = [&](auto has) { return std::ranges::all_of(values, has); };
    const auto refuse = [&](std::string_view message) { return row.error(message); };
    // f_r, f_g, f_b: the first of them is the usual name of a BRDF as well.
    if (values.size() == 3)
        for (ValueColumn& value : values)
            if (value.word == "fr" && !value.nanometres && !value.colour) value.colour = 0;
    if (values.empty())
        throw refuse(
            "no column of values; expected brdf, brf, R, G and B, or wavelengths such as 550nm");
    if (all([](const ValueColumn& c) { return c.nanometres.has_value(); })) {
        std::ranges::stable_sort(values, {}, &ValueColumn::nanometres);
        std::vector<double> wavelengths;
        for (const ValueColumn& value : values) {
            if (!wavelengths.empty() && *value.nanometres == wavelengths.back())
                throw refuse(fmt::format("two columns for {} nm", *value.nanometres));
            wavelengths.push_back(*value.nanometres);
        }
        columns.channels = Channels::spectral(wavelengths);
    } else if (values.size() == 3 &&
               all([](const ValueColumn& c) { return c.colour.has_value(); })) {
        std::ranges::stable_sort(values, {}, &ValueColumn::colour);
        for (std::size_t c = 0; c < 3; ++c)
            if (*values[c].colour != c) throw refuse("expected one column each of R, G and B");
        columns.channels = Channels::rgb();
    } else if (values.size() == 1) {
        columns.channels = Channels::grey();
    } else {
        throw refuse(fmt::format(
            "{} columns of values that are neither one, nor R, G and B, nor wavelengths",
            values.size()));
    }
    for (const ValueColumn& value : values) columns.values.push_back(value.column);
}

void orderSigmas(TableColumns& columns, const ValueColumns& found, const Row& row) {
    if (found.sigmas.empty()) return;
    columns.percent = found.sigmas.front().percent;
    for (const ValueColumn& sigma : found.sigmas)
        if (sigma.percent != columns.percent)
            throw row.error("uncertainties in percent and in 1/sr beside each other");
    if (found.sigmas.size() == 1 && !found.sigmas[0].nanometres && !found.sigmas[0].colour) {
        columns.sigmas = {found.sigmas[0].column};
        return;
    }
    for (const ValueColumn& value : found.values) {
        const auto same = [&](const ValueColumn& sigma) {
            return sigma.nanometres == value.nanometres && sigma.colour == value.colour;
        };
        const auto sigma = std::ranges::find_if(found.sigmas, same);
        if (sigma == found.sigmas.end() || found.sigmas.size() != found.values.size())
            throw row.error(
                "the uncertainties have to be one column sigma, or sigma_NAME for each value");
        columns.sigmas.push_back(sigma->column);
    }
}

void checkDirections(const TableColumns& columns, const Row& row) {
    using Columns = TableColumns;
    const auto has = [&](std::size_t k) { return columns.angles[k].has_value(); };
    const bool anyVector = std::ranges::any_of(columns.vectors, [](auto& v) { return !!v; });
    if (anyVector) {
        if (!std::ranges::all_of(columns.vectors, [](auto& v) { return !!v; }))
            throw row.error("directions as vectors need all of wi_x, wi_y, wi_z, wo_x, wo_y, wo_z");
        if (has(Columns::thetaI) || has(Columns::thetaO))
            throw row.error("directions as angles and as vectors beside each other");
        return;
    }
    if (!has(Columns::thetaI) || !has(Columns::thetaO))
        throw row.error(
            fmt::format("no column for {}; expected theta_i and theta_o (or "
                        "incident_angle and view_angle, or wi_x … wo_z)",
                        has(Columns::thetaI) ? "theta_o" : "theta_i"));
    if (has(Columns::relative) && (has(Columns::phiI) || has(Columns::phiO)))
        throw row.error("a relative azimuth beside those of the directions; expected either");
    if (has(Columns::outOfPlane) && (has(Columns::relative) || has(Columns::phiO)))
        throw row.error("an angle out of plane beside an azimuth; expected either");
}

}  // namespace

void splitCells(std::string_view line, char separator, std::vector<std::string_view>& cells) {
    cells.clear();
    const auto add = [&](std::string_view cell) {
        cell = withoutBlanks(cell);
        if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"')
            cell = withoutBlanks(cell.substr(1, cell.size() - 2));
        if (separator != ' ' || !cell.empty()) cells.push_back(cell);
    };
    bool quoted = false;
    std::size_t begin = 0;
    for (std::size_t at = 0; at < line.size(); ++at) {
        const char c = line[at];
        if (c == '"') quoted = !quoted;
        const bool ends = separator == ' ' ? c == ' ' || c == '\t' : c == separator;
        if (quoted || !ends) continue;
        add(line.substr(begin, at - begin));
        begin = at + 1;
    }
    add(line.substr(begin));
}

char separatorOf(std::string_view line) {
    for (const char c : {'\t', ';', ','})
        if (line.find(c) != std::string_view::npos) return c;
    return ' ';
}

bool namesDirections(std::string_view line) {
    std::vector<std::string_view> cells;
    splitCells(line, separatorOf(line), cells);
    bool in = false, out = false;
    for (const std::string_view cell : cells) {
        ColumnName name = parsedName(cell);
        const auto angle = angleOf(name);
        in = in || angle == TableColumns::thetaI || name.word == "wix";
        out = out || angle == TableColumns::thetaO || name.word == "woz";
    }
    return in && out;
}

TableColumns tableColumns(std::string_view line, const Row& row) {
    std::vector<std::string_view> cells;
    splitCells(line, separatorOf(line), cells);
    // Spreadsheets end every line with a separator where a column was emptied.
    while (!cells.empty() && cells.back().empty()) cells.pop_back();
    TableColumns columns;
    columns.count = cells.size();
    ValueColumns found;
    const auto once = [&](std::optional<std::size_t>& place, std::size_t column) {
        if (place)
            throw row.error(fmt::format("two columns for the same: '{}' and '{}'",
                                        quotedName(cells[*place]), quotedName(cells[column])));
        place = column;
    };
    for (std::size_t k = 0; k < cells.size(); ++k) {
        ColumnName name = parsedName(cells[k]);
        const std::size_t vector = isAmong(name.word, vectorNames) ? vectorNames.find(name.word) / 4
                                                                   : TableColumns::vectorCount;
        if (const auto angle = angleOf(name)) {
            once(columns.angles[*angle], k);
            columns.units[*angle] = unitOf(name.unit);
        } else if (vector < TableColumns::vectorCount && !name.nanometres) {
            once(columns.vectors[vector], k);
        } else if (isAmong(name.word, scanWords)) {
            once(columns.scan, k);
        } else if (takeWavelengthName(name, columns)) {
            once(columns.wavelength, k);
        } else if (isAmong(name.word, refusedWords)) {
            throw row.error(fmt::format("the column '{}' is no BRDF; expected f in 1/sr or pi f",
                                        quotedName(cells[k])));
        } else if (!takeValue(name, k, columns, found)) {
            // An angle that is not read would make each sample a wrong one.
            for (const std::string_view part :
                 {"theta", "phi", "azimuth", "zenith", "angle", "polar"})
                if (name.word.find(part) != std::string::npos)
                    throw row.error(fmt::format(
                        "the column '{}' looks like an angle of an unknown kind; expected theta_i, "
                        "phi_i, theta_o, phi_o, a relative azimuth phi, or out_of_plane",
                        quotedName(cells[k])));
            columns.unread.push_back(quotedName(cells[k]));
        }
    }
    checkDirections(columns, row);
    orderValues(columns, found.values, row);
    orderSigmas(columns, found, row);
    if (columns.wavelength && columns.channels.kind != Channels::Kind::grey)
        throw row.error("a column of wavelengths beside values by wavelength or colour");
    return columns;
}

StatedQuantity quantityIn(std::string_view text) {
    StatedQuantity all = StatedQuantity::none;
    const std::string words = latin(text);
    const auto has = [&](std::string_view word) {
        for (std::size_t at = words.find(word); at != std::string::npos;
             at = words.find(word, at + 1)) {
            const std::size_t end = at + word.size();
            const bool before = at > 0 && std::isalnum(static_cast<unsigned char>(words[at - 1]));
            const bool after =
                end < words.size() && std::isalnum(static_cast<unsigned char>(words[end]));
            if (!before && !after) return true;
        }
        return false;
    };
    if (has("brf") || has("reflectance factor") || has("radiance factor"))
        addQuantity(all, StatedQuantity::radianceFactor);
    if (has("brdf") || has("1/sr")) addQuantity(all, StatedQuantity::brdf);
    return all;
}

}  // namespace hshfit::brdfs
