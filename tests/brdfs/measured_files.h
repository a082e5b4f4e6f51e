#pragma once

#include <hshfit/brdf/directions.h>
#include <hshfit/error.h>

#include <gtest/gtest.h>
#include <stdlib.h>
#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::test {

/// A file in the temporary folder that is gone after the test.
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

/// A MERL file written cell by cell: value(channel, h, d, p) as stored, before the scale.
using MerlCells = std::function<double(int, int, int, int)>;
inline std::string merlFile(const MerlCells& value, int azimuths = 180) {
    std::string bytes(12 + 3 * std::size_t{8100} * azimuths * 8, '\0');
    const std::int32_t header[3] = {90, 90, azimuths};
    std::memcpy(bytes.data(), header, sizeof header);
    char* to = bytes.data() + 12;
    for (int c = 0; c < 3; ++c)
        for (int h = 0; h < 90; ++h)
            for (int d = 0; d < 90; ++d)
                for (int p = 0; p < azimuths; ++p, to += 8) {
                    const double v = value(c, h, d, p);
                    std::memcpy(to, &v, 8);
                }
    return bytes;
}

/// The call throws InputError with one line that contains every one of `parts`.
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

/// Uniform on the hemisphere, above `least` = cos(theta).
inline Direction randomDirection(std::mt19937& random, double least = 0.01) {
    const double z = std::uniform_real_distribution<>(least, 1)(random);
    const double phi = std::uniform_real_distribution<>(-pi, pi)(random);
    const double s = std::sqrt(1 - z * z);
    return {s * std::cos(phi), s * std::sin(phi), z};
}

}  // namespace hshfit::test
