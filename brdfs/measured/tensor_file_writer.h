#pragma once

#include <brdfs/measured/tensor_file.h>
#include <hshfit/output/atomic_file.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::brdfs {

/// Collects named arrays and writes them as a tensor file (tensor_file.h), every array at a
/// multiple of 8 bytes. The arrays have to stay until `write`.
class TensorFileWriter {
public:
    void add(std::string name, std::vector<std::uint64_t> shape, std::span<const float> values);
    void add(std::string name, std::vector<std::uint64_t> shape,
             std::span<const std::uint32_t> values);
    /// Octets with one dimension.
    void add(std::string name, std::string_view octets);

    /// Throws OutputError if the file cannot be written or stands and is not to be replaced.
    void write(const std::string& path, AtomicFile::Existing existing) const;

private:
    struct Field {
        std::string name;
        TensorFile::Type type;
        std::vector<std::uint64_t> shape;
        std::span<const std::byte> bytes;
    };
    std::vector<Field> fields_;
};

}  // namespace hshfit::brdfs
