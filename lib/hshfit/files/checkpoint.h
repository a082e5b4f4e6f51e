#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::inline files {

/// Finished blocks of long work in a file, so that a run that was stopped goes on.
///
/// The file is a header with the checksum of a key, and blocks, each with its own SHA-256. A
/// process may end at any moment: a block that was cut is dropped at the next opening, with all
/// after it. The key is any text that names the inputs and the options that results depend on. One
/// process at a time may have the file open. It is not synced to the disk: after a power cut the
/// last blocks may be missing, never wrong. Members may be called from several threads at once.
class Checkpoint {
public:
    /// Opens the file, or begins it where none stands. Throws InputError for a file of another key
    /// and for one that is no checkpoint, OutputError where it cannot be written or is in use.
    Checkpoint(std::string path, std::string_view key);
    /// Leaves the file, but for one without a block.
    ~Checkpoint();
    Checkpoint(const Checkpoint&) = delete;
    Checkpoint& operator=(const Checkpoint&) = delete;

    const std::string& path() const { return path_; }
    /// Kept, from earlier runs and this one.
    std::size_t blocks() const;
    /// The bytes of a block; none where it was not kept. Throws InputError if they have changed
    /// since the opening.
    std::optional<std::vector<std::byte>> block(std::uint64_t index) const;
    /// Keeps a block, in place of one of the same index. Throws OutputError, and the file is then
    /// as it was before.
    void add(std::uint64_t index, std::span<const std::byte> bytes);
    /// Removes the file: the work is complete. No other member may follow.
    void remove() noexcept;

private:
    struct Place {
        std::uint64_t offset = 0;  ///< of the block's head
        std::uint64_t size = 0;    ///< of its bytes
    };
    [[noreturn]] void fail(int error) const;
    void begin(std::string_view header);
    /// The blocks up to the first that is incomplete, where the file is cut.
    void scan(std::uint64_t length);
    std::optional<std::vector<std::byte>> read(std::uint64_t index, const Place& place) const;

    std::string path_;
    int descriptor_ = -1;
    std::uint64_t end_ = 0;
    mutable std::mutex mutex_;  ///< of the two below and of end_
    std::map<std::uint64_t, Place> places_;
};

}  // namespace hshfit::inline files
