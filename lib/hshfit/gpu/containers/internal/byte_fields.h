#pragma once

#include <hshfit/byte_cursor.h>
#include <hshfit/error.h>
#include <hshfit/gpu/texels.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

namespace hshfit::gpu::inline containers {

/// Little-endian fields of a file in memory, and messages that name the field and where it is.
class ByteFields {
public:
    ByteFields(std::string_view bytes, const std::string& file) : bytes_(bytes), file_(file) {}

    [[noreturn]] void fail(std::string_view field, std::uint64_t offset,
                           std::string_view what) const {
        throw InputError(fmt::format("{}: {} (offset {}) {}", file_, field, offset, what));
    }
    template <class Integer>
    Integer get(std::size_t offset, std::string_view field) const {
        return *ByteCursor(part(offset, sizeof(Integer), field)).number<Integer>();
    }
    std::string_view part(std::uint64_t offset, std::uint64_t count, std::string_view field) const {
        ByteCursor cursor(bytes_);
        const auto bytes = cursor.seek(offset) ? cursor.take(count) : std::nullopt;
        if (bytes) return *bytes;
        fail(field, offset, fmt::format("has {} bytes; the file ends at {}", count, bytes_.size()));
    }
    /// Throws unless the field is `wanted`.
    void require(std::size_t offset, std::uint32_t wanted, std::string_view field) const {
        const auto value = get<std::uint32_t>(offset, field);
        if (value != wanted) {
            fail(field, offset, fmt::format("is {}; it has to be {}", value, wanted));
        }
    }

private:
    std::string_view bytes_;
    const std::string& file_;
};

/// Appends a value as it lies in memory.
template <class Value>
void put(std::string& out, Value value) {
    out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

inline std::vector<std::byte> bytesOf(std::string_view text) {
    const auto* first = reinterpret_cast<const std::byte*>(text.data());
    return {first, first + text.size()};
}
inline std::string_view textOf(const std::vector<std::byte>& bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// The number of bytes that `texels` has to have.
inline std::size_t byteCount(const Texels& texels) {
    return texels.count() * numberBytes(texels.number);
}

}  // namespace hshfit::gpu::inline containers
