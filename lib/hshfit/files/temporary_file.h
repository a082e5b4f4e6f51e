#pragma once

#include <string>

namespace hshfit::inline files {

/// The path of a file in a temporary folder of its own, which goes with all that it holds when this
/// does. No file is made.
class TemporaryFile {
public:
    /// `name` without folders. Throws OutputError where no folder can be made.
    explicit TemporaryFile(const std::string& name);
    ~TemporaryFile();
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;

    const std::string& path() const { return path_; }

private:
    std::string folder_, path_;
};

}  // namespace hshfit::inline files
