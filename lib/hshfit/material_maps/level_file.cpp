#include <hshfit/material_maps/level_file.h>

#include <hshfit/checked_product.h>
#include <hshfit/error.h>
#include <hshfit/material_maps/internal/async_writes.h>
#include <hshfit/material_maps/internal/page_buffer.h>

#include <fmt/format.h>

#include <cerrno>
#include <cstdint>
#include <cstring>

#include <fcntl.h>
#include <unistd.h>

namespace hshfit::inline material_maps {
namespace {

/// Lengthens the head by an entry without meaning until what follows ends on a page.
constexpr const char* paddingKey = "hshfit:padding";

bool isWholePages(std::span<const std::byte> bytes, std::size_t offset) {
    return (reinterpret_cast<std::uintptr_t>(bytes.data()) | bytes.size() | offset) %
               PageBuffer::page ==
           0;
}

}  // namespace

std::optional<std::uint64_t> levelBytes(const LevelSize& size, std::size_t layers,
                                        gpu::Number number) {
    const auto bytes =
        checkedProduct({size.width, size.height, layers, 4, gpu::numberBytes(number)});
    return bytes && *bytes >> 62 == 0 ? bytes : std::nullopt;
}

LevelFile::LevelFile(const std::string& path, gpu::Number number, std::size_t layers,
                     std::vector<LevelSize> sizes, const LevelFileOptions& options)
    : path_(path),
      layers_(layers),
      texelBytes_(4 * gpu::numberBytes(number)),
      sizes_(std::move(sizes)),
      writes_(std::make_unique<AsyncWrites>()) {
    gpu::Ktx2Image image{.number = number,
                         .width = sizes_.front().width,
                         .height = sizes_.front().height,
                         .layers = layers,
                         .pairs = options.pairs};
    std::size_t below = 0;  // bytes of the levels before level 0
    for (const LevelSize& size : sizes_) {
        const auto bytes = levelBytes(size, layers_, number);
        if (!bytes) {
            throw OutputError(
                fmt::format("{}: {} x {} texels in {} layers are more than a file holds", path_,
                            size.width, size.height, layers_));
        }
        image.levels.push_back({*bytes, *bytes});
        below += *bytes;
    }
    below -= image.levels.front().stored;
    image.pairs[paddingKey] = "";
    const std::size_t before = gpu::ktx2Head(image).size() + below;
    image.pairs[paddingKey].resize(
        (PageBuffer::page - before % PageBuffer::page) % PageBuffer::page, ' ');
    head_ = gpu::ktx2Head(image);
    // The smallest level comes first, each where the one before it ends: they are whole texels.
    offsets_.resize(sizes_.size());
    length_ = head_.size();
    for (std::size_t level = sizes_.size(); level-- > 0;) {
        offsets_[level] = length_;
        length_ += image.levels[level].stored;
    }
    descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CLOEXEC);
    if (descriptor_ < 0) throw OutputError(fmt::format("{}: {}", path_, std::strerror(errno)));
#ifdef O_DIRECT
    // A file system without such writes refuses here.
    if (options.pastPageCache) direct_ = ::open(path_.c_str(), O_WRONLY | O_CLOEXEC | O_DIRECT);
#endif
}

LevelFile::~LevelFile() {
    ::close(descriptor_);
    if (direct_ >= 0) ::close(direct_);
}

void LevelFile::begin() {
    const auto length = static_cast<off_t>(length_);
    int failed = ::ftruncate(descriptor_, length) == 0 ? 0 : errno;
#ifdef FALLOC_FL_KEEP_SIZE
    // Several writers wait for each other where room has to be found first. Unlike
    // posix_fallocate, this writes nothing where the file system has no such call.
    if (failed == 0 && ::fallocate(descriptor_, 0, 0, length) != 0 &&
        (errno == ENOSPC || errno == EFBIG || errno == EDQUOT))
        failed = errno;
#endif
    if (failed != 0) {
        throw OutputError(
            fmt::format("{}: no room for {} bytes: {}", path_, length_, std::strerror(failed)));
    }
    put(std::as_bytes(std::span(head_)), 0);
}

void LevelFile::write(std::size_t level, std::size_t top, std::size_t rows,
                      std::span<const std::byte> texels) {
    const LevelSize& size = sizes_[level];
    const std::size_t row = size.width * texelBytes_;
    std::vector<FilePiece> pieces, whole;
    for (std::size_t layer = 0; layer < layers_; ++layer) {
        const FilePiece piece{texels.subspan(layer * rows * row, rows * row),
                              offsets_[level] + (layer * size.height + top) * row};
        const bool past = direct_ >= 0 && isWholePages(piece.bytes, piece.offset);
        (past ? whole : pieces).push_back(piece);
    }
    if (!whole.empty()) {
        const std::lock_guard lock(mutex_);
        const std::vector<std::size_t> written = writes_->write(direct_, whole);
        for (std::size_t k = 0; k < whole.size(); ++k) {
            pieces.push_back({whole[k].bytes.subspan(written[k]), whole[k].offset + written[k]});
        }
    }
    for (const FilePiece& piece : pieces) put(piece.bytes, piece.offset);
}

void LevelFile::put(std::span<const std::byte> bytes, std::size_t offset) {
    while (!bytes.empty()) {
        const bool past = direct_ >= 0 && isWholePages(bytes, offset);
        ssize_t done = ::pwrite(past ? direct_ : descriptor_, bytes.data(), bytes.size(),
                                static_cast<off_t>(offset));
        // A device with larger blocks than pages refuses.
        if (done < 0 && past && errno == EINVAL) {
            done = ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
        }
        if (done < 0 && errno == EINTR) continue;
        if (done <= 0) throw OutputError(fmt::format("{}: {}", path_, std::strerror(errno)));
        bytes = bytes.subspan(static_cast<std::size_t>(done));
        offset += static_cast<std::size_t>(done);
    }
}

}  // namespace hshfit::inline material_maps
