#pragma once

// The bytes of a file without what it states of its making (hshfit/files/made_from.h): those that
// the library would have written.

#include <cstdint>
#include <cstring>
#include <string>

namespace hshfit::test {

/// JSON: the last member, as it is laid out at the end of a document.
inline void eraseFromJson(std::string& bytes) {
    for (const std::string begin : {",\n  \"made_from\": ", ",\"made_from\":"}) {
        const std::size_t at = bytes.rfind(begin);
        if (at == std::string::npos) continue;
        bytes.replace(at, std::string::npos, begin[1] == '\n' ? "\n}\n" : "}\n");
        return;
    }
}

/// PNG: a chunk of its length, type, content and checksum.
inline void eraseFromPng(std::string& bytes) {
    const std::size_t type = bytes.find(std::string("tEXtmade_from\0", 14));
    if (type == std::string::npos) return;
    std::size_t length = 0;
    for (std::size_t i = type - 4; i < type; ++i)
        length = length << 8 | static_cast<unsigned char>(bytes[i]);
    bytes.erase(type - 4, length + 12);
}

/// OpenEXR: the attribute that stands last in the header, and as much off the table of chunks.
inline void eraseFromExr(std::string& bytes) {
    const std::string begin("hshfit:made_from\0string\0", 24);
    const std::size_t at = bytes.find(begin);
    if (at == std::string::npos) return;
    std::int32_t length = 0;
    std::memcpy(&length, bytes.data() + at + begin.size(), sizeof length);
    const std::size_t erased = begin.size() + sizeof length + static_cast<std::size_t>(length);
    bytes.erase(at, erased);
    std::uint64_t first = bytes.size(), offset = 0;
    for (std::size_t entry = at + 1; entry < first; entry += sizeof offset) {
        std::memcpy(&offset, bytes.data() + entry, sizeof offset);
        offset -= erased;
        if (offset < first) first = offset;
        std::memcpy(bytes.data() + entry, &offset, sizeof offset);
    }
}

inline std::string unstated(std::string bytes) {
    if (bytes.starts_with("\x89PNG"))
        eraseFromPng(bytes);
    else if (bytes.starts_with("\x76\x2f\x31\x01"))
        eraseFromExr(bytes);
    else if (bytes.starts_with("{"))
        eraseFromJson(bytes);
    return bytes;
}

}  // namespace hshfit::test
