#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>
#include <hshfit/files/made_from.h>
#include <hshfit/files/output_folder.h>
#include <hshfit/files/standard_streams.h>
#include <hshfit/wording.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

namespace hshfit::inline files {
namespace {

std::string folderOf(const std::string& path) {
    const std::size_t slash = path.rfind('/');
    if (slash == std::string::npos) return ".";
    return slash == 0 ? "/" : path.substr(0, slash);
}

/// The end of a chain of symbolic links, whether or not something stands there; the path itself
/// where the chain goes on for ever.
std::string endOfLinks(const std::string& path) {
    std::error_code error;
    const auto resolved = std::filesystem::canonical(path, error);
    if (!error) return resolved.string();
    std::filesystem::path at = path;
    constexpr int longest = 40;  // as in Linux
    for (int i = 0; i < longest; ++i) {
        const auto link = std::filesystem::read_symlink(at, error);
        if (error) return at.string();
        at = at.parent_path() / link;
    }
    return path;
}

bool haveSameBytes(const std::string& a, const std::string& b) {
    std::error_code error;
    const auto size = std::filesystem::file_size(a, error);
    if (error || std::filesystem::file_size(b, error) != size || error) return false;
    std::ifstream first(a, std::ios::binary), second(b, std::ios::binary);
    std::array<char, std::size_t{1} << 16> left{}, right{};
    while (first && second) {
        first.read(left.data(), left.size());
        second.read(right.data(), right.size());
        const auto count = static_cast<std::size_t>(first.gcount());
        if (!std::equal(left.begin(), left.begin() + count, right.begin())) return false;
    }
    return first.eof() && second.eof();
}

}  // namespace

AtomicFile::AtomicFile(std::string path, Existing existing)
    : path_(std::move(path)), target_(path_), existing_(existing) {
    isRuled_ = !outputRule().replace && existing != Existing::always;
    if (path_.empty()) throw OutputError("cannot write to an empty file name");
    if (isStandardOutput(path_)) {
        temporary_ = openOutputBuffer();
        stream_ = std::fopen(temporary_.c_str(), "w+e");
        if (!stream_) fail(errno);
        return;
    }
    struct stat status {};
    const bool stands = ::stat(path_.c_str(), &status) == 0;
    if (!stands && errno != ENOENT) fail(errno);
    if (!stands || S_ISREG(status.st_mode)) target_ = endOfLinks(path_);
    if (stands) {
        if (S_ISDIR(status.st_mode)) fail(EISDIR);
        if (existing_ == Existing::refuse && !isRuled_) {
            throw OutputError(fmt::format("'{}' exists; nothing is written without {}", path_,
                                          Setting{"FileSet::force"}));
        }
        if (::access(target_.c_str(), W_OK) != 0) fail(errno);
        if (!S_ISREG(status.st_mode)) {
            temporary_ = target_;
            stream_ = std::fopen(target_.c_str(), "we");
            if (!stream_) fail(errno);
            return;
        }
    }
    if (target_.back() == '/') fail(EISDIR);
    openTemporary(stands ? &status : nullptr);
}

void AtomicFile::openTemporary(const struct stat* replaced) {
    static std::atomic<unsigned> counter{0};
    constexpr mode_t permissions = 0777;
    const mode_t mode = replaced ? replaced->st_mode & permissions : 0666;
    const std::string folder = folderOf(target_);
    int descriptor = -1;
    // Names left by a killed process of the same number are stepped over.
    for (int attempt = 0; attempt < 1000 && descriptor < 0; ++attempt) {
        temporary_ = fmt::format("{}/.hshfit-{}-{}.tmp", folder, ::getpid(), counter++);
        const Uninterrupted step;
        descriptor = ::open(temporary_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC,
                            mode & 0666);
        if (descriptor >= 0) {
            trace_.file(temporary_);
        } else if (errno != EEXIST) {
            const int error = errno;
            temporary_.clear();
            fail(error);
        }
    }
    if (descriptor < 0) fail(EEXIST);
    if (replaced) {
        // Best effort: another owner needs privileges, and some file systems have none at all.
        const bool kept = ::fchown(descriptor, replaced->st_uid, replaced->st_gid) == 0 ||
                          ::fchown(descriptor, static_cast<uid_t>(-1), replaced->st_gid) == 0;
        // Rights of a group must not pass to another group.
        ::fchmod(descriptor, kept ? mode : mode & 0707);
    }
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
    if (isStandardOutput(path_)) {
        if (!temporary_.empty()) closeOutputBuffer();
    } else if (!temporary_.empty() && temporary_ != target_) {
        ::unlink(temporary_.c_str());
    }
    temporary_.clear();
    trace_.release();
}

void AtomicFile::fail(int error) const {
    if (error == ENOENT) requireOutputFolder(path_);
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

void AtomicFile::state(const std::vector<std::string>& files,
                       const std::vector<std::string>& sums) {
    finish();
    if (stated_ || key_.empty() || temporary_ == target_ || isStandardOutput(path_)) return;
    stated_ = true;
    if (canStateMadeFrom(target_))
        addMadeFrom(temporary_, {.command = outputRule().command,
                                 .key = key_,
                                 .exitCode = statedExitCode(),
                                 .files = files,
                                 .sums = sums});
}

void AtomicFile::requirePlace() {
    finish();
    if (!isRuled_ || temporary_ == target_ || isStandardOutput(path_)) return;
    std::error_code error;
    if (!std::filesystem::exists(target_, error)) return;
    standsAlready_ = haveSameBytes(temporary_, target_);
    if (standsAlready_) return;
    const auto made = madeFromOf(target_);
    if (made && !made->changed && !key_.empty() && made->key == key_) return;
    throw OutputError(
        fmt::format("'{}' exists and differs from what would be written; nothing is "
                    "written without {}",
                    path_, Setting{"FileSet::force"}));
}

/// Gives the file its name. Returns the system's error, 0 for none.
int AtomicFile::move() {
    if (isStandardOutput(path_)) return sendOutputBuffer();
    if (temporary_ == target_ || standsAlready_) return 0;
    // link() refuses an existing name, rename() replaces it; both in one step.
    const bool moved = existing_ == Existing::refuse && !isRuled_
                           ? ::link(temporary_.c_str(), target_.c_str()) == 0
                           : ::rename(temporary_.c_str(), target_.c_str()) == 0;
    return moved ? 0 : errno;
}

void AtomicFile::commit() {
    try {
        state({});
        requirePlace();
    } catch (...) {
        discard();
        throw;
    }
    finished_ = false;
    const int error = move();
    discard();
    if (error != 0) fail(error);
    if (standsAlready_) addKeptFile(path_);
}

void writeFile(const std::string& path, std::string_view text) {
    AtomicFile file(path);
    file.write(text);
    file.commit();
}

}  // namespace hshfit::inline files
