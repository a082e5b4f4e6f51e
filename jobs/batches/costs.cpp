#include "costs.h"

#include "manifest.h"
#include "program.h"

#include <hshfit/error.h>
#include <hshfit/files/checksum.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/specification/parameters.h>

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

namespace hshfit::jobs {

namespace fs = std::filesystem;

namespace {

/// Items of a class whose mean is better than the mean of the wider class.
constexpr std::size_t enough = 5;
constexpr std::string_view header = "name,class,wider_class,seconds,cpu_seconds,peak_bytes";

/// The binary exponent of a number, "2^-3"; times vary with orders of magnitude.
std::string magnitude(double number) {
    return number == 0 ? "0" : fmt::format("2^{}", std::ilogb(number));
}

/// A text for a number; texts are in the order of the numbers' absolute values.
std::string inOrder(double number) {
    int exponent = 0;
    const double mantissa = std::frexp(std::abs(number), &exponent);
    constexpr int least = 1100;  // below any exponent of a double
    return fmt::format("{:04d}{:.6f}", number == 0 ? 0 : exponent + least, mantissa);
}

/// `text` with each of its numbers replaced by what `write` makes of it.
template <class Write>
std::string withNumbers(std::string_view text, const Write& write) {
    std::string result;
    for (std::size_t i = 0; i < text.size();) {
        const bool begins = i == 0 || std::string_view("=/,").find(text[i - 1]) != text.npos;
        double number = 0;
        const auto [end, error] =
            std::from_chars(text.data() + i, text.data() + text.size(), number);
        if (begins && error == std::errc() && std::isfinite(number)) {
            result += write(number);
            i = static_cast<std::size_t>(end - text.data());
        } else {
            result += text[i++];
        }
    }
    return result;
}

/// The command and its options, and as input the extension and the size of a file, or a model with
/// its parameters. `write` makes the text of a number.
template <class Write>
std::string textOf(const BatchItem& item, const BatchProgram& program, const Write& write) {
    constexpr std::size_t digits = 12;
    const std::string& input = item.inputs.front();
    const fs::path path(pathIn(input));
    std::error_code error;
    const std::string kind = path.empty()
                                 ? withNumbers(input, write)
                                 : path.extension().string() + " " +
                                       write(static_cast<double>(fs::file_size(path, error)));
    std::string text = fmt::format("{} {} {}", program.commands[item.command].name,
                                   sha256(jsonText(*item.options)).substr(0, digits), kind);
    for (char& c : text)
        if (c == ',' || c == '"') c = ' ';
    return text;
}

}  // namespace

std::string classOf(const BatchItem& item, const BatchProgram& program) {
    return textOf(item, program, magnitude);
}

std::string widerClassOf(const BatchItem& item, const BatchProgram& program) {
    return textOf(item, program, [](double) { return std::string(); });
}

std::string similarityOf(const BatchItem& item, const BatchProgram& program) {
    return fmt::format("{} {}", textOf(item, program, inOrder), item.name);
}

std::optional<double> Costs::classMean(const std::string& name, std::size_t least) const {
    const auto found = classes_.find(name);
    if (found == classes_.end() || found->second.second < least) return {};
    return found->second.first / static_cast<double>(found->second.second);
}

double Costs::of(const BatchItem& item, const BatchProgram& program) const {
    if (item.cost > 0) return item.cost;
    if (const auto found = seconds_.find(item.name); found != seconds_.end()) return found->second;
    if (const auto mean = classMean(classOf(item, program), enough)) return *mean;
    if (const auto mean = classMean(widerClassOf(item, program), 1)) return *mean;
    // A file has to be read, whatever is done with it: 100 MB weigh as much as the work.
    constexpr double bytesOfOne = 1e8;
    const fs::path path(pathIn(item.inputs.front()));
    std::error_code error;
    const std::uintmax_t size = path.empty() ? 0 : fs::file_size(path, error);
    return program.commands[item.command].cost *
           (1 + (error ? 0 : static_cast<double>(size)) / bytesOfOne);
}

Costs Costs::fromFile(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    file.exceptions(std::ios::badbit);
    std::string line;
    if (!file || !std::getline(file, line))
        throw InputError(path + ": cannot be read; give the times.csv of an earlier batch");
    if (line != header)
        throw InputError(
            fmt::format("{}:1: the header is not '{}', that of the times.csv of a "
                        "batch",
                        path, header));
    Costs costs;
    for (std::size_t number = 2; std::getline(file, line); ++number) {
        const std::size_t a = line.find(','), b = line.find(',', a + 1), c = line.find(',', b + 1),
                          d = line.find(',', c + 1);
        double seconds = 0;
        // The time of the processor does not depend on what else the machine does.
        if (d != std::string::npos)
            std::from_chars(line.data() + d + 1, line.data() + line.size(), seconds);
        if (!(seconds > 0)) throw InputError(fmt::format("{}:{}: give {}", path, number, header));
        costs.seconds_[line.substr(0, a)] = seconds;
        for (const std::string& name :
             {line.substr(a + 1, b - a - 1), line.substr(b + 1, c - b - 1)}) {
            auto& [sum, count] = costs.classes_[name];
            sum += seconds;
            ++count;
        }
    }
    return costs;
}

}  // namespace hshfit::jobs
