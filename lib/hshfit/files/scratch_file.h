#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::inline files {

class AtomicFile;

/// Bytes that a computation puts aside, more than memory should hold: the last of them are in
/// memory, at most `inMemory`, and the bytes before on a disk. The file has no name: it goes with
/// this object, and with the process however that ends. Where nothing exceeds `inMemory`, no file
/// is made.
///
/// Throws OutputError, with the folder and the system's reason, where the disk does not take the
/// bytes, and where it does not give them back.
class ScratchFile {
public:
    static constexpr std::size_t usualMemory = std::size_t{1} << 20;

    /// `folder`: the place of the file, as of scratchFolder().
    explicit ScratchFile(std::string folder, std::size_t inMemory = usualMemory);
    ~ScratchFile();
    ScratchFile(const ScratchFile&) = delete;
    ScratchFile& operator=(const ScratchFile&) = delete;

    /// Returns the offset of the bytes, the size before. No other member at the same time.
    std::uint64_t append(std::span<const std::byte> bytes);
    std::uint64_t append(std::string_view text);
    std::uint64_t size() const { return onDisk_ + tail_.size(); }

    /// Bytes that were appended, into `bytes`. From any thread.
    void read(std::uint64_t offset, std::span<std::byte> bytes) const;
    /// All bytes to the end of `file` or `other`.
    void copyTo(AtomicFile& file) const;
    void copyTo(ScratchFile& other) const;

private:
    void eachPart(const std::function<void(std::span<const std::byte>)>& take) const;
    void flush();
    [[noreturn]] void fail(const char* what, int error) const;

    std::string folder_;
    std::size_t inMemory_;
    std::vector<std::byte> tail_;
    std::uint64_t onDisk_ = 0;
    int descriptor_ = -1;
};

/// The folder for scratch files of a computation that writes `output`. It is the folder that the
/// environment variable TMPDIR names; without TMPDIR the folder of the output, whose disk has to
/// hold the result anyway, or the system's folder for temporary files if the output is a device or
/// the standard output.
std::string scratchFolder(const std::string& output);

}  // namespace hshfit::inline files
