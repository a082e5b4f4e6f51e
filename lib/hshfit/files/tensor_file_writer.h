#pragma once

#include <hshfit/files/atomic_file.h>
#include <hshfit/files/tensor_file.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::inline files {

/// Collects named arrays and writes them as a tensor file (tensor_file.h), every array at a
/// multiple of 8 bytes. The arrays have to stay until `write`.
class TensorFileWriter {
public:
    void add(std::string name, TensorFile::Type type, std::vector<std::uint64_t> shape,
             std::span<const std::byte> bytes);
    void add(std::string name, std::vector<std::uint64_t> shape, std::span<const float> values);
    void add(std::string name, std::vector<std::uint64_t> shape,
             std::span<const std::uint32_t> values);
    /// Octets with one dimension.
    void add(std::string name, std::string_view octets);
    /// An array that is not in memory at once: `put` writes its bytes to the end of the file.
    void add(std::string name, TensorFile::Type type, std::vector<std::uint64_t> shape,
             std::function<void(AtomicFile&)> put);

    void write(AtomicFile& file) const;
    /// Throws OutputError if the file cannot be written or stands and is not to be replaced.
    void write(const std::string& path, AtomicFile::Existing existing) const;

private:
    struct Field {
        std::string name;
        TensorFile::Type type;
        std::vector<std::uint64_t> shape;
        std::uint64_t bytes;
        std::function<void(AtomicFile&)> put;
    };
    std::vector<Field> fields_;
};

}  // namespace hshfit::inline files
