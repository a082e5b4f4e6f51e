#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace hshfit {

/// What the header of a coefficient EXR says about its size.
struct ExrHeader {
    std::size_t width = 0, height = 0, channels = 0;
};

/// Walks the header of an EXR file before OpenEXR does, which allocates from sizes that it reads.
/// Passes single-part scan-line files whose attributes lie within `bytes`, are of plain types and
/// as long as these; whose data window starts at (0, 0) and is at most 65536 a side; whose channels
/// are all FLOAT and not subsampled; whose compression is lossless; and that could inflate to their
/// stated size (deflate reaches 1032 : 1). Throws InputError that starts with `file`.
ExrHeader checkExrHeader(std::string_view bytes, const std::string& file);

bool hasExrMagic(std::string_view bytes);

/// Whether the header that starts `bytes` has the attribute hshfit:format.
bool exrSaysCoefficients(std::string_view bytes);

}  // namespace hshfit
