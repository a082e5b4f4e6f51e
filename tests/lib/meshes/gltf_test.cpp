// glTF meshes: by hand after the specification, from gltfpack, from our own export, and hostile.

#include <hshfit/files/checksum.h>
#include <hshfit/materials/glb.h>
#include <hshfit/meshes/mesh_file.h>

#include "places.h"
#include "temporary_file.h"
#include "temporary_folder.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <cstring>
#include <fstream>
#include <random>

using namespace hshfit;
using test::expectInputError;
using test::TemporaryFile;
using Json = nlohmann::json;

namespace {

template <class Number>
std::string bytesOf(const std::vector<Number>& numbers) {
    std::string bytes(numbers.size() * sizeof(Number), '\0');
    std::memcpy(bytes.data(), numbers.data(), bytes.size());
    return bytes;
}

/// A document and its one buffer.
struct Gltf {
    Json json = {{"asset", {{"version", "2.0"}}},
                 {"scene", 0},
                 {"scenes", {{{"nodes", {0}}}}},
                 {"nodes", {{{"mesh", 0}}}},
                 {"meshes", {{{"primitives", Json::array()}}}},
                 {"bufferViews", Json::array()},
                 {"accessors", Json::array()}};
    std::string buffer = {};

    std::size_t view(const std::string& bytes) {
        buffer.resize((buffer.size() + 3) / 4 * 4);
        json["bufferViews"].push_back(
            {{"buffer", 0}, {"byteOffset", buffer.size()}, {"byteLength", bytes.size()}});
        buffer += bytes;
        return json["bufferViews"].size() - 1;
    }
    template <class Number>
    std::size_t accessor(const std::vector<Number>& numbers, int component, const char* type) {
        const std::size_t width = std::string(type) == "VEC3" ? 3 : 1;
        json["accessors"].push_back({{"bufferView", view(bytesOf(numbers))},
                                     {"componentType", component},
                                     {"count", numbers.size() / width},
                                     {"type", type}});
        return json["accessors"].size() - 1;
    }
    void primitive(const Json& primitive) { json["meshes"][0]["primitives"].push_back(primitive); }

    std::string embedded() const {
        Json whole = json;
        whole["buffers"] = {
            {{"byteLength", buffer.size()},
             {"uri", "data:application/octet-stream;base64," +
                         base64(std::as_bytes(std::span(buffer.data(), buffer.size())))}}};
        return whole.dump();
    }
    std::string beside(const std::string& file) const {
        Json whole = json;
        whole["buffers"] = {{{"byteLength", buffer.size()}, {"uri", file}}};
        return whole.dump(1);
    }
    std::string binary() const {
        Json whole = json;
        whole["buffers"] = {{{"byteLength", buffer.size()}}};
        std::string text = whole.dump(), bin = buffer;
        text.resize((text.size() + 3) / 4 * 4, ' ');
        bin.resize((bin.size() + 3) / 4 * 4);
        const auto words = [](std::vector<std::uint32_t> numbers) { return bytesOf(numbers); };
        const auto size = [](const std::string& s) { return static_cast<std::uint32_t>(s.size()); };
        return "glTF" + words({2, 28 + size(text) + size(bin), size(text), 0x4E4F534A}) + text +
               words({size(bin), 0x004E4942}) + bin;
    }
};

const std::vector<float> cubeCorners{-1, -1, -1, 1, -1, -1, 1, 1, -1, -1, 1, -1,
                                     -1, -1, 1,  1, -1, 1,  1, 1, 1,  -1, 1, 1};
const std::vector<std::uint16_t> cubeIndices{3, 2, 1, 3, 1, 0, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4,
                                             2, 3, 7, 2, 7, 6, 1, 2, 6, 1, 6, 5, 3, 0, 4, 3, 4, 7};

/// A cube of side 2 about the origin whose triangles face outwards.
Gltf cube() {
    Gltf gltf;
    const auto position = gltf.accessor(cubeCorners, 5126, "VEC3");
    const auto indices = gltf.accessor(cubeIndices, 5123, "SCALAR");
    gltf.primitive({{"attributes", {{"POSITION", position}}}, {"indices", indices}});
    return gltf;
}

Mesh meshOf(const Gltf& gltf) {
    return meshFromBytes(gltf.binary(), "test.glb").mesh;
}

using Vector = std::array<double, 3>;

Vector areaVector(const Mesh& mesh, std::size_t triangle) {
    const auto& t = mesh.triangles[triangle];
    Vector a{}, b{};
    for (std::size_t i = 0; i < 3; ++i) {
        a[i] = double{mesh.positions[t[1]][i]} - mesh.positions[t[0]][i];
        b[i] = double{mesh.positions[t[2]][i]} - mesh.positions[t[0]][i];
    }
    return {(a[1] * b[2] - a[2] * b[1]) / 2, (a[2] * b[0] - a[0] * b[2]) / 2,
            (a[0] * b[1] - a[1] * b[0]) / 2};
}

double areaOf(const Mesh& mesh) {
    double sum = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const Vector a = areaVector(mesh, t);
        sum += std::hypot(a[0], a[1], a[2]);
    }
    return sum;
}

/// The volume that triangles enclose; positive where they face outwards.
double volumeOf(const Mesh& mesh) {
    double sum = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const Vector a = areaVector(mesh, t);
        const MeshVector& p = mesh.positions[mesh.triangles[t][0]];
        sum += (a[0] * p[0] + a[1] * p[1] + a[2] * p[2]) / 3;
    }
    return sum;
}

void expectNormalsOfFaces(const Mesh& mesh) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const Vector a = areaVector(mesh, t);
        const double length = std::hypot(a[0], a[1], a[2]);
        for (std::size_t k = 0; k < 3; ++k)
            for (std::size_t i = 0; i < 3; ++i)
                EXPECT_NEAR(mesh.normals[3 * t + k][i], a[i] / length, 1e-6);
    }
}

TEST(GltfMesh, EmbeddedBinaryAndBesideAreTheSame) {
    const Gltf gltf = cube();
    const TemporaryFile buffer(gltf.buffer, ".with space.bin");
    std::string name = std::filesystem::path(buffer.path()).filename();
    for (std::size_t at = 0; (at = name.find(' ')) != std::string::npos;)
        name.replace(at, 1, "%20");
    for (const std::string& text : {gltf.embedded(), gltf.binary(), gltf.beside(name)}) {
        const TemporaryFile file(text, ".mesh");
        const MeshFile read = readMesh(file.path());
        EXPECT_TRUE(read.yUp);
        EXPECT_TRUE(read.computedNormals);
        EXPECT_EQ(read.mesh.positions.size(), 8u);
        ASSERT_EQ(read.mesh.triangles.size(), 12u);
        EXPECT_NEAR(areaOf(read.mesh), 24, 1e-6);
        EXPECT_NEAR(volumeOf(read.mesh), 8, 1e-6);
        expectNormalsOfFaces(read.mesh);
    }
    buffer.write("short");
    const TemporaryFile file(gltf.beside(name), ".gltf");
    expectInputError([&] { readMesh(file.path()); }, {file.path(), "mismatch"});
    const TemporaryFile alone(gltf.beside("absent.bin"), ".gltf");
    expectInputError([&] { readMesh(alone.path()); }, {alone.path(), "absent.bin"});
}

/// A square facing +z by every way of listing its triangles, and every type of index.
TEST(GltfMesh, EveryModeAndIndexGivesTheSameSquare) {
    const std::vector<float> ring{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
    const std::vector<float> strip{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
    struct Way {
        int mode;
        std::vector<float> corners;
        std::vector<unsigned> indices;
    };
    const Way ways[] = {{4, ring, {0, 1, 2, 0, 2, 3}},
                        {5, strip, {0, 1, 2, 3}},
                        {5, strip, {}},
                        {6, ring, {0, 1, 2, 3}},
                        {6, ring, {}}};
    for (const Way& way : ways) {
        for (const int component : {5121, 5123, 5125}) {
            Gltf gltf;
            Json primitive = {
                {"attributes", {{"POSITION", gltf.accessor(way.corners, 5126, "VEC3")}}},
                {"mode", way.mode}};
            const auto& n = way.indices;
            if (!n.empty() && component == 5121)
                primitive["indices"] = gltf.accessor(std::vector<std::uint8_t>(n.begin(), n.end()),
                                                     component, "SCALAR");
            if (!n.empty() && component == 5123)
                primitive["indices"] = gltf.accessor(std::vector<std::uint16_t>(n.begin(), n.end()),
                                                     component, "SCALAR");
            if (!n.empty() && component == 5125)
                primitive["indices"] = gltf.accessor(std::vector<std::uint32_t>(n.begin(), n.end()),
                                                     component, "SCALAR");
            gltf.primitive(primitive);
            // Points and lines are not surfaces.
            primitive["mode"] = 0;
            gltf.primitive(primitive);
            const Mesh mesh = meshOf(gltf);
            ASSERT_EQ(mesh.triangles.size(), 2u) << way.mode;
            for (std::size_t t = 0; t < 2; ++t) EXPECT_NEAR(areaVector(mesh, t)[2], 0.5, 1e-7);
        }
    }
    // Three triangles by one strip, of which the second runs the other way.
    Gltf gltf;
    const std::vector<float> five{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0};
    gltf.primitive(
        {{"attributes", {{"POSITION", gltf.accessor(five, 5126, "VEC3")}}}, {"mode", 5}});
    const Mesh mesh = meshOf(gltf);
    ASSERT_EQ(mesh.triangles.size(), 3u);
    for (std::size_t t = 0; t < 3; ++t) EXPECT_NEAR(areaVector(mesh, t)[2], 0.5, 1e-7);
}

/// Two nodes above a cube; one mirrors it. The volume is the product of the scales.
TEST(GltfMesh, NodesPlaceMeshesAndMirrorsKeepTheirFront) {
    Gltf gltf = cube();
    const double half = std::sqrt(0.5);
    // Turned by 90 degrees about z, so that scales along x and y change places.
    gltf.json["nodes"] = {
        {{"children", {1, 2}}, {"scale", {2, 1, 1}}, {"translation", {10, 0, 0}}},
        {{"mesh", 0}, {"rotation", {0, 0, half, half}}, {"scale", {1, -3, 1}}},
        {{"mesh", 0}, {"matrix", {1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 20, 1}}}};
    const Mesh mesh = meshOf(gltf);
    ASSERT_EQ(mesh.triangles.size(), 24u);
    expectNormalsOfFaces(mesh);
    EXPECT_NEAR(volumeOf(mesh), 8 * 6 + 8 * 2, 1e-4);
    MeshVector least = mesh.positions[0], most = least;
    for (std::size_t v = 0; v < 8; ++v) {
        for (std::size_t i = 0; i < 3; ++i) {
            least[i] = std::min(least[i], mesh.positions[v][i]);
            most[i] = std::max(most[i], mesh.positions[v][i]);
        }
    }
    const MeshVector low{10 - 6, -1, -1}, high{10 + 6, 1, 1};
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(least[i], low[i], 1e-5);
        EXPECT_NEAR(most[i], high[i], 1e-5);
    }
}

/// Normals of a sphere that is stretched, turned and mirrored are normals of the ellipsoid.
TEST(GltfMesh, NormalsFollowTheirSurface) {
    const Mesh sphere = sphereMesh(2);
    std::vector<float> places;
    std::vector<std::uint32_t> order;
    for (const MeshVector& p : sphere.positions) places.insert(places.end(), p.begin(), p.end());
    for (const auto& t : sphere.triangles) order.insert(order.end(), t.begin(), t.end());
    for (const double mirror : {1.0, -1.0}) {
        Gltf gltf;
        const auto position = gltf.accessor(places, 5126, "VEC3");
        const auto indices = gltf.accessor(order, 5125, "SCALAR");
        gltf.primitive(
            {{"attributes", {{"POSITION", position}, {"NORMAL", position}}}, {"indices", indices}});
        gltf.json["nodes"][0]["scale"] = {2, 3 * mirror, 0.5};
        const MeshFile file = meshFromBytes(gltf.binary(), "test.glb");
        EXPECT_FALSE(file.computedNormals);
        EXPECT_GT(volumeOf(file.mesh), 0);
        for (std::size_t k = 0; k < file.mesh.normals.size(); ++k) {
            const MeshVector& p = file.mesh.positions[file.mesh.triangles[k / 3][k % 3]];
            const Vector n{p[0] / 4.0, p[1] / 9.0, p[2] / 0.25};
            const double length = std::hypot(n[0], n[1], n[2]);
            for (std::size_t i = 0; i < 3; ++i)
                EXPECT_NEAR(file.mesh.normals[k][i], n[i] / length, 1e-5);
        }
    }
}

TEST(GltfMesh, IntegersAndSparseValuesAreVertices) {
    // A square of normalised 16-bit numbers, of which the last corner is a sparse value.
    Gltf gltf;
    const std::vector<std::int16_t> corners{0, 0, 0, 32767, 0, 0, 32767, 32767, 0, 0, 0, 0};
    const auto position = gltf.accessor(corners, 5122, "VEC3");
    gltf.json["accessors"][position]["normalized"] = true;
    gltf.json["accessors"][position]["sparse"] = {
        {"count", 1},
        {"indices",
         {{"bufferView", gltf.view(bytesOf<std::uint8_t>({3}))}, {"componentType", 5121}}},
        {"values", {{"bufferView", gltf.view(bytesOf<std::int16_t>({0, 32767, 0}))}}}};
    gltf.primitive({{"attributes", {{"POSITION", position}}}, {"mode", 6}});
    gltf.json["extensionsRequired"] = {"KHR_mesh_quantization"};
    EXPECT_NEAR(areaOf(meshOf(gltf)), 1, 1e-6);
    gltf.json["accessors"][position]["sparse"]["indices"]["componentType"] = 5123;
    expectInputError([&] { meshOf(gltf); }, {"accessor 0, POSITION", "bufferView"});
}

TEST(GltfMesh, OfOtherProgramsIsTheSameMesh) {
    const std::string obj = test::sharedFolder() + "/data/mesh/wdas_teapot.obj";
    if (!std::filesystem::exists(obj)) GTEST_SKIP() << obj << " is absent";
    if (std::system("command -v gltfpack >/dev/null") != 0)
        GTEST_SKIP() << "gltfpack is not installed";
    const MeshFile expected = readMesh(obj);
    // 16 bits for positions, as in a file without -noq, over an extent of 6.4.
    struct Way {
        const char *options, *suffix;
        double tolerance;
    };
    for (const Way& way : {Way{"-noq", ".gltf", 1e-6}, Way{"-noq", ".glb", 1e-6},
                           Way{"-vp 16 -vn 16", ".glb", 3e-4}}) {
        const TemporaryFile file({}, way.suffix);
        const std::string call = std::string("gltfpack ") + way.options + " -i " + obj + " -o " +
                                 file.path() + " >/dev/null";
        ASSERT_EQ(std::system(call.c_str()), 0);
        const MeshFile read = readMesh(file.path());
        EXPECT_FALSE(read.computedNormals);
        EXPECT_NEAR(areaOf(read.mesh), areaOf(expected.mesh),
                    way.tolerance * areaOf(expected.mesh));
        EXPECT_NEAR(volumeOf(read.mesh), volumeOf(expected.mesh),
                    way.tolerance * volumeOf(expected.mesh));
        std::filesystem::remove(std::filesystem::path(file.path()).replace_extension(".bin"));
    }
    const TemporaryFile file({}, ".glb");
    const std::string call = "gltfpack -c -i " + obj + " -o " + file.path() + " >/dev/null";
    ASSERT_EQ(std::system(call.c_str()), 0);
    expectInputError([&] { readMesh(file.path()); }, {"EXT_meshopt_compression", "not read"});
}

TEST(GltfMesh, OfOurExportIsTheSameMesh) {
    const Mesh sphere = sphereMesh(3);
    GltfMaterial gold;
    gold.name = "gold";
    const std::string bytes = glbBytes(gold, surfaceOf(sphere));
    const MeshFile read = meshFromBytes(bytes, "gold.glb");
    EXPECT_FALSE(read.computedNormals);
    EXPECT_EQ(read.mesh.triangles.size(), sphere.triangles.size());
    EXPECT_NEAR(areaOf(read.mesh), areaOf(sphere), 1e-5);
    EXPECT_NEAR(volumeOf(read.mesh), volumeOf(sphere), 1e-5);
}

TEST(GltfMesh, BrokenFilesAreNamedWithThePlace) {
    const auto refuse = [](const char* pointer, const Json& value,
                           const std::vector<std::string>& parts) {
        Gltf gltf = cube();
        gltf.json[Json::json_pointer(pointer)] = value;
        expectInputError([&] { meshFromBytes(gltf.binary(), "a.glb"); }, parts);
        expectInputError([&] { meshFromBytes(gltf.embedded(), "a.gltf"); }, parts);
    };
    const std::size_t huge = std::size_t{1} << 62;
    refuse("/asset/version", "1.0", {"'asset.version' is '1.0'", "2.0"});
    refuse("/extensionsRequired", {"KHR_draco_mesh_compression"}, {"draco", "not read"});
    refuse("/accessors/0/count", 9, {"mesh 0, primitive 0", "accessor 0, POSITION", "9 values"});
    refuse("/accessors/0/count", huge, {"accessor 0, POSITION", "values"});
    refuse("/accessors/1/count", 1000, {"accessor 1, indices", "1000 values"});
    refuse("/accessors/0/byteOffset", huge, {"accessor 0"});
    refuse("/accessors/0/type", "VEC2", {"accessor 0", "type"});
    refuse("/accessors/0/componentType", 5130, {"accessor 0", "type"});
    refuse("/accessors/0/bufferView", 7, {"bufferView 7; there are 2"});
    refuse("/bufferViews/0/byteLength", huge, {"bufferView 0", "beyond its buffer"});
    refuse("/bufferViews/0/byteOffset", huge, {"bufferView 0", "beyond its buffer"});
    refuse("/bufferViews/0/buffer", 1, {"buffer 1; there are 1"});
    refuse("/meshes/0/primitives/0/mode", 9, {"mode 9"});
    refuse("/meshes/0/primitives/0/attributes/NORMAL", 1, {"NORMAL"});
    refuse("/meshes/0/primitives/0/indices", 5, {"accessor"});
    refuse("/nodes/0/mesh", 3, {"node 0", "mesh 3; there are 1"});
    refuse("/nodes/0/children", {0}, {"node 0", "twice"});
    refuse("/nodes/0/children", {-3}, {"node -3"});
    refuse("/nodes/0/scale", {1, 2}, {"'scale' has 2 numbers"});
    refuse("/nodes/0/scale", {0, 0, 1}, {"none of its 12 triangles has an area"});
    refuse("/nodes/0/rotation", {0, 0, 0, 0}, {"rotation", "unit quaternion"});
    refuse("/nodes/0/scale", {1e200, 1e200, 1e200}, {"scale", "1e+200"});
    refuse("/scene", 4, {"scene 4; there are 1"});
    refuse("/nodes", Json::array(), {"node 0; there are 0"});
    refuse("/meshes/0/primitives", Json::array(), {"no faces"});

    Gltf infinite = cube();
    const float nan = NAN;
    std::memcpy(infinite.buffer.data() + 4, &nan, sizeof nan);
    expectInputError([&] { meshOf(infinite); }, {"vertex 0", "nan"});
    Gltf beyond = cube();
    beyond.buffer[8 * 12] = 8;
    expectInputError([&] { meshOf(beyond); }, {"primitive 0", "vertex 8; there are 8"});
    Gltf deep = cube();
    for (int k = 0; k < 100; ++k) deep.json["extras"] = Json::array({deep.json["extras"]});
    expectInputError([&] { meshOf(deep); }, {"nested too deeply"});
    // A mesh that two levels of nodes repeat 10^10 times is refused at the first repetition.
    Gltf repeated = cube();
    repeated.json["nodes"] = Json::array({{{"children", std::vector<int>(100000, 1)}},
                                          {{"children", std::vector<int>(100000, 2)}},
                                          {{"mesh", 0}}});
    expectInputError([&] { meshOf(repeated); }, {"in the tree of nodes twice"});
    Gltf copies = cube();
    copies.json["buffers"] = Json::array();
    std::string text = copies.binary();
    expectInputError([&] { meshFromBytes(text.substr(0, 19), "a.glb"); }, {"header"});
    text[12] = '\xff', text[13] = '\xff', text[14] = '\xff', text[15] = '\xff';
    expectInputError([&] { meshFromBytes(text, "a.glb"); }, {"announces"});
}

TEST(GltfMesh, MembersOfAnotherTypeAreNamedWithTheirType) {
    const auto refuse = [](const char* pointer, const Json& value, const char* name,
                           const char* type) {
        Json json = Json::parse(cube().embedded());
        json[Json::json_pointer(pointer)] = value;
        expectInputError([&] { meshFromBytes(json.dump(), "a.gltf"); }, {"a.gltf", name, type});
    };
    for (const char* list : {"scenes", "nodes", "meshes", "accessors", "bufferViews", "buffers"}) {
        const std::string pointer = std::string("/") + list;
        refuse(pointer.c_str(), 1, list, "array of objects");
        refuse(pointer.c_str(), {{"command", 1}}, list, "array of objects");
        refuse(pointer.c_str(), {1}, (std::string(list) + "[0]").c_str(), "object");
    }
    refuse("/scene", "x", "'scene'", "number");
    refuse("/scenes/0/nodes", 0, "'scenes[0].nodes'", "array of numbers");
    refuse("/nodes/0/mesh", "0", "'nodes[0].mesh'", "number");
    refuse("/nodes/0/matrix", "x", "'nodes[0].matrix'", "array of numbers");
    refuse("/meshes/0/primitives", 1, "'meshes[0].primitives'", "array of objects");
    refuse("/meshes/0/primitives/0/attributes/POSITION", true, "attributes.POSITION'", "number");
    refuse("/accessors/0/normalized", 1, "'accessors[0].normalized'", "true or false");
    refuse("/accessors/0/sparse", 1, "'accessors[0].sparse'", "object");
    refuse("/bufferViews/0/byteOffset", {0}, "'bufferViews[0].byteOffset'", "number");
    refuse("/buffers/0/uri", 1, "'buffers[0].uri'", "string");
}

TEST(GltfMesh, BuffersStayInTheFolderOfTheFile) {
    const test::TemporaryFolder top;
    const Gltf gltf = cube();
    const auto put = [&](const std::string& name, const std::string& bytes) {
        std::filesystem::create_directories((top.path() / name).parent_path());
        std::ofstream(top / name, std::ios::binary) << bytes;
    };
    for (const char* name : {"outside.bin", "mesh/in side.bin", "mesh/below/inside.bin"})
        put(name, gltf.buffer);
    const auto read = [&](const std::string& uri) {
        put("mesh/a.gltf", gltf.beside(uri));
        return readMesh(top / "mesh/a.gltf").mesh.triangles.size();
    };
    for (const char* uri : {"in side.bin", "in%20side.bin", "below/inside.bin", "./in side.bin"})
        EXPECT_EQ(read(uri), 12U) << uri;
    for (const char* uri : {"../outside.bin", "%2e%2e/outside.bin", "below/../../outside.bin",
                            "..%2Foutside.bin", "..\\outside.bin", "../mesh/in side.bin"})
        expectInputError([&] { read(uri); }, {"in the folder", ".."});
    for (const std::string& uri : {top / "outside.bin", "file://" + (top / "outside.bin")})
        EXPECT_THROW(read(uri), InputError) << uri;
}

/// A GLB file of any shorter length, and of changed bytes, is refused or gives a whole mesh.
TEST(GltfMesh, TruncatedAndChangedFilesGiveAMeshOrAnError) {
    const std::string whole = cube().binary(), text = cube().embedded();
    const auto check = [](const std::string& bytes) {
        try {
            const Mesh mesh = meshFromBytes(bytes, "a.glb").mesh;
            ASSERT_EQ(mesh.normals.size(), 3 * mesh.triangles.size());
            for (const auto& t : mesh.triangles)
                for (const auto v : t) ASSERT_LT(v, mesh.positions.size());
            for (const MeshVector& n : mesh.normals)
                ASSERT_NEAR(std::hypot(n[0], n[1], n[2]), 1, 1e-5);
        } catch (const InputError&) {
        }
    };
    for (std::size_t length = 0; length < whole.size(); ++length)
        EXPECT_THROW(meshFromBytes(whole.substr(0, length), "a.glb"), InputError) << length;
    for (std::size_t length = 0; length + 1 < text.size(); ++length)
        EXPECT_THROW(meshFromBytes(text.substr(0, length), "a.gltf"), InputError) << length;
    std::mt19937 random(11);
    for (const std::string& good : {whole, text}) {
        for (int trial = 0; trial < 4000; ++trial) {
            std::string bytes = good;
            for (int change = 0; change < 2; ++change) {
                char& at = bytes[random() % bytes.size()];
                // Digits often, which are what sizes and indices are made of.
                at = random() % 2 == 0 ? static_cast<char>('0' + random() % 10)
                                       : static_cast<char>(random());
            }
            check(bytes);
        }
    }
}

}  // namespace
