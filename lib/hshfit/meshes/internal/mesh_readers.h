#pragma once

#include <hshfit/meshes/mesh.h>

#include <string>
#include <string_view>

namespace hshfit::inline meshes {

/// The content of a file as triangles; normals of length 0 where the file has none. `path` starts
/// every message. Indices are checked, values are not.
Mesh readObj(std::string_view text, const std::string& path);
Mesh readPly(std::string_view bytes, const std::string& path);
Mesh readGltf(std::string_view bytes, const std::string& path);

}  // namespace hshfit::inline meshes
