#include "pair_file.h"

#include "number_text.h"

#include <hshfit/error.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <libfccp/csv.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::jobs {
namespace {

using io::double_quote_escape;
using io::trim_chars;

double numberIn(std::string_view cell, const std::string& where, const char* column) {
    double value = 0;
    const auto read = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (read.ec != std::errc() || read.ptr != cell.data() + cell.size() || !std::isfinite(value)) {
        throw InputError(
            fmt::format("{}, column {}: '{}' is not a finite number", where, column, cell));
    }
    return value;
}

constexpr const char* vectorColumns[] = {"wi_x", "wi_y", "wi_z", "wo_x", "wo_y", "wo_z"};
constexpr const char* angleColumns[] = {"theta_i", "phi_i", "theta_o", "phi_o"};

/// A remark on a first line with semicolons, as tables of spreadsheets have them where the decimal
/// sign is a comma.
std::string separatorRemark(const std::string& path) {
    std::array<char, 512> start{};
    std::ifstream file(path, std::ios::binary);
    file.exceptions(std::ios::badbit);
    file.read(start.data(), start.size());
    const std::string_view read(start.data(), static_cast<std::size_t>(file.gcount()));
    return read.substr(0, read.find('\n')).find(';') == std::string_view::npos
               ? ""
               : "; its first line has semicolons, and columns are separated by commas here";
}

template <std::size_t count, class Has>
void requireColumns(const std::string& path, const char* const (&names)[count], const Has& has) {
    for (const char* name : names) {
        if (has(name)) continue;
        throw InputError(fmt::format("{}: there is no column {} ({} are read, or {} in degrees){}",
                                     path, name, fmt::join(vectorColumns, ", "),
                                     fmt::join(angleColumns, ", "), separatorRemark(path)));
    }
}

/// A direction from the texts of its angles, which stand in two columns from `first` on.
Direction directionOf(const std::array<std::string, 4>& cells, std::size_t first,
                      const std::string& where) {
    const Angles angles{numberIn(cells[first], where, angleColumns[first]),
                        numberIn(cells[first + 1], where, angleColumns[first + 1])};
    if (!(angles.theta >= 0 && angles.theta <= 180))
        throw InputError(fmt::format("{}: the polar angle {} is not from 0 to 180 degrees", where,
                                     angles.theta));
    return angles.direction();
}

void takeAngles(const std::array<std::string, 4>& polar, const std::string& where, PairRow& row) {
    row.wi = directionOf(polar, 0, where);
    row.wo = directionOf(polar, 2, where);
    const double v[] = {row.wi.x, row.wi.y, row.wi.z, row.wo.x, row.wo.y, row.wo.z};
    for (std::size_t k = 0; k < row.cells.size(); ++k) row.cells[k] = fmt::format("{}", v[k]);
}

void takeVectors(const std::string& where, PairRow& row) {
    std::array<double, 6> v{};
    for (std::size_t k = 0; k < v.size(); ++k)
        v[k] = numberIn(row.cells[k], where, vectorColumns[k]);
    row.wi = unitDirection({v[0], v[1], v[2]}, [&] { return where; });
    row.wo = unitDirection({v[3], v[4], v[5]}, [&] { return where; });
}

}  // namespace

Direction unitDirection(const Direction& d, const std::function<std::string()>& where) {
    const double length = lengthOf(d.x, d.y, d.z);
    if (!std::isfinite(d.x) || !std::isfinite(d.y) || !std::isfinite(d.z))
        throw InputError(
            fmt::format("{}: the direction {}, {}, {} is not finite", where(), d.x, d.y, d.z));
    if (!isUnit(length)) {
        throw InputError(fmt::format("{}: the direction {}, {}, {} has length {:.4g}, not 1",
                                     where(), d.x, d.y, d.z, std::hypot(d.x, d.y, d.z)));
    }
    const double scale = 1 / length;  // one division for all three, as in blocks of directions
    return {d.x * scale, d.y * scale, d.z * scale};
}

void readPairs(const std::string& path, const std::function<void(const PairRow&)>& take) {
    try {
        io::CSVReader<11, trim_chars<' ', '\t'>, double_quote_escape<',', '"'>,
                      io::throw_on_overflow, io::empty_line_comment>
            reader(path);
        reader.read_header(io::ignore_extra_column | io::ignore_missing_column, "wi_x", "wi_y",
                           "wi_z", "wo_x", "wo_y", "wo_z", "theta_i", "phi_i", "theta_o", "phi_o",
                           "weight");
        const auto has = [&](const char* name) { return reader.has_column(name); };
        const bool angles =
            std::ranges::none_of(vectorColumns, has) && std::ranges::any_of(angleColumns, has);
        if (angles)
            requireColumns(path, angleColumns, has);
        else
            requireColumns(path, vectorColumns, has);
        PairRow row;
        std::array<std::string, 4> polar;
        std::string weight;
        auto& [a, b, c, d, e, f] = row.cells;
        while (reader.read_row(a, b, c, d, e, f, polar[0], polar[1], polar[2], polar[3], weight)) {
            const std::string where = fmt::format("{}, line {}", path, reader.get_file_line());
            if (angles)
                takeAngles(polar, where, row);
            else
                takeVectors(where, row);
            if (has("weight")) row.weight = numberIn(weight, where, "weight");
            take(row);
        }
    } catch (const io::error::can_not_open_file&) {
        throw InputError(path + ": no such file, or it cannot be read");
    } catch (const io::error::base& error) {
        error.format_error_message();
        throw InputError(error.what());
    }
}

PairSample readPairSample(const std::string& path) {
    std::vector<Direction> wi, wo;
    std::vector<double> weights;
    readPairs(path, [&](const PairRow& row) {
        wi.push_back(row.wi);
        wo.push_back(row.wo);
        if (row.weight) weights.push_back(*row.weight);
    });
    return pairsFrom(wi, wo, weights);
}

}  // namespace hshfit::jobs
