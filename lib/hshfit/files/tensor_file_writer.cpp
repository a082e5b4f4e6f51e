#include <hshfit/files/tensor_file_writer.h>

#include <cassert>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>

namespace hshfit::inline files {
namespace {

constexpr std::uint64_t alignment = 8;

std::uint64_t aligned(std::uint64_t offset) {
    return (offset + alignment - 1) / alignment * alignment;
}

template <class Value>
void append(std::string& out, Value value) {
    out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::uint64_t countOf(const std::vector<std::uint64_t>& shape) {
    return std::accumulate(shape.begin(), shape.end(), std::uint64_t{1}, std::multiplies<>());
}

}  // namespace

void TensorFileWriter::add(std::string name, TensorFile::Type type,
                           std::vector<std::uint64_t> shape, std::function<void(AtomicFile&)> put) {
    const std::uint64_t bytes = countOf(shape) * bytesOf(type);
    fields_.push_back({std::move(name), type, std::move(shape), bytes, std::move(put)});
}

void TensorFileWriter::add(std::string name, TensorFile::Type type,
                           std::vector<std::uint64_t> shape, std::span<const std::byte> bytes) {
    assert(countOf(shape) * bytesOf(type) == bytes.size());
    add(std::move(name), type, std::move(shape), [bytes](AtomicFile& file) { file.write(bytes); });
}

void TensorFileWriter::add(std::string name, std::vector<std::uint64_t> shape,
                           std::span<const float> values) {
    add(std::move(name), TensorFile::Type::f32, std::move(shape), std::as_bytes(values));
}

void TensorFileWriter::add(std::string name, std::vector<std::uint64_t> shape,
                           std::span<const std::uint32_t> values) {
    add(std::move(name), TensorFile::Type::u32, std::move(shape), std::as_bytes(values));
}

void TensorFileWriter::add(std::string name, std::string_view octets) {
    add(std::move(name), TensorFile::Type::u8, {octets.size()},
        std::as_bytes(std::span(octets.data(), octets.size())));
}

void TensorFileWriter::write(AtomicFile& file) const {
    constexpr std::size_t headBytes = TensorFile::magic.size() + 2 + sizeof(std::uint32_t);
    std::uint64_t offset = headBytes;
    for (const Field& field : fields_) {
        offset += 2 + field.name.size() + 2 + 1 + 8 + 8 * field.shape.size();
    }
    std::string head(TensorFile::magic);
    append(head, std::uint8_t{1});
    append(head, std::uint8_t{0});
    append(head, static_cast<std::uint32_t>(fields_.size()));
    for (const Field& field : fields_) {
        assert(field.name.size() <= std::numeric_limits<std::uint16_t>::max());
        offset = aligned(offset);
        append(head, static_cast<std::uint16_t>(field.name.size()));
        head += field.name;
        append(head, static_cast<std::uint16_t>(field.shape.size()));
        append(head, static_cast<std::uint8_t>(field.type));
        append(head, offset);
        for (const std::uint64_t size : field.shape) append(head, size);
        offset += field.bytes;
    }

    file.write(head);
    std::uint64_t position = head.size();
    for (const Field& field : fields_) {
        file.write(std::string(aligned(position) - position, '\0'));
        field.put(file);
        position = aligned(position) + field.bytes;
    }
}

void TensorFileWriter::write(const std::string& path, AtomicFile::Existing existing) const {
    AtomicFile file(path, existing);
    write(file);
    file.commit();
}

}  // namespace hshfit::inline files
