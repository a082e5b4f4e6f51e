#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::jobs {

/// A map of materials, or an export of one, that a specification names.
struct MapFacts {
    struct Level {
        std::size_t width = 0, height = 0;
    };
    std::string form;
    std::vector<Level> levels;
    std::size_t bytes = 0;  ///< of the files of its texels and, of the form library, the library
    /// The texel that the specification stands for, and whether it says so by x or y.
    std::size_t x = 0, y = 0, level = 0;
    bool texelIsGiven = false;
};

/// The map of "FILE" or "FILE:x=3,y=5,level=0"; none of another specification. Throws UsageError
/// and InputError as openBrdf does.
std::optional<MapFacts> mapOf(const std::string& spec);

/// "texel 0,0 of level 0; :x=...,y=... names others" of a map without x and y; else empty.
std::string texelRemark(const std::string& spec);

}  // namespace hshfit::jobs
