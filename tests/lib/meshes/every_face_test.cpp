// Every face that a file states is in the mesh: areas and triangles of files as programs write
// them.

#include <hshfit/meshes/mesh_file.h>

#include "temporary_file.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

using namespace hshfit;
using test::expectInputError;

namespace {

constexpr const char* byteOrderMark = "\xef\xbb\xbf";

/// The areas of all triangles, and of their sum as vectors, which is less where some are turned.
struct Areas {
    double sum = 0, along = 0;
};
Areas areasOf(const Mesh& mesh) {
    Areas areas;
    double total[3] = {};
    for (const auto& t : mesh.triangles) {
        double a[3], b[3], n[3];
        for (std::size_t i = 0; i < 3; ++i) {
            a[i] = double{mesh.positions[t[1]][i]} - double{mesh.positions[t[0]][i]};
            b[i] = double{mesh.positions[t[2]][i]} - double{mesh.positions[t[0]][i]};
        }
        for (std::size_t i = 0; i < 3; ++i) {
            n[i] = (a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3]) / 2;
            total[i] += n[i];
        }
        areas.sum += std::hypot(n[0], n[1], n[2]);
    }
    areas.along = std::hypot(total[0], total[1], total[2]);
    return areas;
}

void expectArea(const std::string& bytes, double area, std::size_t triangles) {
    const Mesh mesh = meshFromBytes(bytes, "a mesh").mesh;
    EXPECT_EQ(mesh.triangles.size(), triangles) << bytes.substr(0, 200);
    EXPECT_NEAR(areasOf(mesh).sum, area, 1e-5 * area) << bytes.substr(0, 200);
    EXPECT_NEAR(areasOf(mesh).along, area, 1e-5 * area) << "a triangle is turned";
}

using Outline = std::vector<std::array<double, 2>>;

/// The outline as a face in the plane z = 2 x - y + 1, where areas are sqrt(6) times as large.
std::string obj(const Outline& outline) {
    std::string text, face = "f";
    for (std::size_t k = 0; k < outline.size(); ++k) {
        const auto [x, y] = outline[k];
        text += fmt::format("v {} {} {}\n", x, y, 2 * x - y + 1);
        face += fmt::format(" {}", k + 1);
    }
    return text + face + "\n";
}
std::string ply(const Outline& outline) {
    std::string text = fmt::format(
        "ply\nformat ascii 1.0\nelement face 1\nproperty list uint int vertex_indices\n"
        "element vertex {}\nproperty float x\nproperty float y\nproperty float z\nend_header\n{}",
        outline.size(), outline.size());
    for (std::size_t k = 0; k < outline.size(); ++k) text += fmt::format(" {}", k);
    text += "\n";
    for (const auto& [x, y] : outline) text += fmt::format("{} {} {}\n", x, y, 2 * x - y + 1);
    return text;
}

double shoelace(const Outline& outline) {
    double sum = 0;
    for (std::size_t k = 0; k < outline.size(); ++k) {
        const auto &a = outline[k], &b = outline[(k + 1) % outline.size()];
        sum += a[0] * b[1] - a[1] * b[0];
    }
    return std::abs(sum) / 2;
}

TEST(EveryFace, PolygonsThatAreNotConvexKeepTheirArea) {
    std::vector<Outline> outlines{
        {{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}},  // an L
        {{0, 0}, {2, -1}, {0.5, 0}, {2, 1}},               // an arrow
        {{2, 1}, {0, 0}, {2, -1}, {0.5, 0}},               // from its barb
        {{0, 0}, {5, 0}, {5, 5}, {0, 5}, {0, 1}, {1, 1}, {1, 4}, {4, 4}, {4, 1}, {0, 0.5}},
        {{0, 0}, {1, 0}, {2, 0}, {3, 0}, {3, 1}, {2, 0.1}, {1, 1}, {0, 0.1}}};  // on one line
    std::mt19937 random(4);
    std::uniform_real_distribution<double> radius(0.1, 1);
    for (const int corners : {5, 9, 40, 300}) {
        Outline star;
        for (int k = 0; k < corners; ++k) {
            const double at = 2 * pi * k / corners, r = radius(random);
            star.push_back({r * std::cos(at), r * std::sin(at)});
        }
        outlines.push_back(star);
    }
    for (Outline outline : outlines) {
        for (int turned = 0; turned < 2; ++turned) {
            const double area = std::sqrt(6.0) * shoelace(outline);
            expectArea(obj(outline), area, outline.size() - 2);
            expectArea(ply(outline), area, outline.size() - 2);
            std::reverse(outline.begin(), outline.end());
        }
    }
}

const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST(EveryFace, ByteOrderMarksAndLineEndsAreNoContent) {
    expectArea(byteOrderMark + square + "f 1 2 3 4\n", 1, 2);
    expectArea(byteOrderMark + ply({{0, 0}, {1, 0}, {1, 1}, {0, 1}}), std::sqrt(6.0), 2);
    for (const char* end : {"\r\n", "\r"}) {
        std::string text;
        for (const char c : square + "f 1 2 3 4\n") text += c == '\n' ? end : std::string(1, c);
        expectArea(text, 1, 2);
    }
    expectArea(square + "f 1 2 3 4", 1, 2);
}

TEST(EveryFace, ContinuedLinesAreOneStatement) {
    for (const char* joint : {" \\\n", "\\\n", " \\ \n ", "\\\r\n", "\\\n\\\n"}) {
        expectArea(square + "f 1 2" + joint + "3 4\n", 1, 2);
        expectArea("v 0 0" + std::string(joint) + "0\n" + square.substr(8) + "f 1 2 3 4\n", 1, 2);
    }
    expectArea(square + "# a remark \\\nf 1 2 3\nf 1 2 3 4\n", 1, 2);  // of two lines
    expectArea(square + "f 1 2 3 4 # and a remark\n", 1, 2);
}

TEST(EveryFace, IndicesOfDataThatAreNotThereKeepTheFace) {
    expectArea(square + "f 1/1 2/2 3/3 4/4\n", 1, 2);  // no texture coordinates
    expectArea(square + "f -4 -3 -2 -1\n", 1, 2);      // from the last vertex
    expectArea(square + "fo 1 2 3 4\n", 1, 2);         // the older word
    expectArea("f 1 2 3 4\n" + square, 1, 2);          // before its vertices
    for (const char* face : {"f 1//1 2//1 3//1\n", "f 0 1 2\n", "f -5 1 2\n", "f 1 2 5\n"})
        expectInputError([&] { meshFromBytes(square + face, "a.obj"); }, {"line 5", "there are"});
    expectInputError(
        [&] {
            std::string text = ply({{0, 0}, {1, 0}, {1, 1}});
            meshFromBytes(text.replace(text.find("\n3 0 1 2"), 8, "\n2 0 1"), "a.ply");
        },
        {"element face 0", "2 corners"});
}

/// Triangle strips of 3 x 3 squares, row after row with -1 between, as scanned models come.
std::string strips(bool restartAtTheEnd) {
    std::string text =
        "ply\nformat ascii 1.0\nelement vertex 16\nproperty float x\nproperty float y\n"
        "property float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n";
    for (int k = 0; k < 16; ++k) text += fmt::format("{} {} 0\n", k % 4, k / 4);
    std::string indices;
    int count = 0;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 4; ++column, count += 2)
            indices += fmt::format(" {} {}", 4 * row + 4 + column, 4 * row + column);
        if (row < 2 || restartAtTheEnd) indices += " -1", ++count;
    }
    return text + std::to_string(count) + indices + "\n";
}

TEST(EveryFace, TriangleStripsOfPlyFilesAreRead) {
    expectArea(strips(false), 9, 18);
    expectArea(strips(true), 9, 18);
    std::string wrong = strips(false);
    wrong[wrong.rfind("15") + 1] = '6';
    expectInputError([&] { meshFromBytes(wrong, "a.ply"); },
                     {"tristrips 0", "vertex 16", "there are 16"});
}

}  // namespace
