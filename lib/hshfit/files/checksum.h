#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::inline files {

/// SHA-256 (FIPS 180-4) as 64 lower-case hexadecimal digits.
std::string sha256(std::span<const std::byte> bytes);
std::string sha256(std::string_view bytes);

/// Base64 (RFC 4648, section 4) without line breaks.
std::string base64(std::span<const std::byte> bytes);
std::string base64(std::string_view bytes);
/// The bytes again; empty if `text` is no base64 of exactly `count` bytes.
std::vector<std::byte> fromBase64(std::string_view text, std::size_t count);

}  // namespace hshfit::inline files
