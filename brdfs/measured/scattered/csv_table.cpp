#include <brdfs/measured/foreign.h>
#include <brdfs/measured/scattered/csv_table.h>
#include <brdfs/measured/scattered/text_file.h>
#include <brdfs/measured/text_reader.h>
#include <hshfit/files/printable.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

namespace hshfit::brdfs {
namespace {

constexpr double missing = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t mostLinesBefore = 200;

bool isRemark(std::string_view line) {
    line = withoutBlanks(line);
    return line.starts_with('#') || line.starts_with('%') || line.starts_with("//");
}

/// A line of names may be a remark itself: "# theta_i theta_o brdf".
std::string_view namesOfLine(std::string_view line) {
    line = withoutBlanks(line);
    const std::size_t first = line.find_first_not_of("#%/ \t");
    return first == std::string_view::npos ? std::string_view() : line.substr(first);
}

bool isMissing(std::string_view cell) {
    const std::string word = lowerCase(cell);
    return word.empty() || word == "na" || word == "n/a" || word == "nan" || word == "null" ||
           word == "none" || word == "-" || word == "--";
}

/// The number in a cell; NaN for one that was not measured.
double cellNumber(std::string_view cell, char separator, const Row& at, std::string_view name) {
    if (isMissing(cell)) return missing;
    std::string text(cell);
    if (separator != ',' && separator != ' ' && std::ranges::count(text, ',') == 1)
        std::ranges::replace(text, ',', '.');
    std::string_view rest = text;
    double value = 0;
    if (!takeNumber(rest, value) || !rest.empty())
        throw at.error(fmt::format("'{}' is no number ({})", shortened(printable(cell), 40), name));
    return value;
}

double neededNumber(std::string_view cell, char separator, const Row& at, std::string_view name) {
    const double value = cellNumber(cell, separator, at, name);
    if (!std::isfinite(value))
        throw at.error(
            fmt::format("{} is '{}', expected a number", name, shortened(printable(cell), 40)));
    return value;
}

TableRow takeRow(const std::vector<std::string_view>& cells, const SampleTable& table,
                 const Row& at) {
    const TableColumns& columns = table.columns;
    TableRow row;
    row.line = at.number;
    const auto needed = [&](std::size_t column, std::string_view name) {
        return neededNumber(cells[column], table.separator, at, name);
    };
    for (std::size_t k = 0; k < TableColumns::angleCount; ++k)
        if (columns.angles[k]) row.angles[k] = needed(*columns.angles[k], tableAngleNames[k]);
    for (std::size_t k = 0; columns.hasVectors() && k < TableColumns::vectorCount; ++k)
        row.vectors[k] = needed(*columns.vectors[k], "a component of a direction");
    const std::vector<std::string> names = columns.channels.names();
    for (std::size_t c = 0; c < columns.values.size(); ++c)
        row.values.push_back(cellNumber(cells[columns.values[c]], table.separator, at, names[c]));
    for (const std::size_t column : columns.sigmas)
        row.sigmas.push_back(cellNumber(cells[column], table.separator, at, "sigma"));
    if (columns.wavelength) row.wavelength = needed(*columns.wavelength, "the wavelength");
    if (columns.scan) row.scan = needed(*columns.scan, "scan");
    return row;
}

/// Moves the reader to the line of names.
void findNames(TextReader& reader, const std::string& where, SampleTable& table) {
    std::string before;
    while (reader.next()) {
        const std::string_view names = namesOfLine(reader.line());
        if (namesDirections(names)) {
            table.nameLine = reader.lineNumber();
            table.columns = tableColumns(names, {where, "line", table.nameLine});
            table.separator = separatorOf(names);
            table.before = quantityIn(before);
            return;
        }
        before += fmt::format("{}\n", reader.line());
        if (reader.lineNumber() >= mostLinesBefore) break;
    }
    throw InputError(fmt::format(
        "{}: no line with the names of the columns; expected theta_i, theta_o (degrees or radians) "
        "and brdf, R,G,B, or wavelengths such as 550nm",
        where));
}

SampleTable rowsOf(std::string_view text, const std::string& where) {
    TextReader reader(withoutByteOrderMark(text), where);
    SampleTable table;
    findNames(reader, where, table);
    std::vector<std::string_view> cells;
    while (reader.next()) {
        if (reader.blank() || isRemark(reader.line())) continue;
        splitCells(reader.line(), table.separator, cells);
        const bool nothing = std::ranges::all_of(cells, &std::string_view::empty);
        if (nothing) continue;  // a spreadsheet's empty row, of separators alone
        while (cells.size() > table.columns.count && cells.back().empty()) cells.pop_back();
        const Row at{where, "line", reader.lineNumber()};
        if (cells.size() != table.columns.count)
            throw at.error(fmt::format("{} cells, but line {} names {} columns", cells.size(),
                                       table.nameLine, table.columns.count));
        table.rows.push_back(takeRow(cells, table, at));
    }
    if (table.rows.empty()) throw reader.error("no rows after the names of the columns");
    return table;
}

double nanometresOf(const TableRow& row, const TableColumns& columns, const Row& at) {
    const double unit = columns.nanometres > 0  ? columns.nanometres
                        : row.wavelength >= 100 ? 1
                        : row.wavelength >= 0.1 ? 1e3
                                                : 1e9;
    const double nm = std::round(row.wavelength * unit * 1e3) / 1e3;
    if (!(nm >= 1 && nm <= 1e9))
        throw at.error(
            fmt::format("the wavelength {} is {} nm, expected at least 1 nm", row.wavelength, nm));
    return nm;
}

}  // namespace

bool hasNamedColumns(std::string_view text) {
    TextReader reader(withoutByteOrderMark(text), "");
    while (reader.next() && reader.lineNumber() <= mostLinesBefore)
        if (namesDirections(namesOfLine(reader.line()))) return true;
    return false;
}

SampleTable readSampleTable(std::string_view text, const std::string& where) {
    SampleTable table = rowsOf(text, where);
    if (table.columns.wavelength) gatherWavelengths(table, {where, "line", 0});
    return table;
}

void gatherWavelengths(SampleTable& table, const Row& at) {
    using Key = std::tuple<std::array<long, 6>, std::array<long, 6>, double>;
    struct Group {
        TableRow row;
        std::map<double, std::pair<double, double>> values;  ///< and sigma, by nm
    };
    const auto rounded = [](const auto& numbers) {
        std::array<long, 6> result{};
        for (std::size_t k = 0; k < numbers.size(); ++k)
            result[k] = std::lround(std::clamp(numbers[k], -1e9, 1e9) * 1e6);
        return result;
    };
    std::map<Key, std::vector<std::size_t>> known;
    std::vector<Group> groups;
    std::map<double, std::size_t> wavelengths;
    for (TableRow& row : table.rows) {
        const double nm = nanometresOf(row, table.columns, {at.where, at.unit, row.line});
        ++wavelengths[nm];
        auto& places = known[{rounded(row.angles), rounded(row.vectors), row.scan}];
        const std::pair value{row.values[0], row.sigmas.empty() ? 0 : row.sigmas[0]};
        // A repeated measurement begins a sample of its own.
        const auto free = std::ranges::find_if(
            places, [&](std::size_t place) { return !groups[place].values.contains(nm); });
        if (free != places.end()) {
            groups[*free].values.emplace(nm, value);
            continue;
        }
        places.push_back(groups.size());
        groups.push_back({std::move(row), {{nm, value}}});
    }
    std::vector<double> nanometres;
    for (const auto& [nm, count] : wavelengths) nanometres.push_back(nm);
    table.columns.channels = Channels::spectral(nanometres);
    table.rows.clear();
    for (Group& group : groups) {
        if (group.values.size() != nanometres.size()) {
            ++table.incomplete;
            continue;
        }
        group.row.values.clear();
        const bool hasSigma = !group.row.sigmas.empty();
        group.row.sigmas.clear();
        for (const auto& [nm, value] : group.values) {
            group.row.values.push_back(value.first);
            if (hasSigma) group.row.sigmas.push_back(value.second);
        }
        table.rows.push_back(std::move(group.row));
    }
}

}  // namespace hshfit::brdfs
