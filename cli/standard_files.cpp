#include "standard_files.h"

#include "option_rows.h"

#include <hshfit/error.h>
#include <hshfit/files/standard_streams.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cctype>
#include <regex>

namespace hshfit::cli {
namespace {

bool outputTaken = false;

/// "/dev/stdout.exr" for "exr:-"; any other text as it is.
std::string writtenPath(const std::string& text, const std::string& extension) {
    const std::size_t colon = text.find(':');
    const std::string before = text.substr(0, colon);
    const bool named = colon != std::string::npos && text.substr(colon) == ":-" &&
                       std::ranges::all_of(before, [](unsigned char c) { return std::isalnum(c); });
    if (text != "-" && !named) return text;
    outputTaken = true;
    return standardOutput(named ? "." + before : extension);
}

std::string folderPath(const std::string& text, const std::string& option) {
    if (text == "-")
        throw UsageError(fmt::format("{} -: several files are written; give a folder", option));
    return text;
}

std::string readPath(const std::string& text, const std::string& option) {
    if (text == "-")
        throw UsageError(fmt::format(
            "{} -: the file is read by its name, or names others beside it; give a path", option));
    return text;
}

}  // namespace

void acceptStandardStreams(CLI::App& command) {
    for (CLI::Option* option : command.get_options()) {
        const Values* row = findValues(command, *option);
        if (!row) continue;
        if (isFolder(row->files)) {
            const std::string name = option->get_name();
            option->transform([name](const std::string& text) { return folderPath(text, name); });
        } else if (row->dash && row->files == Files::read) {
            option->transform(
                [](const std::string& text) { return text == "-" ? standardInput() : text; });
        } else if (row->files == Files::read && row->syntax == Syntax::word) {
            const std::string name = option->get_name();
            option->transform([name](const std::string& text) { return readPath(text, name); });
        } else if (row->dash) {
            const std::string extension = row->dash;
            option->transform(
                [extension](const std::string& text) { return writtenPath(text, extension); });
        }
    }
}

bool isOutputTaken() {
    return outputTaken;
}

std::string withoutPathOfOutput(const std::string& text) {
    static const std::regex option("-o /dev/stdout\\.[a-z0-9]+( --force)?");
    static const std::regex path("/dev/stdout(\\.[a-z0-9]+)?");
    return std::regex_replace(std::regex_replace(text, option, "-o -"), path, "standard output");
}

}  // namespace hshfit::cli
