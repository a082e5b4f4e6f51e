#pragma once

#include <hshfit/brdf/directions.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace hshfit::inline meshes {

/// A position or a normal as meshes store it.
using MeshVector = std::array<float, 3>;

/// The same numbers in double precision; the length is kept.
inline Direction directionOf(const MeshVector& v) {
    return {v[0], v[1], v[2]};
}

/// Triangles in space. The front of a triangle is the side from which its corners run
/// counterclockwise.
struct Mesh {
    std::vector<MeshVector> positions;
    std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices of positions
    std::vector<MeshVector> normals;                      ///< [3 triangle + corner], of length 1
};

/// The largest angle between two triangles over whose common edge computed normals are smooth.
constexpr double creaseAngle = 60 * (pi / 180);

/// Fills in every normal of length 0, and all if there are none, and makes the others unit vectors.
/// A computed normal is the mean of the normals of triangles at the vertex, weighted with the
/// triangles' angles there (Thürmer and Wüthrich 1998). Only triangles within `creaseAngle` of the
/// corner's own triangle count. Beyond 256 triangles a vertex has one normal for all of them.
void completeNormals(Mesh& mesh);

/// Drops triangles without area, and returns their number.
std::size_t dropDegenerate(Mesh& mesh);

/// From a frame with +y up to one with +z up: (x, y, z) becomes (x, -z, y).
void turnUpright(Mesh& mesh);

/// A unit sphere from an octahedron whose triangles are cut into four `levels` times, with the
/// sphere's normals.
Mesh sphereMesh(int levels);

/// A square at z = 0 with x and y from -1 to 1, its front upwards.
Mesh squareMesh();

}  // namespace hshfit::inline meshes
