#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

namespace hshfit::shaders {

/// The words of a file of SPIR-V. Throws std::runtime_error for one that is none.
inline std::vector<std::uint32_t> wordsOf(const char* path) {
    std::ifstream file(path, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    if (!file || bytes.empty() || bytes.size() % 4 != 0)
        throw std::runtime_error(fmt::format("{}: is no SPIR-V", path));
    std::vector<std::uint32_t> words(bytes.size() / 4);
    std::copy_n(bytes.data(), bytes.size(), reinterpret_cast<char*>(words.data()));
    return words;
}

}  // namespace hshfit::shaders
