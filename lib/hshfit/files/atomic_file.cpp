#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

namespace hshfit::inline files {
namespace {

// Paths that a signal handler is to unlink. The function that swaps a pointer out of its slot owns
// it: the handler unlinks and never frees, removePath frees.
std::array<std::atomic<char*>, 64> temporaries{};
static_assert(std::atomic<char*>::is_always_lock_free);

int addPath(const std::string& path) {
    char* copy = ::strdup(path.c_str());
    for (std::size_t i = 0; copy && i < temporaries.size(); ++i) {
        char* empty = nullptr;
        if (temporaries[i].compare_exchange_strong(empty, copy)) return static_cast<int>(i);
    }
    std::free(copy);
    return -1;  // more files open than slots: this one only loses its cover against signals
}

void removePath(int slot) noexcept {
    if (slot >= 0) std::free(temporaries[static_cast<std::size_t>(slot)].exchange(nullptr));
}

extern "C" void unlinkTemporariesAndDie(int signal) {
    for (auto& slot : temporaries) {
        if (const char* path = slot.exchange(nullptr)) ::unlink(path);
    }
    // SA_RESETHAND has restored the default action, which runs once this handler returns.
    ::raise(signal);
}

std::string folderOf(const std::string& path) {
    const std::size_t slash = path.rfind('/');
    if (slash == std::string::npos) return ".";
    return slash == 0 ? "/" : path.substr(0, slash);
}

}  // namespace

AtomicFile::AtomicFile(std::string path, Existing existing)
    : path_(std::move(path)), target_(path_), existing_(existing) {
    if (path_.empty()) throw OutputError("cannot write to an empty file name");
    std::error_code error;
    const auto resolved = std::filesystem::canonical(path_, error);
    if (!error) target_ = resolved.string();

    struct stat status {};
    if (::stat(target_.c_str(), &status) == 0) {
        if (S_ISDIR(status.st_mode)) fail(EISDIR);
        if (existing_ == Existing::refuse) fail(EEXIST);
        if (::access(target_.c_str(), W_OK) != 0) fail(errno);
        if (!S_ISREG(status.st_mode)) {
            temporary_ = target_;
            stream_ = std::fopen(target_.c_str(), "we");
            if (!stream_) fail(errno);
            return;
        }
    } else if (errno != ENOENT) {
        fail(errno);
    }
    if (target_.back() == '/') fail(EISDIR);
    openTemporary(folderOf(target_));
}

void AtomicFile::openTemporary(const std::string& folder) {
    static std::atomic<unsigned> counter{0};
    int descriptor = -1;
    // Names left by a killed process of the same number are stepped over.
    for (int attempt = 0; attempt < 1000 && descriptor < 0; ++attempt) {
        temporary_ = fmt::format("{}/.hshfit-{}-{}.tmp", folder, ::getpid(), counter++);
        registration_ = addPath(temporary_);
        descriptor =
            ::open(temporary_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
        if (descriptor < 0) {
            const int error = errno;
            removePath(registration_);
            registration_ = -1;
            if (error != EEXIST) fail(error);
        }
    }
    if (descriptor < 0) fail(EEXIST);
    stream_ = ::fdopen(descriptor, "w+");
    if (!stream_) {
        const int error = errno;
        ::close(descriptor);
        discard();
        fail(error);
    }
}

AtomicFile::~AtomicFile() {
    discard();
}

void AtomicFile::discard() noexcept {
    if (stream_) std::fclose(stream_);
    stream_ = nullptr;
    if (!temporary_.empty() && temporary_ != target_) ::unlink(temporary_.c_str());
    temporary_.clear();
    removePath(registration_);
    registration_ = -1;
}

void AtomicFile::fail(int error) const {
    throw OutputError(
        fmt::format("cannot write '{}': {}", path_, std::generic_category().message(error)));
}

void AtomicFile::write(std::string_view text) {
    if (!stream_) fail(EBADF);
    errno = 0;
    if (std::fwrite(text.data(), 1, text.size(), stream_) != text.size()) {
        fail(errno != 0 ? errno : EIO);
    }
}

void AtomicFile::write(std::span<const std::byte> bytes) {
    write(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

void AtomicFile::finish() {
    if (finished_) return;
    if (!stream_) fail(EBADF);
    errno = 0;
    const bool failedBefore = std::ferror(stream_) != 0;
    const bool flushed = std::fflush(stream_) == 0;
    int error = flushed && !failedBefore ? 0 : (errno != 0 ? errno : EIO);
    if (std::fclose(stream_) != 0 && error == 0) error = errno;
    stream_ = nullptr;
    if (error != 0) {
        discard();
        fail(error);
    }
    finished_ = true;
}

void AtomicFile::commit() {
    finish();
    finished_ = false;
    int error = 0;
    if (temporary_ != target_) {
        // link() refuses an existing name, rename() replaces it; both in one step.
        const bool moved = existing_ == Existing::refuse
                               ? ::link(temporary_.c_str(), target_.c_str()) == 0
                               : ::rename(temporary_.c_str(), target_.c_str()) == 0;
        if (!moved) error = errno;
    }
    discard();
    if (error != 0) fail(error);
}

void writeFile(const std::string& path, std::string_view text) {
    AtomicFile file(path);
    file.write(text);
    file.commit();
}

void removeTemporariesOnSignals() {
    struct sigaction action {};
    action.sa_handler = unlinkTemporariesAndDie;
    action.sa_flags = SA_RESETHAND;
    sigemptyset(&action.sa_mask);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE}) {
        struct sigaction previous {};
        // A signal that the parent ignores (nohup) stays ignored.
        if (::sigaction(signal, nullptr, &previous) == 0 && previous.sa_handler == SIG_IGN) {
            continue;
        }
        ::sigaction(signal, &action, nullptr);
    }
    std::signal(SIGXFSZ, SIG_IGN);
}

}  // namespace hshfit::inline files
