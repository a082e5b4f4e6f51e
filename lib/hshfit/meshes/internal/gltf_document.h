#pragma once

#include <tiny_gltf.h>

#include <string>
#include <string_view>

namespace hshfit::inline meshes {

/// The nodes, meshes and accessors of a glTF 2.0 file, .gltf or .glb, and the bytes of their
/// buffers, by tinygltf. Materials, pictures, skins and animations are left out before it reads the
/// file. Buffers in files of their own lie beside `path`, which starts every message. Ranges and
/// indices are not checked. Throws InputError.
tinygltf::Model readGltfDocument(std::string_view bytes, const std::string& path);

}  // namespace hshfit::inline meshes
