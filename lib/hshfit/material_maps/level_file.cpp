#include <hshfit/material_maps/level_file.h>

#include <hshfit/error.h>

#include <fmt/format.h>

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <unistd.h>

namespace hshfit::inline material_maps {

LevelFile::LevelFile(const std::string& path, gpu::Number number, std::size_t layers,
                     std::vector<LevelSize> sizes, std::map<std::string, std::string> pairs)
    : path_(path),
      layers_(layers),
      texelBytes_(4 * gpu::numberBytes(number)),
      sizes_(std::move(sizes)) {
    gpu::Ktx2Image image{.number = number,
                         .width = sizes_.front().width,
                         .height = sizes_.front().height,
                         .layers = layers,
                         .pairs = std::move(pairs)};
    for (const LevelSize& size : sizes_) {
        const std::size_t bytes = size.width * size.height * layers_ * texelBytes_;
        image.levels.push_back({bytes, bytes});
    }
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
}

LevelFile::~LevelFile() {
    ::close(descriptor_);
}

void LevelFile::begin() {
    if (::ftruncate(descriptor_, static_cast<off_t>(length_)) != 0)
        throw OutputError(fmt::format("{}: {}", path_, std::strerror(errno)));
    put(std::as_bytes(std::span(head_)), 0);
}

void LevelFile::write(std::size_t level, std::size_t top, std::size_t rows,
                      std::span<const std::byte> texels) {
    const LevelSize& size = sizes_[level];
    const std::size_t row = size.width * texelBytes_;
    for (std::size_t layer = 0; layer < layers_; ++layer) {
        put(texels.subspan(layer * rows * row, rows * row),
            offsets_[level] + (layer * size.height + top) * row);
    }
}

void LevelFile::put(std::span<const std::byte> bytes, std::size_t offset) {
    while (!bytes.empty()) {
        const ssize_t done =
            ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
        if (done < 0 && errno == EINTR) continue;
        if (done <= 0) throw OutputError(fmt::format("{}: {}", path_, std::strerror(errno)));
        bytes = bytes.subspan(static_cast<std::size_t>(done));
        offset += static_cast<std::size_t>(done);
    }
}

}  // namespace hshfit::inline material_maps
