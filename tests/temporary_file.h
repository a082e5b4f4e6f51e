#pragma once

#include <hshfit/error.h>

#include <gtest/gtest.h>
#include <stdlib.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::test {

/// A file in the temporary folder, removed after the test.
class TemporaryFile {
public:
    explicit TemporaryFile(std::string_view content = {}, const std::string& suffix = ".bin") {
        path_ = (std::filesystem::temp_directory_path() / ("hshfit-test-XXXXXX" + suffix)).string();
        const int descriptor = mkstemps(path_.data(), static_cast<int>(suffix.size()));
        EXPECT_GE(descriptor, 0) << path_;
        close(descriptor);
        write(content);
    }
    ~TemporaryFile() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;

    void write(std::string_view content) const {
        std::ofstream(path_, std::ios::binary)
            .write(content.data(), static_cast<std::streamsize>(content.size()));
    }
    void resize(std::uintmax_t size) const { std::filesystem::resize_file(path_, size); }
    const std::string& path() const { return path_; }

private:
    std::string path_;
};

/// Checks that the call throws InputError with one line that contains all of `parts`.
inline void expectInputError(const std::function<void()>& call,
                             const std::vector<std::string>& parts) {
    try {
        call();
        ADD_FAILURE() << "no InputError";
    } catch (const InputError& error) {
        const std::string message = error.what();
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
        EXPECT_LT(message.size(), 1000u) << message;
        for (const std::string& part : parts) {
            EXPECT_NE(message.find(part), std::string::npos) << message << " lacks: " << part;
        }
    }
}

}  // namespace hshfit::test
