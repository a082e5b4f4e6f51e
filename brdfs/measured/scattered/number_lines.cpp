#include <brdfs/measured/scattered/number_lines.h>

#include <fmt/format.h>

#include <cmath>

namespace hshfit::brdfs {

void NumberLines::nextLine(std::string_view what, std::string_view remarks) {
    while (reader_.next()) {
        const std::size_t first = reader_.line().find_first_not_of(" \t");
        if (first == std::string_view::npos) continue;
        if (remarks.find(reader_.line()[first]) == std::string_view::npos) return;
    }
    throw reader_.error(fmt::format("the file ends before {}", what));
}

double NumberLines::take(std::string_view what) {
    double value = 0;
    while (!reader_.takeNumber(value)) nextLine(what);
    return value;
}

std::size_t NumberLines::takeCount(std::string_view what) {
    const double count = take(what);
    if (!(count >= 1) || count != std::floor(count) || count > static_cast<double>(bytes_) / 2) {
        throw reader_.error(fmt::format(
            "the number of {} is {}, expected a whole number from 1 that a file of {} bytes can "
            "hold",
            what, count, bytes_));
    }
    return static_cast<std::size_t>(count);
}

std::vector<double> NumberLines::take(std::size_t count, std::string_view what) {
    std::vector<double> values;
    while (values.size() < count) {
        const double value = take(what);
        if (!std::isfinite(value)) {
            throw reader_.error(fmt::format("number {} of {} is {}, expected a finite number",
                                            values.size() + 1, what, value));
        }
        values.push_back(value);
    }
    return values;
}

std::vector<double> NumberLines::takeAscending(std::size_t count, std::string_view what) {
    std::vector<double> values = take(count, what);
    for (std::size_t k = 1; k < count; ++k) {
        if (values[k] > values[k - 1]) continue;
        throw reader_.error(fmt::format("{}: {} after {}, expected ascending numbers", what,
                                        values[k], values[k - 1]));
    }
    return values;
}

void NumberLines::endLine(std::string_view what) {
    double more = 0;
    if (reader_.takeNumber(more)) {
        throw reader_.error(fmt::format("more numbers than announced in {}", what));
    }
}

}  // namespace hshfit::brdfs
