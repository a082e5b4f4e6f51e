#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace hshfit::inline material_maps {

/// Bytes for a place in a file.
struct FilePiece {
    std::span<const std::byte> bytes = {};
    std::size_t offset = 0;
};

/// Many writes past the page cache that are handed to the kernel at once (io_submit of Linux), so
/// that the disk does not wait for a thread to be woken between two of them while all processors
/// compute. One thread at a time.
class AsyncWrites {
public:
    AsyncWrites();
    ~AsyncWrites();
    AsyncWrites(const AsyncWrites&) = delete;
    AsyncWrites& operator=(const AsyncWrites&) = delete;

    /// Returns when all are done: the bytes written of each, 0 for writes that failed or where the
    /// system has no such writes. The caller writes the rest.
    std::vector<std::size_t> write(int descriptor, std::span<const FilePiece> pieces);

private:
    unsigned long context_ = 0;
};

}  // namespace hshfit::inline material_maps
