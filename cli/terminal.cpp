#include "terminal.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <string_view>

namespace hshfit::cli {
namespace {

constexpr std::size_t least = 40;

std::string_view variable(const char* name) {
    const char* value = std::getenv(name);
    return value ? value : "";
}

/// 0 if COLUMNS is no number above 0.
std::size_t statedColumns() {
    const std::string_view text = variable("COLUMNS");
    std::size_t count = 0;
    const auto parsed = std::from_chars(text.data(), text.data() + text.size(), count);
    return parsed.ec == std::errc() && parsed.ptr == text.data() + text.size() ? count : 0;
}

int descriptorOf(Stream stream) {
    return stream == Stream::output ? STDOUT_FILENO : STDERR_FILENO;
}

/// 0 if standard output is no terminal, or one that does not know its size.
std::size_t terminalColumns(Stream stream = Stream::output) {
    winsize size{};
    return ::ioctl(descriptorOf(stream), TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}

}  // namespace

std::optional<std::size_t> terminalWidth(Stream stream) {
    const std::size_t count = terminalColumns(stream);
    return count == 0 ? std::nullopt : std::optional(std::max(count, least));
}

std::size_t columns() {
    constexpr std::size_t usual = 80, most = 100;
    std::size_t count = statedColumns();
    if (count == 0) count = terminalColumns();
    return count == 0 ? usual : std::clamp(count, least, most);
}

std::optional<std::size_t> tableColumns() {
    std::size_t count = statedColumns();
    if (count == 0) count = terminalColumns();
    return count == 0 ? std::nullopt : std::optional(std::max(count, least));
}

bool hasColour(Stream stream) {
    return variable("NO_COLOR").empty() && variable("TERM") != "dumb" &&
           ::isatty(descriptorOf(stream)) == 1;
}

}  // namespace hshfit::cli
