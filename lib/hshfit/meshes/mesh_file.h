#pragma once

#include <hshfit/meshes/mesh.h>

#include <cstddef>
#include <string>
#include <string_view>

namespace hshfit::inline meshes {

/// A mesh from a file, and the changes made to it.
struct MeshFile {
    Mesh mesh;
    std::size_t degenerate = 0;    ///< triangles without area, which were left out
    bool computedNormals = false;  ///< some or all, because the file has none
    bool yUp = false;              ///< by the format's definition, as in glTF
};

/// The largest file that is read, in bytes.
constexpr std::size_t largestMeshFile = std::size_t{1} << 30;

/// Reads a Wavefront OBJ, a PLY (ascii, binary of either byte order) or a glTF 2.0 file (.gltf,
/// .glb), by its content: a PLY file starts with "ply", a glTF file with "glTF" or "{". Of an OBJ
/// file, `v`, `vn` and `f` count, over as many lines as it likes; of a PLY file x, y, z and nx, ny,
/// nz of `vertex` and `vertex_indices` (or `vertex_index`) of `face` and of `tristrips`. Every face
/// is in the mesh, or the file is refused; polygons become triangles, convex or not (a byte-order
/// mark before text is left out). Of a glTF file, the nodes of its scene with their
/// transforms, and of their meshes triangles, strips and fans, POSITION and NORMAL, in floats or
/// integers, count; skins, morph targets, materials and cameras do not, and compressed meshes are
/// refused. Its +y is up. Buffers in other files lie beside `path`. Throws InputError, which names
/// the file and the place, for a file that is broken, cut short, larger than `largestMeshFile` or
/// without a triangle of some area, for a number that is not finite or beyond 1e15, and for an
/// index of no vertex.
MeshFile readMesh(const std::string& path);
/// The same from the bytes of a file, whose name starts every message.
MeshFile meshFromBytes(std::string_view bytes, const std::string& name);

}  // namespace hshfit::inline meshes
