#include "costs.h"

#include "manifest.h"
#include "program.h"

#include <hshfit/error.h>
#include <hshfit/files/checksum.h>
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

constexpr std::string_view header = "name,class,seconds,cpu_seconds,peak_bytes";

/// The extension and the size of a file, or the name of a model.
std::pair<std::string, std::uintmax_t> kindOf(const std::string& input) {
    const fs::path path(pathIn(input));
    std::error_code error;
    if (path.empty()) return {input.substr(0, input.find(':')), 0};
    const std::uintmax_t size = fs::file_size(path, error);
    return {path.extension().string(), error ? 0 : size};
}

}  // namespace

std::string classOf(const BatchItem& item, const BatchProgram& program) {
    const auto [kind, size] = kindOf(item.inputs.front());
    constexpr std::size_t digits = 12;
    const std::string options = sha256(item.options->dump()).substr(0, digits);
    const int power = size == 0 ? 0 : static_cast<int>(std::ilogb(static_cast<double>(size)));
    std::string text =
        fmt::format("{} {} {} 2^{}", program.commands[item.command].name, options, kind, power);
    for (char& c : text)
        if (c == ',' || c == '"') c = '_';
    return text;
}

double Costs::of(const BatchItem& item, const BatchProgram& program) const {
    if (item.cost > 0) return item.cost;
    if (const auto found = seconds_.find(item.name); found != seconds_.end()) return found->second;
    if (!classes_.empty()) {
        const auto found = classes_.find(classOf(item, program));
        if (found != classes_.end())
            return found->second.first / static_cast<double>(found->second.second);
    }
    // A file has to be read, whatever is done with it: 100 MB weigh as much as the work.
    constexpr double bytesOfOne = 1e8;
    const auto size = static_cast<double>(kindOf(item.inputs.front()).second);
    return program.commands[item.command].cost * (1 + size / bytesOfOne);
}

Costs Costs::fromFile(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
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
        const std::size_t a = line.find(','), b = line.find(',', a + 1), c = line.find(',', b + 1);
        double seconds = 0;
        const bool whole =
            a != std::string::npos && b != std::string::npos && c != std::string::npos;
        if (whole) std::from_chars(line.data() + b + 1, line.data() + c, seconds);
        if (!(seconds > 0)) throw InputError(fmt::format("{}:{}: give {}", path, number, header));
        costs.seconds_[line.substr(0, a)] = seconds;
        auto& [sum, count] = costs.classes_[line.substr(a + 1, b - a - 1)];
        sum += seconds;
        ++count;
    }
    return costs;
}

}  // namespace hshfit::jobs
