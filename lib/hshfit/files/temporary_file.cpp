#include <hshfit/files/temporary_file.h>

#include <hshfit/error.h>

#include <fmt/format.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

namespace hshfit::inline files {

TemporaryFile::TemporaryFile(const std::string& name)
    : folder_((std::filesystem::temp_directory_path() / "hshfit-XXXXXX").string()) {
    if (!mkdtemp(folder_.data())) {
        throw OutputError(
            fmt::format("{}: no temporary folder can be made: {}", folder_, std::strerror(errno)));
    }
    path_ = (std::filesystem::path(folder_) / name).string();
}

TemporaryFile::~TemporaryFile() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
}

}  // namespace hshfit::inline files
