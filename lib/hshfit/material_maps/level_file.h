#pragma once

#include <hshfit/files/atomic_file.h>
#include <hshfit/gpu/containers/ktx2_image.h>
#include <hshfit/material_maps/texel_source.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace hshfit::inline material_maps {

class AsyncWrites;

/// The bytes of a level. Nothing for 2^62 and more, so that all levels fit one file.
std::optional<std::uint64_t> levelBytes(const LevelSize& size, std::size_t layers,
                                        gpu::Number number);

/// Settings of a LevelFile.
struct LevelFileOptions {
    std::map<std::string, std::string> pairs = {};  ///< of the head
    /// Whole pages go to the disk without a copy in the page cache, where the file system can: a
    /// file of gigabytes is neither copied nor drives other files out of memory.
    bool pastPageCache = true;
};

/// A KTX 2.0 texture array with levels, uncompressed, whose rows are written in place in any order,
/// by several processes if need be: all of them state the same sizes, and one writes the head.
/// Level 0 begins on a page.
class LevelFile {
public:
    /// `path` is a file that stands: the temporary of an AtomicFile, say.
    LevelFile(const std::string& path, gpu::Number number, std::size_t layers,
              std::vector<LevelSize> sizes, const LevelFileOptions& options = {});
    ~LevelFile();
    LevelFile(const LevelFile&) = delete;
    LevelFile& operator=(const LevelFile&) = delete;

    /// The head, and the length of the file. Throws OutputError, also where the disk is too full.
    void begin();
    /// Rows [top, top + rows) of a level, [layer][row][column] of texels. From any thread.
    /// Throws OutputError.
    void write(std::size_t level, std::size_t top, std::size_t rows,
               std::span<const std::byte> texels);

    std::size_t bytes() const { return length_; }
    std::size_t bytesOfTexel() const { return texelBytes_ * layers_; }
    const std::vector<LevelSize>& sizes() const { return sizes_; }
    /// Whether whole pages go past the page cache.
    bool isPastPageCache() const { return direct_ >= 0; }

private:
    void put(std::span<const std::byte> bytes, std::size_t offset);

    std::string path_, head_;
    int descriptor_ = -1, direct_ = -1;  ///< through and past the page cache
    std::size_t layers_, texelBytes_, length_ = 0;
    std::vector<LevelSize> sizes_;
    std::vector<std::size_t> offsets_;  ///< of levels
    std::mutex mutex_;                  ///< of writes_
    std::unique_ptr<AsyncWrites> writes_;
};

}  // namespace hshfit::inline material_maps
