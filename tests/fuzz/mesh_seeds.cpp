#include "seed_files.h"

#include <hshfit/files/checksum.h>

#include <brdfs/tensor_writer.h>

#include <cstdint>
#include <fstream>
#include <span>

using hshfit::test::put;

void writeSeed(const std::filesystem::path& path, const std::string& bytes) {
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary)
        .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

namespace {

void gltf(const std::filesystem::path& folder) {
    std::string buffer;
    for (const int x : {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}) put(buffer, static_cast<float>(x));
    for (const int k : {0, 1, 2, 3}) put(buffer, static_cast<std::uint16_t>(k));
    const std::string head =
        R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,)"
        R"("children":[1],"scale":[1,-2,1]},)"
        R"({"mesh":0,"rotation":[0,0,1,0],"translation":[2,0,0]}],)"
        R"("meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":0},"indices":1,"mode":6},)"
        R"({"attributes":{"POSITION":2},"mode":5}]}],"accessors":[{"bufferView":0,"componentType":)"
        R"(5126,"count":4,"type":"VEC3"},{"bufferView":1,"componentType":5123,"count":4,"type":)"
        R"("SCALAR"},{"componentType":5126,"count":4,"type":"VEC3","sparse":{"count":3,"indices":)"
        R"({"bufferView":1,"byteOffset":2,"componentType":5123},"values":{"bufferView":0,)"
        R"("byteOffset":12}}}],"bufferViews":[{"buffer":0,"byteLength":48,"byteStride":12},)"
        R"({"buffer":0,"byteOffset":48,"byteLength":8}],"buffers":[{"byteLength":56)";
    writeSeed(folder / "quad.gltf",
              head + R"(,"uri":"data:application/octet-stream;base64,)" +
                  hshfit::base64(std::as_bytes(std::span(buffer.data(), buffer.size()))) + "\"}]}");
    std::string text = head + "}]}";
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string bytes = "glTF";
    const auto size = [](std::size_t count) { return static_cast<std::uint32_t>(count); };
    for (const std::uint32_t word : {2U, size(28 + text.size() + buffer.size()), size(text.size())})
        put(bytes, word);
    bytes += "JSON" + text;
    put(bytes, size(buffer.size()));
    writeSeed(folder / "quad.glb", bytes + std::string("BIN\0", 4) + buffer);
}

}  // namespace

void meshSeeds(const std::filesystem::path& folder) {
    gltf(folder);
    writeSeed(folder / "quad.obj",
              "# a square\nv -1 0 -1\nv 1 0 -1 0.5 0.5 0.5\nv 1 0 1\nv -1 0 1e0\nvt 0 1\n"
              "vn 0 -1 0\no a\ng b\ns 1\nusemtl m\nf 1/1/1 4//1 3/1 -3\nl 1 2\n");
    const std::string head =
        "comment c\nobj_info i\nelement vertex 4\nproperty float x\n"
        "property double y\nproperty short z\nproperty uchar red\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    writeSeed(folder / "quad.ply",
              "ply\nformat ascii 1.0\n" + head + "0 0 0 9\n1 0 0 9\n1 1 0 9\n0 1 0 9\n4 0 1 2 3\n");
    std::string body;
    for (const int k : {0, 1, 2, 3}) {
        put(body, static_cast<float>(k % 3 > 0));
        put(body, static_cast<double>(k / 2));
        put(body, std::int16_t{0});
        put(body, std::uint8_t{9});
    }
    put(body, std::uint8_t{4});
    for (const std::int32_t k : {0, 1, 2, 3}) put(body, k);
    writeSeed(folder / "little.ply", "ply\nformat binary_little_endian 1.0\n" + head + body);
    writeSeed(folder / "big.ply", "ply\nformat binary_big_endian 1.0\n" + head + body);
    writeSeed(folder / "normals.ply",
              "ply\r\nformat ascii 1.0\r\nelement vertex 3\r\nproperty float x\r\n"
              "property float y\r\nproperty float z\r\nproperty float nx\r\nproperty float ny\r\n"
              "property float nz\r\nelement face 1\r\nproperty list uint8 uint32 vertex_index\r\n"
              "end_header\r\n0 0 0 0 0 1\r\n1 0 0 0 0 2\r\n0 1 0 0 0 0\r\n3 0 1 2\r\n");
}
