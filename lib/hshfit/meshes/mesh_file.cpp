#include <hshfit/meshes/mesh_file.h>

#include <hshfit/error.h>
#include <hshfit/files/json_format.h>
#include <hshfit/files/mapped_file.h>
#include <hshfit/meshes/internal/mesh_readers.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline meshes {
namespace {

/// Squares of larger coordinates come near the end of single precision's range.
constexpr float largestCoordinate = 1e15F;

void checkValues(const std::vector<MeshVector>& vectors, std::string_view noun,
                 const std::string& path) {
    for (std::size_t k = 0; k < vectors.size(); ++k) {
        for (const float value : vectors[k]) {
            if (std::abs(value) <= largestCoordinate) continue;
            throw InputError(
                fmt::format("{}: {} {} has the coordinate {}; it has to be finite and "
                            "at most {:g} in magnitude",
                            path, noun, k, value, largestCoordinate));
        }
    }
}

MeshFile contentOf(std::string_view bytes, const std::string& path) {
    constexpr std::string_view byteOrderMark = "\xef\xbb\xbf";
    if (bytes.starts_with(byteOrderMark)) bytes.remove_prefix(byteOrderMark.size());
    if (bytes.starts_with("glTF") || beginsAsJson(bytes))
        return {.mesh = readGltf(bytes, path), .yUp = true};
    const bool ply =
        bytes.starts_with("ply") && bytes.size() > 3 && (bytes[3] == '\n' || bytes[3] == '\r');
    return {.mesh = ply ? readPly(bytes, path) : readObj(bytes, path)};
}

}  // namespace

MeshFile readMesh(const std::string& path) {
    const MappedFile file(path);
    if (file.size() > largestMeshFile) {
        throw InputError(fmt::format("{}: has {} bytes; a mesh file may have {} at most", path,
                                     file.size(), largestMeshFile));
    }
    MeshFile result =
        meshFromBytes({reinterpret_cast<const char*>(file.data()), file.size()}, path);
    file.checkIntact();
    return result;
}

MeshFile meshFromBytes(std::string_view bytes, const std::string& path) {
    MeshFile result = contentOf(bytes, path);
    Mesh& mesh = result.mesh;
    if (mesh.triangles.empty()) {
        throw InputError(
            fmt::format("{}: has no faces; a mesh is a Wavefront OBJ, PLY or glTF file with "
                        "triangles or polygons",
                        path));
    }
    checkValues(mesh.positions, "vertex", path);
    checkValues(mesh.normals, "the normal of corner", path);
    result.degenerate = dropDegenerate(mesh);
    if (mesh.triangles.empty()) {
        throw InputError(
            fmt::format("{}: none of its {} triangles has an area", path, result.degenerate));
    }
    result.computedNormals =
        mesh.normals.empty() || std::ranges::find(mesh.normals, MeshVector{}) != mesh.normals.end();
    completeNormals(mesh);
    return result;
}

}  // namespace hshfit::inline meshes
