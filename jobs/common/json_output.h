#pragma once

#include <hshfit/error.h>
#include <hshfit/files/extension.h>

#include <fmt/format.h>

#include <string>
#include <string_view>

namespace hshfit::jobs {

/// Throws UsageError, before the work, where a document of JSON would get the extension of another
/// format: programs and people would take "sky.exr" for a picture. None at all is allowed.
inline void requireJsonName(const std::string& path, std::string_view content) {
    const std::string extension = extensionOf(path);
    if (extension.empty() || extension == ".json") return;
    throw UsageError(fmt::format("'{}': {} are written as .json", path, content));
}

}  // namespace hshfit::jobs
