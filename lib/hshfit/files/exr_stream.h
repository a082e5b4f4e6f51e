#pragma once

// Streams for OpenEXR: to our files and from bytes in memory. Only for sources that use OpenEXR.

#include <hshfit/files/atomic_file.h>

#include <ImfIO.h>

#include <cstdint>
#include <string_view>

namespace hshfit::inline files {

/// Writes through an AtomicFile. Throws OutputError for one that cannot be sought in (a pipe).
class ExrToFile : public Imf::OStream {
public:
    explicit ExrToFile(AtomicFile& file) : OStream("EXR file"), file_(file) {}
    void write(const char bytes[], int count) override;
    std::uint64_t tellp() override;
    void seekp(std::uint64_t position) override;

private:
    AtomicFile& file_;
};

/// Reads bytes that stay where they are. Throws std::runtime_error beyond their end, which OpenEXR
/// passes on as its own exception.
class ExrFromMemory : public Imf::IStream {
public:
    explicit ExrFromMemory(std::string_view bytes) : IStream("EXR file"), bytes_(bytes) {}
    bool read(char out[], int count) override;
    std::uint64_t tellg() override { return position_; }
    void seekg(std::uint64_t position) override { position_ = position; }

private:
    std::string_view bytes_;
    std::uint64_t position_ = 0;
};

}  // namespace hshfit::inline files
