#include <hshfit/files/scratch_file.h>

#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>
#include <hshfit/files/interruption.h>
#include <hshfit/files/standard_streams.h>

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

namespace hshfit::inline files {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t copiedAtOnce = std::size_t{1} << 18;

/// Calls `transfer(done)` until all `count` bytes are done; returns the system's error, 0 for none.
template <class Transfer>
int transferAll(std::size_t count, const Transfer& transfer) {
    for (std::size_t done = 0; done < count;) {
        const ssize_t now = transfer(done);
        if (now < 0 && errno == EINTR) continue;
        if (now <= 0) return now < 0 ? errno : EIO;
        done += static_cast<std::size_t>(now);
    }
    return 0;
}

/// A new file for reading and writing whose name is gone; -1 and errno on failure.
int openNameless(const std::string& folder) {
    std::string name = (fs::path(folder) / ".hshfit-XXXXXX").string();
    const Uninterrupted step;
    const int descriptor = ::mkostemp(name.data(), O_CLOEXEC);
    if (descriptor >= 0) ::unlink(name.c_str());
    return descriptor;
}

}  // namespace

ScratchFile::ScratchFile(std::string folder, std::size_t inMemory)
    : folder_(std::move(folder)), inMemory_(inMemory) {}

ScratchFile::~ScratchFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

void ScratchFile::fail(const char* what, int error) const {
    throw OutputError(fmt::format("{} {} bytes in a temporary file in '{}': {}", what, size(),
                                  folder_, std::generic_category().message(error)));
}

std::uint64_t ScratchFile::append(std::span<const std::byte> bytes) {
    const std::uint64_t offset = size();
    tail_.insert(tail_.end(), bytes.begin(), bytes.end());
    if (tail_.size() > inMemory_) flush();
    return offset;
}

std::uint64_t ScratchFile::append(std::string_view text) {
    return append(std::as_bytes(std::span(text.data(), text.size())));
}

void ScratchFile::flush() {
    if (descriptor_ < 0) descriptor_ = openNameless(folder_);
    if (descriptor_ < 0) fail("cannot keep", errno);
    const int error = transferAll(tail_.size(), [&](std::size_t done) {
        return ::pwrite(descriptor_, tail_.data() + done, tail_.size() - done,
                        static_cast<off_t>(onDisk_ + done));
    });
    if (error != 0) fail("cannot keep", error);
    onDisk_ += tail_.size();
    tail_.clear();
}

void ScratchFile::read(std::uint64_t offset, std::span<std::byte> bytes) const {
    assert(offset + bytes.size() <= size());
    const std::uint64_t left = offset < onDisk_ ? onDisk_ - offset : 0;
    const auto fromDisk = static_cast<std::size_t>(std::min<std::uint64_t>(left, bytes.size()));
    const int error = transferAll(fromDisk, [&](std::size_t done) {
        return ::pread(descriptor_, bytes.data() + done, fromDisk - done,
                       static_cast<off_t>(offset + done));
    });
    if (error != 0) fail("cannot read back", error);
    if (fromDisk == bytes.size()) return;
    std::memcpy(bytes.data() + fromDisk, tail_.data() + (offset + fromDisk - onDisk_),
                bytes.size() - fromDisk);
}

void ScratchFile::eachPart(const std::function<void(std::span<const std::byte>)>& take) const {
    std::vector<std::byte> part;
    for (std::uint64_t at = 0; at < size(); at += part.size()) {
        part.resize(static_cast<std::size_t>(std::min<std::uint64_t>(copiedAtOnce, size() - at)));
        read(at, part);
        take(part);
    }
}

void ScratchFile::copyTo(AtomicFile& file) const {
    eachPart([&](std::span<const std::byte> part) { file.write(part); });
}

void ScratchFile::copyTo(ScratchFile& other) const {
    eachPart([&](std::span<const std::byte> part) { other.append(part); });
}

std::string scratchFolder(const std::string& output) {
    if (const char* named = std::getenv("TMPDIR"); named && *named) return named;
    std::error_code error;
    const fs::file_status status = fs::status(output, error);
    if (output.empty() || isStandardOutput(output) ||
        (fs::exists(status) && !fs::is_regular_file(status)))
        return fs::temp_directory_path().string();
    const fs::path folder = fs::path(output).parent_path();
    return folder.empty() ? "." : folder.string();
}

}  // namespace hshfit::inline files
