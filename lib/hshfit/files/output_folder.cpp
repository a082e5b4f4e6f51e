#include <hshfit/error.h>
#include <hshfit/files/output_folder.h>

#include <filesystem>

#include <fmt/format.h>

namespace hshfit::inline files {

void requireOutputFolder(const std::string& path) {
    const std::string named = path.substr(0, path.find_last_not_of('/') + 1);
    const auto folder = std::filesystem::path(named).parent_path();
    std::error_code error;
    if (folder.empty() ||
        std::filesystem::status(folder, error).type() != std::filesystem::file_type::not_found)
        return;
    throw OutputError(
        fmt::format("cannot write '{}': there is no folder '{}'", path, folder.string()));
}

}  // namespace hshfit::inline files
