// Meshes by their content, and files that attack their reader.

#include <hshfit/meshes/mesh_file.h>

#include "places.h"
#include "temporary_file.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>
#include <set>

using namespace hshfit;
using test::expectInputError;
using test::TemporaryFile;

namespace {

/// A cube of side 2 about the origin, as squares that face outwards.
constexpr const char* cubeVertices =
    "-1 -1 -1\n1 -1 -1\n1 1 -1\n-1 1 -1\n"
    "-1 -1 1\n1 -1 1\n1 1 1\n-1 1 1\n";
constexpr int cubeFaces[6][4] = {{3, 2, 1, 0}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                 {2, 3, 7, 6}, {1, 2, 6, 5}, {3, 0, 4, 7}};

std::string cubeObj() {
    std::string text;
    std::istringstream lines(cubeVertices);
    for (std::string line; std::getline(lines, line);) text += "v " + line + "\n";
    for (const auto& face : cubeFaces) {
        text += "f";
        for (const int v : face) text += " " + std::to_string(v + 1);
        text += "\n";
    }
    return text;
}

std::string header(const std::string& format, int vertices = 8, int faces = 6) {
    return "ply\nformat " + format + " 1.0\ncomment made by a test\nelement vertex " +
           std::to_string(vertices) +
           "\nproperty float x\nproperty float y\nproperty double z\nproperty uchar other\n"
           "element face " +
           std::to_string(faces) + "\nproperty list uchar int vertex_indices\nend_header\n";
}

std::string cubePly() {
    std::string text = header("ascii");
    std::istringstream lines(cubeVertices);
    for (std::string line; std::getline(lines, line);) text += line + " 7\n";
    for (const auto& face : cubeFaces) {
        text += "4";
        for (const int v : face) text += " " + std::to_string(v);
        text += "\n";
    }
    return text;
}

template <class Number>
void append(std::string& bytes, Number value, bool big) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    if (big) std::reverse(raw, raw + sizeof value);
    bytes.append(raw, sizeof value);
}

std::string cubeBinary(bool big) {
    std::string bytes = header(big ? "binary_big_endian" : "binary_little_endian");
    std::istringstream numbers(cubeVertices);
    for (int v = 0; v < 8; ++v) {
        float x = 0, y = 0;
        double z = 0;
        numbers >> x >> y >> z;
        append(bytes, x, big);
        append(bytes, y, big);
        append(bytes, z, big);
        bytes += '\7';
    }
    for (const auto& face : cubeFaces) {
        bytes += '\4';
        for (const int v : face) append(bytes, v, big);
    }
    return bytes;
}

double area(const Mesh& mesh) {
    double sum = 0;
    for (const auto& t : mesh.triangles) {
        double a[3], b[3];
        for (std::size_t i = 0; i < 3; ++i) {
            a[i] = mesh.positions[t[1]][i] - mesh.positions[t[0]][i];
            b[i] = mesh.positions[t[2]][i] - mesh.positions[t[0]][i];
        }
        sum += std::hypot(a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                          a[0] * b[1] - a[1] * b[0]) /
               2;
    }
    return sum;
}

void expectCube(const MeshFile& file) {
    const Mesh& mesh = file.mesh;
    EXPECT_EQ(mesh.positions.size(), 8u);
    ASSERT_EQ(mesh.triangles.size(), 12u);
    EXPECT_EQ(file.degenerate, 0u);
    EXPECT_TRUE(file.computedNormals);
    EXPECT_NEAR(area(mesh), 24, 1e-6);
    // Edges of 90 degrees are creases: vertices have the normal of their face, which points
    // outwards.
    for (std::size_t t = 0; t < 12; ++t) {
        for (std::size_t k = 0; k < 3; ++k) {
            const MeshVector& n = mesh.normals[3 * t + k];
            const MeshVector& p = mesh.positions[mesh.triangles[t][k]];
            EXPECT_NEAR(std::abs(n[0]) + std::abs(n[1]) + std::abs(n[2]), 1, 1e-6);
            EXPECT_NEAR(n[0] * p[0] + n[1] * p[1] + n[2] * p[2], 1, 1e-6);
        }
    }
}

TEST(MeshFile, EveryFormatGivesTheSameCube) {
    expectCube(readMesh(TemporaryFile(cubeObj(), ".obj").path()));
    expectCube(readMesh(TemporaryFile(cubePly(), ".ply").path()));
    expectCube(readMesh(TemporaryFile(cubeBinary(false)).path()));
    expectCube(readMesh(TemporaryFile(cubeBinary(true)).path()));
}

TEST(MeshFile, NormalsOfTheFileAreKeptAndMadeUnit) {
    const TemporaryFile file("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 3 4\nf 1//1 2//1 3//1\nf -3 -2 -1\n",
                             ".obj");
    const MeshFile read = readMesh(file.path());
    EXPECT_TRUE(read.computedNormals);
    EXPECT_NEAR(read.mesh.normals[0][1], 0.6, 1e-6);
    EXPECT_NEAR(read.mesh.normals[2][2], 0.8, 1e-6);
    EXPECT_NEAR(read.mesh.normals[3][2], 1, 1e-6) << "no normal: computed";
}

TEST(MeshFile, ComputedNormalsOfASphereAreRadial) {
    Mesh mesh = sphereMesh(4);
    const std::vector<MeshVector> exact = mesh.normals;
    mesh.normals.clear();
    completeNormals(mesh);
    double largest = 0;
    for (std::size_t k = 0; k < exact.size(); ++k) {
        for (std::size_t i = 0; i < 3; ++i) {
            largest = std::max(largest, double{std::abs(exact[k][i] - mesh.normals[k][i])});
        }
    }
    // Triangles of 5.6 degrees: what their corners see is symmetric but for the octahedron's tips.
    EXPECT_LT(largest, 0.01);
    EXPECT_NEAR(area(mesh), 4 * pi, 4 * pi * 0.005);
}

TEST(MeshFile, DegenerateTrianglesAreLeftOutAndCounted) {
    const TemporaryFile file("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 1 2\n", ".obj");
    const MeshFile read = readMesh(file.path());
    EXPECT_EQ(read.mesh.triangles.size(), 1u);
    EXPECT_EQ(read.degenerate, 1u);
}

TEST(MeshFile, SharedMeshesHaveTheirPublishedCounts) {
    const std::string folder = test::sharedFolder() + "/data/mesh/";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is absent";
    const MeshFile bunny = readMesh(folder + "bun_zipper_res3.ply");
    EXPECT_EQ(bunny.mesh.positions.size(), 1889u);
    EXPECT_EQ(bunny.mesh.triangles.size() + bunny.degenerate, 3851u);
    const MeshFile teapot = readMesh(folder + "wdas_teapot.obj");
    EXPECT_EQ(teapot.mesh.positions.size(), 3242u);
    EXPECT_FALSE(teapot.computedNormals);
}

TEST(MeshFile, BrokenFilesAreNamedWithThePlace) {
    const auto refuse = [](const std::string& content, const std::vector<std::string>& parts,
                           const std::string& suffix = ".obj") {
        const TemporaryFile file(content, suffix);
        expectInputError([&] { readMesh(file.path()); }, parts);
    };
    const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    refuse("hello\n", {"no faces"});
    refuse(triangle, {"no faces"});
    refuse("v 0 0 nan\n" + triangle + "f 1 2 3\n", {"line 1", "nan"});
    refuse("v 0 0\n", {"line 1", "2 words"});
    refuse("v 0 0 1e30\n" + triangle + "f 1 2 3\n", {"vertex 0", "finite"});
    refuse("v 0 0 1e999\n" + triangle + "f 1 2 3\n", {"vertex 0", "finite"});
    refuse(triangle + "f 1 2 9\n", {"vertex"});
    for (const char* corner : {"1.9", "1e0", "1/x", "1/2/3/4", "1//", "nan", "2,"})
        refuse(triangle + "f 1 2 " + corner + "\n", {"line 4", corner, "three corners"});
    for (const char* number : {"1e", "1.2.3", "--1", "1-2"})
        refuse("v 0 0 " + std::string(number) + "\n" + triangle + "f 1 2 3\n", {"line 1", number});
    refuse(triangle + "f 1 1 2\n", {"area"});
    refuse(std::string("v 0 0 0\n\0", 9), {"neither"});
    refuse("ply\n", {"header"}, ".ply");
    refuse("ply\nformat ascii 1.0\nend_header\n", {"vertex"}, ".ply");
    refuse("ply\nformat ebcdic 1.0\nend_header\n", {"ebcdic", "ascii"}, ".ply");
    refuse(header("ascii", 1 << 30, 1), {"announced"}, ".ply");
    std::string ply = cubePly();
    refuse(std::string(ply).replace(ply.find("-1 -1 -1"), 8, "nan -1 -1"), {"vertex 0", "nan"},
           ".ply");
    refuse(std::string(ply).replace(ply.rfind('7'), 1, "8"), {"vertex 8", "there are 8"}, ".ply");
    refuse(std::string(ply).replace(ply.find("uchar int"), 9, "float int"), {"integer"}, ".ply");
    for (const auto& [type, value] : {std::pair{"int", "0.9"},
                                      {"int", "2e0.5"},
                                      {"int", "3000000000"},
                                      {"uchar", "256"},
                                      {"uint", "-1"},
                                      {"short", "40000"}}) {
        std::string wrong = ply;
        wrong.replace(wrong.find("uchar int"), 9, std::string("uchar ") + type);
        refuse(wrong.replace(wrong.rfind('7'), 1, value), {"element face 5", value}, ".ply");
    }
    refuse(std::string(ply).replace(ply.find("uchar int"), 9, "uchar float"), {"integers"}, ".ply");
    refuse(std::string(ply).replace(ply.find("\n4 ") + 1, 1, "4.5"), {"4.5", "uchar"}, ".ply");
    refuse(ply.replace(ply.find("element face"), 12, "element vertex"), {"twice"}, ".ply");
    EXPECT_THROW(readMesh("absent.obj"), InputError);
}

/// A regular polygon in the plane.
std::string polygon(int corners) {
    std::string text, face = "f";
    for (int k = 0; k < corners; ++k) {
        const double turn = 2 * pi * k / corners;
        text += fmt::format("v {} {} 0\n", std::cos(turn), std::sin(turn));
        face += fmt::format(" {}", k + 1);
    }
    return text + face + "\n";
}

TEST(MeshFile, PolygonsOfManyCornersAreCutOrRefused) {
    EXPECT_EQ(meshFromBytes(polygon(2000), "a.obj").mesh.triangles.size(), 1998U);
    for (const int corners : {10'000, 100'000})
        expectInputError([&] { meshFromBytes(polygon(corners), "a.obj"); },
                         {fmt::format("line {}", corners + 1), fmt::format("{} corners", corners)});
    // Many faces together take as long as one.
    const std::string face = polygon(2000), line = face.substr(face.find('f'));
    std::string many = face;
    for (int k = 0; k < 30; ++k) many += line;
    expectInputError([&] { meshFromBytes(many, "a.obj"); }, {"line 2017", "2000 corners"});
}

TEST(MeshFile, EveryTruncationIsRefusedOrAWholePart) {
    for (const std::string& whole : {cubeObj(), cubePly(), cubeBinary(false), cubeBinary(true)}) {
        const bool ply = whole.starts_with("ply");
        for (std::size_t length = 1; length < whole.size(); ++length) {
            const TemporaryFile file(whole.substr(0, length), ".mesh");
            try {
                const MeshFile read = readMesh(file.path());
                // A PLY file says how much there is; only the last line feed may be missing.
                EXPECT_TRUE(!ply || length + 2 >= whole.size()) << length;
                EXPECT_LE(read.mesh.triangles.size(), 12u);
            } catch (const InputError&) {
            }
        }
    }
}

TEST(MeshFile, ChangedBytesGiveAMeshOrAnError) {
    std::mt19937 random(5);
    for (const std::string& whole : {cubeObj(), cubePly(), cubeBinary(false), cubeBinary(true)}) {
        for (int trial = 0; trial < 400; ++trial) {
            std::string bytes = whole;
            for (int change = 0; change < 3; ++change) {
                bytes[random() % bytes.size()] = static_cast<char>(random());
            }
            const TemporaryFile file(bytes, ".mesh");
            try {
                const Mesh mesh = readMesh(file.path()).mesh;
                ASSERT_EQ(mesh.normals.size(), 3 * mesh.triangles.size());
                for (const auto& t : mesh.triangles) {
                    for (const auto v : t) ASSERT_LT(v, mesh.positions.size());
                }
                for (const MeshVector& n : mesh.normals) {
                    ASSERT_NEAR(std::hypot(n[0], n[1], n[2]), 1, 1e-5);
                }
            } catch (const InputError&) {
            }
        }
    }
}

}  // namespace
