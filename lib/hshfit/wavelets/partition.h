#pragma once

#include <hshfit/wavelets/subdivision.h>

#include <cstddef>
#include <vector>

namespace hshfit::wavelets {

/// The octahedron subdivided `levels` times, over the sphere (8 triangles at level 0) or the upper
/// hemisphere (4, whose edges are the horizon). The children of triangle k are 4 k to 4 k + 3 of
/// the next level, in the order of `subdivided`. 107 bytes a leaf.
class Partition {
public:
    enum class Domain { sphere, hemisphere };
    static constexpr int mostLevels = 9;  ///< 2 million leaves of the sphere

    /// Throws UsageError for levels outside 0 .. mostLevels.
    Partition(Domain domain, int levels);

    Domain domain() const { return domain_; }
    int levels() const { return static_cast<int>(triangles_.size()) - 1; }
    std::size_t roots() const { return triangles_.front().size(); }
    std::size_t leaves() const { return triangles_.back().size(); }
    const std::vector<Triangle>& level(int j) const {
        return triangles_[static_cast<std::size_t>(j)];
    }

    /// The root and then the child, 0 to 3, that `d` lies in, level by level; path[j] for
    /// j = 0 .. levels. On an edge either side. Directions below a hemisphere count as mirrored.
    void locate(const Direction& d, int levels, unsigned char* path) const;

private:
    Domain domain_;
    std::vector<std::vector<Triangle>> triangles_;
};

/// A point in the middle of a triangle.
Direction centreOf(const Triangle& triangle);

}  // namespace hshfit::wavelets
