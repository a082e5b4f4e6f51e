#include <hshfit/irradiance/nine_numbers.h>

#include <hshfit/error.h>
#include <hshfit/files/printable.h>
#include <hshfit/linear_algebra/decompositions.h>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace hshfit::inline irradiance {
namespace {

constexpr std::size_t unknowns = 27, mostNumbers = 64;

std::vector<double> flat(const std::vector<std::vector<double>>& rows) {
    std::vector<double> numbers;
    for (const auto& row : rows) numbers.insert(numbers.end(), row.begin(), row.end());
    return numbers;
}

bool isName(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

/// Lines of l, m and three numbers without l and m.
std::vector<double> withoutPlaces(const std::vector<double>& numbers) {
    constexpr std::size_t columns = 5;
    if (numbers.size() != 9 * columns) return numbers;
    std::vector<double> kept;
    for (std::size_t k = 0; k < 9; ++k) {
        const double l = std::floor(std::sqrt(static_cast<double>(k)));
        const double* row = numbers.data() + columns * k;
        if (row[0] != l || row[1] != static_cast<double>(k) - l * (l + 1)) return numbers;
        kept.insert(kept.end(), row + 2, row + columns);
    }
    return kept;
}

/// The numbers of a line without remarks, added to those before it.
void addLine(std::string_view line, const std::string& name, std::vector<double>& numbers) {
    constexpr std::string_view between = " \t\r,;()[]{}\"";
    for (;;) {
        line.remove_prefix(std::min(line.find_first_not_of(between), line.size()));
        if (line.empty()) return;
        if (line.front() == '+') line.remove_prefix(1);
        double value = 0;
        const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), value);
        if (error != std::errc() || !std::isfinite(value))
            throw InputError(
                fmt::format("{}: '{}' is no number; a file of nine coefficients has "
                            "the numbers of R, G and B and remarks alone",
                            name, printable(std::string(line.substr(0, 20)))));
        numbers.push_back(value);
        if (numbers.size() > mostNumbers)
            throw InputError(
                fmt::format("{}: more than {} numbers; nine coefficients of R, G and "
                            "B are 27 of them",
                            name, mostNumbers));
        line.remove_prefix(static_cast<std::size_t>(end - line.data()));
    }
}

}  // namespace

NineRgb radianceFromEngine(const Convention& convention, const std::vector<double>& numbers,
                           const std::string& name) {
    const std::vector<double> none = flat(engineValues(convention, {}));
    const std::size_t read = none.size() - convention.redundant;
    if (numbers.size() != none.size() && numbers.size() != read)
        throw InputError(fmt::format("{}: has {} numbers; the convention {} has {}", name,
                                     numbers.size(), convention.name, none.size()));
    // Numbers are linear in the coefficients, but for constants.
    const auto rows = static_cast<Eigen::Index>(read);
    Eigen::MatrixXd columns(rows, static_cast<Eigen::Index>(unknowns));
    Eigen::VectorXd wanted(rows);
    for (Eigen::Index k = 0; k < rows; ++k)
        wanted(k) = numbers[static_cast<std::size_t>(k)] - none[static_cast<std::size_t>(k)];
    for (std::size_t j = 0; j < unknowns; ++j) {
        NineRgb unit{};
        unit[j / 3][j % 3] = 1;
        const std::vector<double> with = flat(engineValues(convention, unit));
        for (std::size_t k = 0; k < read; ++k)
            columns(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(j)) = with[k] - none[k];
    }
    const Eigen::VectorXd solution =
        Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(columns).solve(wanted);
    NineRgb radiance{};
    for (std::size_t j = 0; j < unknowns; ++j)
        radiance[j / 3][j % 3] = solution(static_cast<Eigen::Index>(j));
    return radiance;
}

std::vector<double> numbersOfText(std::string_view text, const std::string& name) {
    std::vector<double> numbers;
    for (bool first = true; !text.empty();) {
        std::string_view line = text.substr(0, text.find('\n'));
        text.remove_prefix(std::min(line.size() + 1, text.size()));
        line = line.substr(0, std::min(line.find("//"), line.find('#')));
        const std::size_t begin = line.find_first_not_of(" \t\r\"");
        if (begin == line.npos) continue;
        // A line of names.
        const bool names = first && isName(line[begin]);
        first = false;
        if (!names) addLine(line, name, numbers);
    }
    return withoutPlaces(numbers);
}

std::string_view conventionOfText(std::string_view text) {
    return text.find("// L00, irradiance, pre-scaled base") == text.npos ? "" : "filament";
}

}  // namespace hshfit::inline irradiance
