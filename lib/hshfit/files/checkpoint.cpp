#include <hshfit/files/checkpoint.h>

#include <hshfit/error.h>
#include <hshfit/files/checksum.h>

#include <cerrno>
#include <cstring>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace hshfit::inline files {
namespace {

constexpr std::string_view opening = "hshfit-checkpoint 1\n";
constexpr std::size_t digits = 64;  // of SHA-256

/// The head in front of a block's bytes. The checksum covers index, size and bytes.
struct Head {
    std::uint64_t index = 0, size = 0;
    char checksum[digits] = {};
};
static_assert(sizeof(Head) == 16 + digits);

std::string checksumOf(std::uint64_t index, std::span<const std::byte> bytes) {
    return sha256(fmt::format("{} {} {}", index, bytes.size(), sha256(bytes)));
}

/// Fills `bytes` from the file at `offset`. False where the file ends before.
bool readAll(int descriptor, std::span<std::byte> bytes, std::uint64_t offset) {
    while (!bytes.empty()) {
        const ssize_t count =
            ::pread(descriptor, bytes.data(), bytes.size(), static_cast<off_t>(offset));
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) return false;
        bytes = bytes.subspan(static_cast<std::size_t>(count));
        offset += static_cast<std::uint64_t>(count);
    }
    return true;
}

/// 0, or the error.
int writeAll(int descriptor, std::span<const std::byte> bytes, std::uint64_t offset) {
    while (!bytes.empty()) {
        const ssize_t count =
            ::pwrite(descriptor, bytes.data(), bytes.size(), static_cast<off_t>(offset));
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) return count < 0 ? errno : EIO;
        bytes = bytes.subspan(static_cast<std::size_t>(count));
        offset += static_cast<std::uint64_t>(count);
    }
    return 0;
}

}  // namespace

Checkpoint::Checkpoint(std::string path, std::string_view key) : path_(std::move(path)) {
    descriptor_ =
        ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
    if (descriptor_ < 0) fail(errno);
    try {
        struct stat status {};
        if (::fstat(descriptor_, &status) != 0) fail(errno);
        if (!S_ISREG(status.st_mode))
            throw InputError(fmt::format("{}: is no regular file", path_));
        if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
            throw OutputError(
                fmt::format("cannot write '{}': another process is at this work", path_));
        }
        // The process before may have added to the file, or removed it, until it gave up the lock.
        if (::fstat(descriptor_, &status) != 0) fail(errno);
        if (status.st_nlink == 0)
            throw OutputError(fmt::format("cannot write '{}': another process finished", path_));
        const std::string header = std::string(opening) + sha256(key) + "\n";
        const auto length = static_cast<std::uint64_t>(status.st_size);
        std::string found(std::min<std::uint64_t>(length, header.size()), '\0');
        if (!readAll(descriptor_, std::as_writable_bytes(std::span(found)), 0)) fail(EIO);
        if (!std::string_view(found).starts_with(opening) && !opening.starts_with(found)) {
            throw InputError(fmt::format(
                "{}: is no file of finished work; remove it, or write elsewhere", path_));
        }
        if (found.size() < header.size())
            begin(header);
        else if (found == header)
            scan(length);
        else
            throw InputError(
                fmt::format("{}: keeps work on other inputs or with other options; give the same "
                            "again, or remove it",
                            path_));
    } catch (...) {
        ::close(descriptor_);
        throw;
    }
}

Checkpoint::~Checkpoint() {
    if (descriptor_ < 0) return;
    if (places_.empty()) ::unlink(path_.c_str());
    ::close(descriptor_);
}

void Checkpoint::fail(int error) const {
    throw OutputError(
        fmt::format("cannot write '{}': {}", path_, std::generic_category().message(error)));
}

void Checkpoint::begin(std::string_view header) {
    if (::ftruncate(descriptor_, 0) != 0) fail(errno);
    const int error = writeAll(descriptor_, std::as_bytes(std::span(header)), 0);
    if (error != 0) fail(error);
    end_ = header.size();
}

void Checkpoint::scan(std::uint64_t length) {
    end_ = opening.size() + digits + 1;
    while (length - end_ >= sizeof(Head)) {
        Head head;
        if (!readAll(descriptor_, std::as_writable_bytes(std::span(&head, 1)), end_)) fail(EIO);
        if (head.size > length - end_ - sizeof(Head)) break;
        const Place place{end_, head.size};
        if (!read(head.index, place)) break;
        places_.insert_or_assign(head.index, place);
        end_ += sizeof(Head) + head.size;
    }
    if (end_ < length && ::ftruncate(descriptor_, static_cast<off_t>(end_)) != 0) fail(errno);
}

std::optional<std::vector<std::byte>> Checkpoint::read(std::uint64_t index,
                                                       const Place& place) const {
    Head head;
    std::vector<std::byte> bytes(place.size);
    if (!readAll(descriptor_, std::as_writable_bytes(std::span(&head, 1)), place.offset) ||
        !readAll(descriptor_, bytes, place.offset + sizeof(Head)) || head.index != index ||
        head.size != place.size ||
        std::string_view(head.checksum, digits) != checksumOf(index, bytes)) {
        return std::nullopt;
    }
    return bytes;
}

std::size_t Checkpoint::blocks() const {
    const std::lock_guard lock(mutex_);
    return places_.size();
}

std::optional<std::vector<std::byte>> Checkpoint::block(std::uint64_t index) const {
    Place place;
    {
        const std::lock_guard lock(mutex_);
        const auto found = places_.find(index);
        if (found == places_.end()) return std::nullopt;
        place = found->second;
    }
    auto bytes = read(index, place);
    if (!bytes) throw InputError(fmt::format("{}: was written to by something else", path_));
    return bytes;
}

void Checkpoint::add(std::uint64_t index, std::span<const std::byte> bytes) {
    Head head{.index = index, .size = bytes.size()};
    const std::string checksum = checksumOf(index, bytes);
    std::memcpy(head.checksum, checksum.data(), digits);
    std::vector<std::byte> whole(sizeof(Head) + bytes.size());
    std::memcpy(whole.data(), &head, sizeof head);
    if (!bytes.empty()) std::memcpy(whole.data() + sizeof head, bytes.data(), bytes.size());
    const std::lock_guard lock(mutex_);
    const int error = writeAll(descriptor_, whole, end_);
    if (error != 0) {
        // A part of the block is dropped at the next opening if it cannot be dropped here.
        [[maybe_unused]] const int cut = ::ftruncate(descriptor_, static_cast<off_t>(end_));
        fail(error);
    }
    places_.insert_or_assign(index, Place{end_, bytes.size()});
    end_ += whole.size();
}

void Checkpoint::remove() noexcept {
    ::unlink(path_.c_str());
    ::close(descriptor_);
    descriptor_ = -1;
}

}  // namespace hshfit::inline files
