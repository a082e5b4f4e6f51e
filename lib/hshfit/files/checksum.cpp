#include <hshfit/files/checksum.h>

#include <array>
#include <cstdint>

#include <fmt/format.h>
#include <nettle/base64.h>
#include <nettle/sha2.h>

namespace hshfit::inline files {

std::string sha256(std::span<const std::byte> bytes) {
    sha256_ctx context;
    sha256_init(&context);
    sha256_update(&context, bytes.size(), reinterpret_cast<const std::uint8_t*>(bytes.data()));
    std::array<std::uint8_t, SHA256_DIGEST_SIZE> digest;
    sha256_digest(&context, digest.size(), digest.data());
    std::string text;
    for (const std::uint8_t octet : digest) text += fmt::format("{:02x}", octet);
    return text;
}

std::string sha256(std::string_view bytes) {
    return sha256(std::as_bytes(std::span(bytes.data(), bytes.size())));
}

std::string base64(std::string_view bytes) {
    return base64(std::as_bytes(std::span(bytes.data(), bytes.size())));
}

std::string base64(std::span<const std::byte> bytes) {
    std::string text(BASE64_ENCODE_RAW_LENGTH(bytes.size()), '\0');
    base64_encode_raw(text.data(), bytes.size(),
                      reinterpret_cast<const std::uint8_t*>(bytes.data()));
    return text;
}

std::vector<std::byte> fromBase64(std::string_view text, std::size_t count) {
    if (text.size() != BASE64_ENCODE_RAW_LENGTH(count)) return {};
    std::vector<std::byte> bytes(BASE64_DECODE_LENGTH(text.size()));
    base64_decode_ctx context;
    base64_decode_init(&context);
    std::size_t length = bytes.size();
    const bool valid =
        base64_decode_update(&context, &length, reinterpret_cast<std::uint8_t*>(bytes.data()),
                             text.size(), text.data()) == 1 &&
        base64_decode_final(&context) == 1 && length == count;
    if (!valid) return {};
    bytes.resize(count);
    return bytes;
}

}  // namespace hshfit::inline files
