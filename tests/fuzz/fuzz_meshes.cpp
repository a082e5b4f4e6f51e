// The bytes are a mesh: OBJ, PLY or glTF. A mesh that reads has corners that exist, finite
// positions and unit normals; anything else is an error of one line.

#include <hshfit/error.h>
#include <hshfit/meshes/mesh_file.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view bytes(reinterpret_cast<const char*>(data), size);
    try {
        const hshfit::Mesh mesh = hshfit::meshFromBytes(bytes, "input").mesh;
        if (mesh.triangles.empty() || mesh.normals.size() != 3 * mesh.triangles.size())
            std::abort();
        for (const auto& triangle : mesh.triangles)
            for (const std::uint32_t corner : triangle) {
                if (corner >= mesh.positions.size()) std::abort();
                for (const float value : mesh.positions[corner])
                    if (!std::isfinite(value)) std::abort();
            }
        for (const auto& n : mesh.normals)
            if (!(std::abs(std::hypot(n[0], n[1], n[2]) - 1) < 1e-3)) std::abort();
    } catch (const hshfit::InputError& error) {
        if (std::strchr(error.what(), '\n')) std::abort();
    }
    return 0;
}
