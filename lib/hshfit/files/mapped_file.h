#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace hshfit::inline files {

/// A file mapped into memory for reading: only the pages that are touched are read.
///
/// Pages that vanish because somebody truncates the file would end the process with SIGBUS. The
/// first MappedFile installs a handler that puts a page of zeros in the place of a lost page of one
/// of our maps, marks that map, and passes every other SIGBUS on to the handler before it. So the
/// values read after a loss are zeros: call checkIntact() once they have been used, and throw them
/// away if it throws. At most `maxOpen` files can be mapped at once.
class MappedFile {
public:
    static constexpr int maxOpen = 256;

    /// Throws InputError if `path` is absent, unreadable, empty, or not a regular file.
    explicit MappedFile(std::string path);
    ~MappedFile();
    MappedFile(const MappedFile&) = delete;
    MappedFile& operator=(const MappedFile&) = delete;

    const std::string& path() const { return path_; }
    std::size_t size() const { return size_; }
    const unsigned char* data() const { return data_; }
    std::span<const unsigned char> bytes() const { return {data_, size_}; }

    /// Lets go of the memory of pages that were read; they are read again when they are touched.
    void releasePages() const;

    /// Throws InputError if a page was lost, or if the file is shorter than when it was opened or
    /// was written to since then. From any thread.
    void checkIntact() const;

private:
    std::string path_;
    int descriptor_ = -1;
    int slot_ = -1;  ///< in the handler's registry
    std::size_t size_ = 0;
    const unsigned char* data_ = nullptr;
    std::int64_t modifiedSeconds_ = 0, modifiedNanoseconds_ = 0;
};

}  // namespace hshfit::inline files
