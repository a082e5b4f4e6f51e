// Surfaces of standard materials: closed forms of the sphere, and the rules of glTF's vertices.
#include <hshfit/error.h>
#include <hshfit/materials/glb.h>
#include <hshfit/materials/materialx.h>
#include <hshfit/materials/surface.h>
#include <hshfit/materials/usd.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace hshfit {
namespace {

using Vector = std::array<double, 3>;

Vector at(const std::array<float, 3>& v) {
    return {v[0], v[1], v[2]};
}
Vector minus(const Vector& a, const Vector& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Vector cross(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double dotOf(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Six times the volume, positive if triangles run counterclockwise seen from outside.
double sixVolumes(const Surface& surface) {
    double sum = 0;
    for (std::size_t k = 0; k < surface.indices.size(); k += 3)
        sum += dotOf(at(surface.positions[surface.indices[k]]),
                     cross(at(surface.positions[surface.indices[k + 1]]),
                           at(surface.positions[surface.indices[k + 2]])));
    return sum;
}

void expectVertices(const Surface& surface) {
    ASSERT_EQ(surface.positions.size(), surface.normals.size());
    ASSERT_EQ(surface.positions.size(), surface.tangents.size());
    for (std::size_t k = 0; k < surface.normals.size(); ++k) {
        const Vector n = at(surface.normals[k]);
        const auto& own = surface.tangents[k];
        const Vector t{own[0], own[1], own[2]};
        EXPECT_NEAR(dotOf(n, n), 1, 1e-5);
        EXPECT_NEAR(dotOf(t, t), 1, 1e-5);
        EXPECT_NEAR(dotOf(n, t), 0, 1e-5);
        EXPECT_EQ(own[3], 1);
    }
    for (const std::uint32_t index : surface.indices) EXPECT_LT(index, surface.positions.size());
}

TEST(Surfaces, SphereHasItsVolumeAndNormals) {
    const Surface sphere = sphereSurface(64);
    expectVertices(sphere);
    EXPECT_NEAR(sixVolumes(sphere) / 6, 4 * pi / 3, 4 * pi / 3 * 0.005);
    for (std::size_t k = 0; k < sphere.positions.size(); ++k)
        EXPECT_EQ(sphere.positions[k], sphere.normals[k]);
    EXPECT_THROW(sphereSurface(1), UsageError);
    EXPECT_THROW(sphereSurface(5000), UsageError);
}

// Texture coordinates grow along the tangent: derivatives of position by u.
TEST(Surfaces, TangentIsTheDirectionOfU) {
    const int rings = 32, row = 2 * rings + 1;
    const Surface sphere = sphereSurface(rings);
    for (int i = 1; i < rings; ++i) {
        for (int j = 0; j + 1 < row; ++j) {
            const std::size_t k = i * row + j;
            ASSERT_GT(sphere.coordinates[k + 1][0], sphere.coordinates[k][0]);
            const Vector step = minus(at(sphere.positions[k + 1]), at(sphere.positions[k]));
            const auto& t = sphere.tangents[k];
            const double along = step[0] * t[0] + step[1] * t[1] + step[2] * t[2];
            EXPECT_NEAR(along, std::sqrt(dotOf(step, step)), 0.002 * along);
        }
    }
}

TEST(Surfaces, MeshKeepsTrianglesAndSharesVertices) {
    Mesh mesh = sphereMesh(3);
    completeNormals(mesh);
    const Surface surface = surfaceOf(mesh);
    expectVertices(surface);
    EXPECT_EQ(surface.indices.size(), 3 * mesh.triangles.size());
    EXPECT_LT(surface.positions.size(), mesh.triangles.size());
    EXPECT_GT(sixVolumes(surface), 0);
}

TEST(Materials, GlbRefusesNumbersThatAreNotFinite) {
    GltfMaterial material{.name = "m",
                          .baseColour = {1, 1, 1},
                          .metallic = 1,
                          .roughness = 1,
                          .ior = {},
                          .specular = {},
                          .sheen = {},
                          .clearcoat = {},
                          .anisotropy = {},
                          .iridescence = {}};
    material.roughness = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(glbBytes(material, sphereSurface(4)), NumericError);
    material.roughness = 0.5;
    EXPECT_THROW(glbBytes(material, {}), UsageError);
    material.ior = std::numeric_limits<double>::infinity();
    EXPECT_THROW(glbBytes(material, sphereSurface(4)), NumericError);
}

TEST(Materials, MaterialXNamesAreValid) {
    EXPECT_EQ(materialXName("satin rosaline"), "satin_rosaline");
    EXPECT_EQ(materialXName("3m"), "M_3m");
    EXPECT_EQ(materialXName(""), "M_");
    EXPECT_EQ(materialXName("a\xc3\xbc<b>"), "a___b_");
    EXPECT_THROW(materialXText("m", "gltf_pbr", {{"x", {1, 2}}}, ""), UsageError);
    EXPECT_THROW(
        materialXText("m", "gltf_pbr", {{"x", {std::numeric_limits<double>::infinity()}}}, ""),
        NumericError);
}

/// A string of a layer ends at the first quote that no backslash precedes (OpenUSD's text format).
TEST(Materials, UsdKeepsTextsAndRefusesWhatALayerCannotHold) {
    const Surface sphere = sphereSurface(4);
    const std::string layer = usdText("3m", "3m.mtlx", {}, sphere, "a \"b\" \\ c\nd");
    EXPECT_NE(layer.find(R"(doc = "a \"b\" \\ c d")"), std::string::npos);
    EXPECT_NE(layer.find("@./3m.mtlx@</MaterialX/Materials/M_3m>"), std::string::npos);
    EXPECT_NE(layer.find("outputs:surface.connect = </M_3m/Material/PreviewSurface.outputs"),
              std::string::npos);
    for (const char* path : {"a@b.mtlx", "a\nb.mtlx", ""})
        EXPECT_THROW(usdText("m", path, {}, sphere, ""), UsageError) << path;
    EXPECT_THROW(usdText("m", "m.mtlx", {}, {}, ""), UsageError);
    UsdPreviewSurface material;
    material.roughness = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(usdText("m", "m.mtlx", material, sphere, ""), NumericError);
    Surface broken = sphere;
    broken.positions[3][1] = std::numeric_limits<float>::infinity();
    EXPECT_THROW(usdText("m", "m.mtlx", {}, broken, ""), NumericError);
}

}  // namespace
}  // namespace hshfit
