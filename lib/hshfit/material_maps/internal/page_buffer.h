#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <span>

#include <sys/mman.h>

namespace hshfit::inline material_maps {

/// Bytes without initial values that begin on a page, as writes past the page cache need them; on
/// large pages where there are any, which the kernel pins and hands to the disk in fewer pieces.
class PageBuffer {
public:
    static constexpr std::size_t page = 4096;

    /// Makes room for at least so many bytes. The content is lost if the buffer grows.
    void reserve(std::size_t bytes) {
        if (bytes <= size_) return;
        bytes_.reset();
        bytes_.reset(static_cast<std::byte*>(::operator new(bytes, largePage)));
#ifdef MADV_HUGEPAGE
        ::madvise(bytes_.get(), bytes, MADV_HUGEPAGE);
#endif
        size_ = bytes;
    }
    std::byte* data() {
        return bytes_.get();
    }
    std::span<const std::byte> first(std::size_t bytes) const {
        return {bytes_.get(), bytes};
    }

private:
    static constexpr std::align_val_t largePage{std::size_t{1} << 21};
    struct Free {
        void operator()(std::byte* bytes) const { ::operator delete(bytes, largePage); }
    };
    std::unique_ptr<std::byte, Free> bytes_;
    std::size_t size_ = 0;
};

}  // namespace hshfit::inline material_maps
