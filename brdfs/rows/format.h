#pragma once

#include <brdfs/rows/spec.h>
#include <hshfit/brdf/brdf.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::brdfs {

/// One row of the table of measured formats.
struct Format {
    std::string_view name;
    std::string_view help;
    std::string_view extension;  ///< with the dot; used only for unrecognised content
    /// Whether the first bytes and the size look like this format.
    bool (*recognises)(std::span<const unsigned char> head, std::uint64_t fileSize);
    std::vector<Parameter> parameters;  ///< options after the path: PATH:key=value
    std::unique_ptr<Brdf> (*open)(const std::string& path, const Parameters& parameters);
};

}  // namespace hshfit::brdfs
