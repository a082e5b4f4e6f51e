#pragma once

#include <hshfit/transport/surface_scene.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace hshfit::inline precomputed_transfer {

/// The sides of surfaces at which light is gathered.
enum class Sides {
    automatic,  ///< both of an object with open edges, the front of a closed one
    front,
    both,
};

struct TransferMeshOptions {
    /// The longest edge of a triangle: longer ones are halved, in both triangles at the edge. None:
    /// 1/32 of the diagonal of the scene's bounding box, so that a wall of two triangles can carry
    /// a shadow; 0: triangles stay as they are.
    std::optional<double> edge = {};
    Sides sides = Sides::automatic;
};

/// A point of a surface with one normal and one side.
struct TransferVertex {
    MeshVector position{}, normal{};
    std::uint32_t object = 0;
    double area = 0;  ///< a third of the area of the triangles around it
};

/// The surfaces of a scene as vertices and triangles with one side each. Corners of an object at
/// one place share a vertex if their normals differ by less than 2 degrees.
struct TransferMesh {
    static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

    std::vector<TransferVertex> vertices = {};
    /// Corners, counterclockwise from the side that they stand for: the `fronts` triangles of
    /// the scene, then the backs of some of them.
    std::vector<std::array<std::uint32_t, 3>> triangles = {};
    std::size_t fronts = 0;
    std::vector<std::uint32_t> backs = {};  ///< [front] the triangle that is its back, or none
    std::vector<Direction> normals = {};    ///< of triangles, on their side
    std::vector<std::uint32_t> first = {}, around = {};  ///< triangles around each vertex

    std::vector<std::size_t> materials = {};  ///< of each object
    std::size_t twoSided = 0;                 ///< objects with both sides
    double edge = 0;                          ///< the longest allowed; 0: any

    std::size_t material(std::size_t vertex) const { return materials[vertices[vertex].object]; }
    Direction corner(std::size_t triangle, std::size_t k) const {
        return directionOf(vertices[triangles[triangle][k]].position);
    }
};

/// Throws UsageError for positions or normals that are no numbers, naming the object, for an edge
/// that is negative or makes more than 2^22 triangles, and without any triangle. Triangles without
/// area are left out.
TransferMesh transferMesh(std::span<const SurfaceObject> objects,
                          const TransferMeshOptions& options = {});

}  // namespace hshfit::inline precomputed_transfer
