#include <hshfit/byte_cursor.h>
#include <hshfit/checked_product.h>
#include <hshfit/error.h>
#include <hshfit/files/tensor_file.h>

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <unordered_set>
#include <utility>

namespace hshfit::inline files {

static_assert(std::endian::native == std::endian::little, "tensor files are little-endian");

namespace {

constexpr std::array<std::pair<std::string_view, std::size_t>, 12> types = {{{"", 0},
                                                                             {"u8", 1},
                                                                             {"i8", 1},
                                                                             {"u16", 2},
                                                                             {"i16", 2},
                                                                             {"u32", 4},
                                                                             {"i32", 4},
                                                                             {"u64", 8},
                                                                             {"i64", 8},
                                                                             {"f16", 2},
                                                                             {"f32", 4},
                                                                             {"f64", 8}}};

// Bounds of what messages show; RGL files stay far below both.
constexpr std::uint16_t maxNameLength = 255, maxDimensions = 16;

/// The table of contents, with messages that name what the file breaks off within.
class Contents {
public:
    Contents(std::span<const unsigned char> bytes, const std::string& source)
        : cursor_(std::as_bytes(bytes)), size_(bytes.size()), source_(source) {}

    template <class Value>
    Value take(std::string_view what) {
        if (const auto value = cursor_.number<Value>()) return *value;
        fail(sizeof(Value), what);
    }
    std::string_view takeText(std::size_t length, std::string_view what) {
        if (const auto text = cursor_.take(length)) return *text;
        fail(length, what);
    }
    std::size_t position() const { return cursor_.position(); }

private:
    [[noreturn]] void fail(std::size_t length, std::string_view what) const {
        throw InputError(
            fmt::format("{}: the file ends at byte {} within {} (offset {}, {} "
                        "bytes)",
                        source_, size_, what, cursor_.position(), length));
    }

    ByteCursor cursor_;
    std::size_t size_;
    const std::string& source_;
};

TensorFile::Field takeField(Contents& contents, const std::string& source, std::uint32_t index) {
    const std::string label = fmt::format("the table of contents, field {}", index);
    TensorFile::Field field;
    const std::size_t at = contents.position();
    const auto length = contents.take<std::uint16_t>(label);
    if (length > maxNameLength) {
        throw InputError(
            fmt::format("{}: the name of field {} (offset {}) has {} characters, at "
                        "most {} are read",
                        source, index, at, length, maxNameLength));
    }
    field.name = contents.takeText(length, label);
    const bool printable =
        std::ranges::all_of(field.name, [](char c) { return c > ' ' && c < 127; });
    if (field.name.empty() || !printable) {
        throw InputError(
            fmt::format("{}: the name of field {} (offset {}) is {}, expected "
                        "printable characters",
                        source, index, at, field.name.empty() ? "empty" : "not printable"));
    }
    const auto dimensions = contents.take<std::uint16_t>(label);
    if (dimensions > maxDimensions) {
        throw InputError(
            fmt::format("{}: field {} (offset {}) has {} dimensions, at most {} are "
                        "read",
                        source, field.name, at, dimensions, maxDimensions));
    }
    const auto type = contents.take<std::uint8_t>(label);
    if (type < 1 || type >= types.size()) {
        throw InputError(
            fmt::format("{}: field {} (offset {}) has the type {}, expected 1 (u8) to "
                        "11 (f64)",
                        source, field.name, at, type));
    }
    field.type = static_cast<TensorFile::Type>(type);
    field.offset = contents.take<std::uint64_t>(label);
    for (std::uint16_t i = 0; i < dimensions; ++i) {
        field.shape.push_back(contents.take<std::uint64_t>(label));
    }
    return field;
}

}  // namespace

std::size_t bytesOf(TensorFile::Type type) {
    return types[static_cast<std::size_t>(type)].second;
}

std::string_view typeName(TensorFile::Type type) {
    return types[static_cast<std::size_t>(type)].first;
}

std::string shapeText(std::span<const std::uint64_t> shape) {
    if (shape.empty()) return "scalar";
    std::string text;
    for (const std::uint64_t size : shape) {
        text += fmt::format("{}{}", text.empty() ? "" : " x ", size);
    }
    return text;
}

TensorFile::TensorFile(std::span<const unsigned char> bytes, std::string source)
    : bytes_(bytes), source_(std::move(source)) {
    Contents contents(bytes_, source_);
    if (contents.takeText(magic.size(), "the magic word") != magic) {
        throw InputError(source_ + ": does not start with \"tensor_file\"");
    }
    const auto major = contents.take<std::uint8_t>("the version");
    const auto minor = contents.take<std::uint8_t>("the version");
    if (major != 1 || minor != 0) {
        throw InputError(
            fmt::format("{}: tensor file version {}.{}, expected 1.0", source_, major, minor));
    }
    const auto number = contents.take<std::uint32_t>("the number of fields");
    std::unordered_set<std::string_view> names;
    for (std::uint32_t i = 0; i < number; ++i) {
        fields_.push_back(takeField(contents, source_, i));
    }
    for (Field& field : fields_) {
        if (!names.insert(field.name).second) fail(field, "a second field of that name");
        const auto count = checkedProduct(field.shape);
        const auto size = count ? checkedProduct({*count, bytesOf(field.type)}) : std::nullopt;
        if (!size || *size > bytes_.size() || field.offset > bytes_.size() - *size) {
            fail(field, fmt::format("{} values of type {} do not fit into the {} bytes of the file",
                                    shapeText(field.shape), typeName(field.type), bytes_.size()));
        }
        field.count = *count;
        if (*size > 0 && field.offset < contents.position()) {
            fail(field, fmt::format("the data overlaps the table of contents, which ends at {}",
                                    contents.position()));
        }
    }
}

const TensorFile::Field* TensorFile::find(std::string_view name) const {
    const auto found = std::ranges::find(fields_, name, &Field::name);
    return found == fields_.end() ? nullptr : &*found;
}

const TensorFile::Field& TensorFile::field(std::string_view name) const {
    if (const Field* found = find(name)) return *found;
    std::string known;
    for (const Field& field : fields_) {
        if (known.size() > 200) {
            known += ", ...";
            break;
        }
        known += (known.empty() ? "" : ", ") + field.name.substr(0, 40);
    }
    throw InputError(fmt::format("{}: has no field {}; it has: {}", source_, name,
                                 known.empty() ? "none" : known));
}

std::vector<float> TensorFile::floats(const Field& field, std::size_t dimensions) const {
    if (field.type != Type::f32) {
        fail(field, fmt::format("has the type {}, expected f32", typeName(field.type)));
    }
    if (field.shape.size() != dimensions || field.count == 0) {
        fail(field, fmt::format("has the shape {}, expected {} dimensions, none of them empty",
                                shapeText(field.shape), dimensions));
    }
    std::vector<float> values(field.count);
    std::memcpy(values.data(), bytes_.data() + field.offset, values.size() * sizeof(float));
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (!std::isfinite(values[i])) {
            fail(field, fmt::format("value {} (offset {}) is {}, expected a finite number", i,
                                    field.offset + i * sizeof(float), values[i]));
        }
    }
    return values;
}

std::span<const unsigned char> TensorFile::raw(const Field& field) const {
    return bytes_.subspan(field.offset, field.count * bytesOf(field.type));
}

std::span<const unsigned char> TensorFile::octets(const Field& field) const {
    if (field.type != Type::u8) {
        fail(field, fmt::format("has the type {}, expected u8", typeName(field.type)));
    }
    return bytes_.subspan(field.offset, field.count);
}

void TensorFile::fail(const Field& field, const std::string& what) const {
    throw InputError(
        fmt::format("{}: field {} (offset {}): {}", source_, field.name, field.offset, what));
}

}  // namespace hshfit::inline files
