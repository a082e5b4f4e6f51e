#pragma once

#include <hshfit/meshes/mesh.h>

#include <array>
#include <cstdint>
#include <vector>

namespace hshfit::inline materials {

/// A triangle mesh as renderers take it: every vertex has one normal and one tangent.
struct Surface {
    std::vector<std::array<float, 3>> positions, normals;
    /// Unit vectors across the normal, and 1: the bitangent is cross(normal, tangent).
    std::vector<std::array<float, 4>> tangents;
    std::vector<std::array<float, 2>> coordinates;  ///< of textures; may be empty
    std::vector<std::uint32_t> indices;             ///< three a triangle, counterclockwise in front
};

/// A unit sphere about the origin, +y up, of `rings` rings of twice as many quads. Texture
/// coordinate u grows with the longitude from -z over -x, v downwards from the pole; the tangent
/// is the direction of growing u. Throws UsageError below 2 or above 1024 rings.
Surface sphereSurface(int rings = 96);

/// A mesh (+y up); a vertex for each different pair of position and normal. Tangents have growing
/// longitude about +y; at poles they are +x.
Surface surfaceOf(const Mesh& mesh);

}  // namespace hshfit::inline materials
