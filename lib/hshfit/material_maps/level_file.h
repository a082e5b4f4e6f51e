#pragma once

#include <hshfit/files/atomic_file.h>
#include <hshfit/gpu/containers/ktx2_image.h>
#include <hshfit/material_maps/texel_source.h>

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace hshfit::inline material_maps {

/// A KTX 2.0 texture array with levels, uncompressed, whose rows are written in place in any order,
/// by several processes if need be: all of them state the same sizes, and one writes the head.
class LevelFile {
public:
    /// `path` is a file that stands: the temporary of an AtomicFile, say. `pairs` go into the head.
    LevelFile(const std::string& path, gpu::Number number, std::size_t layers,
              std::vector<LevelSize> sizes, std::map<std::string, std::string> pairs = {});
    ~LevelFile();
    LevelFile(const LevelFile&) = delete;
    LevelFile& operator=(const LevelFile&) = delete;

    /// The head, and the length of the file.
    void begin();
    /// Rows [top, top + rows) of a level, [layer][row][column] of texels. From any thread.
    /// Throws OutputError.
    void write(std::size_t level, std::size_t top, std::size_t rows,
               std::span<const std::byte> texels);

    std::size_t bytes() const { return length_; }
    std::size_t bytesOfTexel() const { return texelBytes_ * layers_; }
    const std::vector<LevelSize>& sizes() const { return sizes_; }

private:
    void put(std::span<const std::byte> bytes, std::size_t offset);

    std::string path_, head_;
    int descriptor_ = -1;
    std::size_t layers_, texelBytes_, length_ = 0;
    std::vector<LevelSize> sizes_;
    std::vector<std::size_t> offsets_;  ///< of levels
};

}  // namespace hshfit::inline material_maps
