#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::inline files {

/// The container of RGL `.bsdf` files (Dupuy & Jakob 2018): named arrays after a table of contents,
/// little-endian. "tensor_file\0", u8 1, u8 0, u32 number of fields; then for each field u16 length
/// of the name, name, u16 number of dimensions, u8 type, u64 offset of the data from the start of
/// the file, u64 size per dimension.
///
/// Reads from memory that has to outlive it. Everything in the table of contents is checked before
/// it is used: no size is trusted, nothing outside the bytes is read. Messages start with `source`
/// and name the field and its offset.
class TensorFile {
public:
    enum class Type : std::uint8_t { u8 = 1, i8, u16, i16, u32, i32, u64, i64, f16, f32, f64 };

    struct Field {
        std::string name;
        Type type = Type::u8;
        std::vector<std::uint64_t> shape;
        std::uint64_t offset = 0;
        std::uint64_t count = 0;  ///< product of the shape
    };

    static constexpr std::string_view magic{"tensor_file\0", 12};

    /// Throws InputError for a wrong magic or version, a table of contents that is cut off, and a
    /// field whose name is empty or doubled, whose type is unknown or whose data is not within the
    /// file.
    TensorFile(std::span<const unsigned char> bytes, std::string source);

    const std::vector<Field>& fields() const { return fields_; }
    const Field* find(std::string_view name) const;

    /// Throws InputError if there is no such field, naming those that there are.
    const Field& field(std::string_view name) const;

    /// The data of a float32 field with `dimensions` dimensions, none of them of size 0. Throws
    /// InputError if it is anything else or if one of its values is NaN or infinite.
    std::vector<float> floats(const Field& field, std::size_t dimensions) const;

    /// The bytes of a field of any type.
    std::span<const unsigned char> raw(const Field& field) const;

    /// The data of a u8 field.
    std::span<const unsigned char> octets(const Field& field) const;

    /// Throws InputError "SOURCE: field NAME (offset N): WHAT".
    [[noreturn]] void fail(const Field& field, const std::string& what) const;

private:
    std::span<const unsigned char> bytes_;
    std::string source_;
    std::vector<Field> fields_;
};

/// "f32" and the like.
std::string_view typeName(TensorFile::Type type);

/// Bytes of a number of this type.
std::size_t bytesOf(TensorFile::Type type);

/// "1 x 8 x 128".
std::string shapeText(std::span<const std::uint64_t> shape);

}  // namespace hshfit::inline files
