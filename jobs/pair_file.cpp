#include "pair_file.h"

#include <hshfit/error.h>

#include <fmt/format.h>
#include <libfccp/csv.h>

#include <charconv>
#include <cmath>
#include <string_view>
#include <vector>

namespace hshfit::jobs {
namespace {

using io::double_quote_escape;
using io::trim_chars;

double numberIn(std::string_view cell, const std::string& where) {
    double value = 0;
    const auto read = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (read.ec != std::errc() || read.ptr != cell.data() + cell.size() || !std::isfinite(value)) {
        throw InputError(fmt::format("{}: '{}' is not a finite number", where, cell));
    }
    return value;
}

/// The vector over its length. Lengths are checked: a column of angles is a likely mistake.
Direction unit(const Direction& d, double length, const std::string& where) {
    if (std::abs(length - 1) > 1e-3) {
        throw InputError(fmt::format("{}: the direction {}, {}, {} has length {:.4g}, not 1", where,
                                     d.x, d.y, d.z, length));
    }
    return {d.x / length, d.y / length, d.z / length};
}

Direction directionIn(const std::string* cells, const std::string& where) {
    const Direction d{numberIn(cells[0], where), numberIn(cells[1], where),
                      numberIn(cells[2], where)};
    return unit(d, std::hypot(d.x, d.y, d.z), where);
}

}  // namespace

void readPairs(const std::string& path, const std::function<void(const PairRow&)>& take) {
    try {
        io::CSVReader<6, trim_chars<' ', '\t'>, double_quote_escape<',', '"'>> reader(path);
        reader.read_header(io::ignore_extra_column, "wi_x", "wi_y", "wi_z", "wo_x", "wo_y", "wo_z");
        PairRow row;
        auto& [a, b, c, d, e, f] = row.cells;
        while (reader.read_row(a, b, c, d, e, f)) {
            const std::string where = fmt::format("{}, line {}", path, reader.get_file_line());
            row.wi = directionIn(&a, where);
            row.wo = directionIn(&d, where);
            take(row);
        }
    } catch (const io::error::base& error) {
        error.format_error_message();
        throw InputError(fmt::format("{} (the columns wi_x, wi_y, wi_z, wo_x, wo_y, wo_z are read)",
                                     error.what()));
    }
}

PairSample readPairSample(const std::string& path) {
    std::vector<Direction> wi, wo;
    std::vector<double> weights;
    try {
        io::CSVReader<7, trim_chars<' ', '\t'>, double_quote_escape<',', '"'>> reader(path);
        reader.read_header(io::ignore_extra_column | io::ignore_missing_column, "wi_x", "wi_y",
                           "wi_z", "wo_x", "wo_y", "wo_z", "weight");
        for (const char* name : {"wi_x", "wi_y", "wi_z", "wo_x", "wo_y", "wo_z"}) {
            if (reader.has_column(name)) continue;
            throw InputError(fmt::format("{}: there is no column {}", path, name));
        }
        const char* cells[7] = {};
        while (
            reader.read_row(cells[0], cells[1], cells[2], cells[3], cells[4], cells[5], cells[6])) {
            const std::string where = fmt::format("{}, line {}", path, reader.get_file_line());
            std::array<double, 6> v{};
            for (std::size_t k = 0; k < v.size(); ++k) v[k] = numberIn(cells[k], where);
            const Direction i{v[0], v[1], v[2]}, o{v[3], v[4], v[5]};
            wi.push_back(unit(i, std::sqrt(dot(i, i)), where));
            wo.push_back(unit(o, std::sqrt(dot(o, o)), where));
            if (reader.has_column("weight")) weights.push_back(numberIn(cells[6], where));
        }
    } catch (const io::error::base& error) {
        error.format_error_message();
        throw InputError(error.what());
    }
    return pairsFrom(wi, wo, weights);
}

}  // namespace hshfit::jobs
