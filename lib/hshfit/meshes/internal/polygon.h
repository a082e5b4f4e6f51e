#pragma once

#include <hshfit/meshes/mesh.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace hshfit::inline meshes {

/// Corners of a polygon that is no fan from its first corner, at most: ears are cut in a time that
/// grows with their square.
inline constexpr std::size_t mostEars = 8192;

/// Cuts a polygon of at least three corners into triangles with its sense of turning, whose areas
/// add up to its own where it does not cross itself, convex or not: quadrilaterals along the
/// shorter diagonal that lies inside, others as a fan where that lies inside, else ear by ear in
/// the plane of Newell's normal. Appends numbers of corners. False, with nothing appended, for more
/// than `mostEars` where ears have to be cut.
bool cutPolygon(std::span<const MeshVector> corners,
                std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace hshfit::inline meshes
