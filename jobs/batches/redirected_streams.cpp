#include "redirected_streams.h"

#include <hshfit/error.h>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

namespace hshfit::jobs {

namespace {

int take(int stream, const std::filesystem::path& path) {
    const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (file < 0) throw OutputError(fmt::format("{}: {}", path.string(), std::strerror(errno)));
    const int kept = ::fcntl(stream, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    ::dup2(file, stream);
    ::close(file);
    return kept;
}

void giveBack(int stream, int kept) {
    std::fflush(stream == STDOUT_FILENO ? stdout : stderr);
    ::dup2(kept, stream);
    ::close(kept);
}

}  // namespace

RedirectedStreams::RedirectedStreams(const std::filesystem::path& output,
                                     const std::filesystem::path& error)
    : output_(take(STDOUT_FILENO, output)), error_(take(STDERR_FILENO, error)) {}

RedirectedStreams::~RedirectedStreams() {
    giveBack(STDOUT_FILENO, output_);
    giveBack(STDERR_FILENO, error_);
}

}  // namespace hshfit::jobs
