#pragma once

#include <cstddef>
#include <cstring>
#include <optional>
#include <span>
#include <string_view>
#include <type_traits>

namespace hshfit {

/// Reads forward through bytes in memory. Every read is checked: it gives nothing, and the place
/// stays, where fewer bytes are left than it needs. Messages are the caller's, who knows the field.
class ByteCursor {
public:
    explicit ByteCursor(std::string_view bytes) : bytes_(bytes) {}
    explicit ByteCursor(std::span<const std::byte> bytes)
        : bytes_(reinterpret_cast<const char*>(bytes.data()), bytes.size()) {}

    std::size_t position() const { return position_; }
    std::size_t left() const { return bytes_.size() - position_; }
    /// False, without a move, for a place beyond the end.
    bool seek(std::size_t position) {
        if (position > bytes_.size()) return false;
        position_ = position;
        return true;
    }

    std::optional<std::string_view> take(std::size_t count) {
        if (count > left()) return std::nullopt;
        const std::string_view result = bytes_.substr(position_, count);
        position_ += count;
        return result;
    }
    /// A number in the byte order of the machine, wherever it lies.
    template <class Number>
    std::optional<Number> number() {
        static_assert(std::is_trivially_copyable_v<Number>);
        const auto raw = take(sizeof(Number));
        if (!raw) return std::nullopt;
        Number value;
        std::memcpy(&value, raw->data(), sizeof value);
        return value;
    }
    /// Text up to a 0, which is taken as well; nothing where it is longer than `longest`.
    std::optional<std::string_view> word(std::size_t longest) {
        const std::string_view rest = bytes_.substr(position_);
        const std::size_t end = rest.find('\0');
        if (end == std::string_view::npos || end > longest) return std::nullopt;
        position_ += end + 1;
        return rest.substr(0, end);
    }
    bool startsWith(char c) const { return left() > 0 && bytes_[position_] == c; }

private:
    std::string_view bytes_;
    std::size_t position_ = 0;
};

}  // namespace hshfit
