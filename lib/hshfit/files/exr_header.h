#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::inline files {

/// The size of an EXR file according to its header.
struct ExrHeader {
    std::size_t width = 0, height = 0, channels = 0;
};

/// The kind of EXR file that a header is checked for.
struct ExrRules {
    std::string_view files = "coefficient files";  ///< for messages
    bool picture = false;  ///< HALF channels and PIZ compression pass as well
};

/// Walks the header of an EXR file before OpenEXR does, which allocates from sizes that it reads.
/// Passes single-part scan-line files whose attributes lie within `bytes`, are of plain types and
/// as long as these; whose data window starts at (0, 0) and is at most 65536 a side; whose channels
/// are all FLOAT and not subsampled; whose compression is none, RLE, ZIPS or ZIP; and that could
/// inflate to their stated size (deflate reaches 1032 : 1). Throws InputError that starts with
/// `file`.
ExrHeader checkExrHeader(std::string_view bytes, const std::string& file,
                         const ExrRules& rules = {});

/// The same for a file of several scan-line parts, at most `mostParts`, whose tables of chunks are
/// as long as their sizes make them.
std::vector<ExrHeader> checkExrParts(std::string_view bytes, const std::string& file,
                                     const ExrRules& rules, std::size_t mostParts);

/// Whether every attribute of every header ends within the file. OpenEXR makes room for as many
/// bytes as an attribute states before it reads them.
bool exrHeadersAreWhole(std::string_view bytes);

/// Whether the file states several parts.
bool exrHasParts(std::string_view bytes);

/// Whether the bytes begin as an OpenEXR file does.
bool hasExrMagic(std::string_view bytes);

/// Whether the header that starts `bytes`, which may be cut off, has the attribute; false if it is
/// cut off before it.
bool exrHasAttribute(std::string_view bytes, std::string_view name);

/// Whether it has the attribute hshfit:format.
bool exrSaysCoefficients(std::string_view bytes);

/// Width and height of its data window, if that starts at (0, 0).
std::optional<std::array<std::size_t, 2>> exrSize(std::string_view bytes);

/// Width and height of its display window, wherever that starts.
std::optional<std::array<std::size_t, 2>> exrDisplaySize(std::string_view bytes);

/// Whether its data window has width x height pixels and starts at (0, 0).
bool exrSaysSize(std::string_view bytes, std::int32_t width, std::int32_t height);

}  // namespace hshfit::inline files
