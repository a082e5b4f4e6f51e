#include <hshfit/error.h>
#include <hshfit/files/standard_streams.h>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <system_error>

namespace hshfit::inline files {
namespace {

constexpr std::string_view outputPath = "/dev/stdout";

/// The descriptor of the file in memory; -1 if there is none.
std::atomic<int> outputBuffer = -1;

/// Writes all of `bytes`. Returns the system's error.
int writeAll(int descriptor, const char* bytes, std::size_t count) noexcept {
    while (count > 0) {
        const ssize_t written = ::write(descriptor, bytes, count);
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) return errno;
        bytes += written;
        count -= static_cast<std::size_t>(written);
    }
    return 0;
}

/// Copies what is left in `from`. Returns the system's error.
int copyAll(int from, int to) noexcept {
    char block[1 << 16];
    while (true) {
        const ssize_t count = ::read(from, block, sizeof block);
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) return errno;
        if (count == 0) return 0;
        if (const int error = writeAll(to, block, static_cast<std::size_t>(count))) return error;
    }
}

[[noreturn]] void failInput(const std::string& reason) {
    throw InputError(fmt::format("standard input: {}", reason));
}

std::string messageOf(int error) {
    return std::generic_category().message(error);
}

/// Puts a file in memory in the place of standard input, with all that comes from it.
void keepInput() {
    const int memory = ::memfd_create("standard input", MFD_CLOEXEC);
    if (memory < 0) failInput(messageOf(errno));
    int error = copyAll(STDIN_FILENO, memory);
    if (error == 0 && ::dup2(memory, STDIN_FILENO) < 0) error = errno;
    ::close(memory);
    if (error != 0) failInput(messageOf(error));
}

}  // namespace

std::string standardInput() {
    struct stat status {};
    if (::isatty(STDIN_FILENO)) failInput("is a terminal; give a file or a pipe");
    if (::fstat(STDIN_FILENO, &status) != 0) failInput(messageOf(errno));
    if (!S_ISREG(status.st_mode)) keepInput();
    if (::fstat(STDIN_FILENO, &status) != 0) failInput(messageOf(errno));
    if (status.st_size == 0) failInput("is empty");
    return std::string(standardInputPath);
}

std::string standardOutput(std::string_view extension) {
    return fmt::format("{}{}", outputPath, extension);
}

bool isStandardOutput(std::string_view path) {
    if (!path.starts_with(outputPath)) return false;
    return path.size() == outputPath.size() || path[outputPath.size()] == '.';
}

std::string openOutputBuffer() {
    const int memory = ::memfd_create("standard output", MFD_CLOEXEC);
    int none = -1;
    if (memory >= 0 && outputBuffer.compare_exchange_strong(none, memory))
        return fmt::format("/proc/{}/fd/{}", ::getpid(), memory);
    const std::string reason = memory < 0 ? messageOf(errno) : "two files cannot both go there";
    if (memory >= 0) ::close(memory);
    throw OutputError(fmt::format("standard output: {}", reason));
}

int sendOutputBuffer() noexcept {
    const int memory = outputBuffer;
    if (::lseek(memory, 0, SEEK_SET) != 0) return errno;
    return copyAll(memory, STDOUT_FILENO);
}

void closeOutputBuffer() noexcept {
    const int memory = outputBuffer.exchange(-1);
    if (memory >= 0) ::close(memory);
}

}  // namespace hshfit::inline files
