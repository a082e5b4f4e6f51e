#include <hshfit/bases/catalog.h>
#include <hshfit/brdf/vectors.h>
#include <hshfit/error.h>
#include <hshfit/precomputed_transfer/internal/closed_form.h>
#include <hshfit/precomputed_transfer/interreflection.h>
#include <hshfit/precomputed_transfer/matrix_clusters.h>
#include <hshfit/projection/projection.h>
#include <hshfit/quadrature/quadrature.h>
#include <hshfit/rendering/view.h>

#include <brdfs/catalog.h>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <limits>
#include <map>
#include <mutex>

namespace hshfit {
namespace {

SurfaceObject objectOf(const std::string& name, Mesh mesh) {
    completeNormals(mesh);
    return {name, std::move(mesh), 0, {}};
}

Mesh moved(Mesh mesh, float factor, const MeshVector& by) {
    for (MeshVector& p : mesh.positions)
        for (std::size_t k = 0; k < 3; ++k) p[k] = factor * p[k] + by[k];
    return mesh;
}

/// A cube from -1 to 1, with an edge of its own at every side.
Mesh cube() {
    Mesh mesh;
    for (std::uint32_t v = 0; v < 8; ++v)
        mesh.positions.push_back({v & 1 ? 1.F : -1.F, v & 2 ? 1.F : -1.F, v & 4 ? 1.F : -1.F});
    const std::array<std::array<std::uint32_t, 4>, 6> sides{
        {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
    for (const auto& s : sides) {
        mesh.triangles.push_back({s[0], s[1], s[2]});
        mesh.triangles.push_back({s[0], s[2], s[3]});
    }
    return mesh;
}

/// A sphere's inside below a height.
Mesh bowl(float height) {
    Mesh mesh = sphereMesh(3);
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
    std::erase_if(mesh.triangles, [&](const auto& t) { return mesh.positions[t[0]][2] > height; });
    mesh.normals.clear();
    return mesh;
}

struct Furnace {
    std::string name;
    std::vector<SurfaceObject> objects;
    int passes;
};

/// Scenes of albedo 1 in even light: whatever the shape, nothing of it can be seen.
std::vector<Furnace> furnaces() {
    std::vector<Furnace> all;
    all.push_back({"sphere", {objectOf("ball", sphereMesh(2))}, 2});
    all.push_back({"bowl", {objectOf("bowl", bowl(0.2F))}, 60});
    all.push_back({"deep bowl", {objectOf("bowl", bowl(0.8F))}, 400});
    all.push_back({"box on a floor",
                   {objectOf("box", moved(cube(), 0.5F, {0, 0, 0.5F})),
                    objectOf("floor", moved(squareMesh(), 2, {}))},
                   40});
    all.push_back({"thin walls",
                   {objectOf("one", moved(squareMesh(), 1, {})),
                    objectOf("two", moved(squareMesh(), 1, {0, 0, 1e-3F})),
                    objectOf("three", moved(squareMesh(), 1, {0, 0, 0.5F}))},
                   4000});
    all.push_back(
        {"walls at one place", {objectOf("one", squareMesh()), objectOf("two", squareMesh())}, 2});
    return all;
}

double brightness(const std::vector<float>& vectors, std::size_t at) {
    return std::sqrt(4 * pi) * static_cast<double>(vectors[at]);
}

TEST(PrecomputedTransfer, HidesWhiteScenesInAFurnace) {
    for (const Furnace& furnace : furnaces()) {
        const TransferMesh mesh = transferMesh(furnace.objects, {.edge = 0.5});
        const GatheredTransfer gathered = gather(mesh, rayScene(mesh), {.order = 2, .rays = 225});
        const std::vector<TransferMaterial> white{
            {.name = "white", .source = {}, .albedo = {1, 1, 1}}};
        const InterreflectedTransfer result =
            interreflect(mesh, gathered, white, {.passes = furnace.passes});
        double worst = 0;
        std::size_t where = 0;
        for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
            const double off = std::abs(brightness(result.vectors, v * 4) - 1);
            if (off > worst) worst = off, where = v;
        }
        EXPECT_LE(worst, 1e-3) << furnace.name << " at vertex " << where;
    }
}

/// Sums over a hemisphere about a normal, exact for harmonics of low degree.
template <class F>
void overHemisphere(const Direction& normal, F&& add) {
    const GaussRule& rule = gaussLegendre(24);
    const Frame frame = rendering::frameAt(normal);
    constexpr int azimuths = 48;
    for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
        const double u = (1 + rule.nodes[k]) / 2;
        for (int a = 0; a < azimuths; ++a) {
            // The rule is in the square root of mu, in which functions of odd m are smooth.
            const Direction local =
                directionFromAngles(std::acos(u * u), 2 * pi * (a + 0.5) / azimuths);
            add(local, frame.toWorld(local), rule.weights[k] * u * 2 * pi / azimuths);
        }
    }
}

TEST(PrecomputedTransfer, IsTheIntegralOverTheHemisphereWhereNothingIsInTheWay) {
    constexpr int order = 5, localOrder = 4;
    const auto harmonics = bases::make("sh", order), local = bases::make("hsh", localOrder);
    const ClosedForm form(order, localOrder);
    for (const Direction& n : {Direction{0, 0, 1}, Direction{0, 0, -1}, Direction{0.48, -0.6, 0.64},
                               Direction{-0.6, 0, -0.8}}) {
        const MeshVector normal{static_cast<float>(n.x), static_cast<float>(n.y),
                                static_cast<float>(n.z)};
        std::vector<double> vector(25), matrix(16 * 25), y(25), h(16);
        overHemisphere(n, [&](const Direction& d, const Direction& world, double weight) {
            harmonics->evaluate(world, y.data());
            local->evaluate(d, h.data());
            for (std::size_t i = 0; i < 25; ++i) {
                vector[i] += weight * d.z * y[i] / pi;
                for (std::size_t j = 0; j < 16; ++j) matrix[j * 25 + i] += weight * h[j] * y[i];
            }
        });
        std::vector<float> found(25), foundMatrix(16 * 25);
        form.vector(normal, found.data());
        form.matrix(normal, foundMatrix.data());
        for (std::size_t i = 0; i < 25; ++i) EXPECT_NEAR(found[i], vector[i], 1e-6) << i;
        for (std::size_t e = 0; e < matrix.size(); ++e)
            EXPECT_NEAR(foundMatrix[e], matrix[e], 1e-5) << e;
    }
}

/// Radiance of a tilted plane under light of three bands by c(wo)^T M L, against the integral of
/// f cos(theta_i) L; the anisotropic materials tell their axes apart.
TEST(PrecomputedTransfer, ReflectsByAnyBrdfInTheFrameOfTheVertex) {
    constexpr int order = 3, localOrder = 7;
    const auto harmonics = bases::make("sh", order);
    const ClosedForm form(order, localOrder);
    const MeshVector normal{0.48F, -0.6F, 0.64F};
    const Direction n = normalised(directionOf(normal));
    const Frame frame = rendering::frameAt(n);
    std::vector<float> matrix(49 * 9);
    form.matrix(normal, matrix.data());
    const std::array<double, 9> light{3, 0.3, -0.5, 0.6, 0.4, -0.2, 0.3, -0.4, 0.5};
    for (const char* spec : {"ward:ax=.2,ay=.6", "ggx:ax=.6,ay=.25", "ggx:alpha=.4"}) {
        const auto brdf = brdfs::open(spec);
        const TransferMaterial material = transferMaterial(spec, *brdf, localOrder);
        ASSERT_TRUE(material.response);
        for (const Direction& wo :
             {directionFromAngles(radians(25), radians(40)), directionFromAngles(radians(50), 3)}) {
            double expected = 0;
            std::vector<double> y(9);
            overHemisphere(n, [&](const Direction& d, const Direction&, double weight) {
                harmonics->evaluate(frame.toWorld(d), y.data());
                double radiance = 0;
                for (std::size_t i = 0; i < 9; ++i) radiance += light[i] * y[i];
                expected += weight * d.z * evaluate(*brdf, d, wo)[0] * radiance;
            });
            std::vector<double> response(3 * 49);
            material.towards(wo, response);
            double found = 0;
            for (std::size_t j = 0; j < 49; ++j)
                for (std::size_t i = 0; i < 9; ++i)
                    found += response[j] * static_cast<double>(matrix[j * 9 + i]) * light[i];
            EXPECT_NEAR(found, expected, 0.01 * std::abs(expected)) << spec;
        }
    }
}

/// A vertex of a floor at the foot of an endless wall sees half of the sky.
TEST(PrecomputedTransfer, IsTheIntegralOverTheOpenHalfAtTheFootOfAWall) {
    Mesh wall;
    wall.positions = {{0, -1e4F, -1}, {0, 1e4F, -1}, {0, 1e4F, 1e4F}, {0, -1e4F, 1e4F}};
    wall.triangles = {{0, 2, 1}, {0, 3, 2}};
    const std::vector<SurfaceObject> objects{
        objectOf("floor", moved(squareMesh(), 0.01F, {-0.0105F, 0, 0})), objectOf("wall", wall)};
    const TransferMesh mesh = transferMesh(objects, {.edge = 0, .sides = Sides::front});
    const GatheredTransfer gathered = gather(mesh, rayScene(mesh), {.order = 4});
    const auto harmonics = bases::make("sh", 4);
    std::vector<double> expected(16), y(16);
    overHemisphere({0, 0, 1}, [&](const Direction&, const Direction& world, double weight) {
        if (world.x > 0) return;
        harmonics->evaluate(world, y.data());
        for (std::size_t i = 0; i < 16; ++i) expected[i] += weight * world.z * y[i] / pi;
    });
    for (std::size_t v = 0; v < 4; ++v) {
        for (std::size_t i = 0; i < 16; ++i)
            EXPECT_NEAR(gathered.shadowed[v * 16 + i], expected[i], 5e-3) << v << " " << i;
    }
    EXPECT_LE(gathered.noise, 0.03);
}

/// A point of a sphere sees equal areas of it alike: of a bowl that lacks the share s, each pass
/// of albedo rho has rho (1 - s) of the light before.
TEST(PrecomputedTransfer, LosesTheSameShareInEachPassInABowl) {
    const std::vector<SurfaceObject> objects{objectOf("bowl", bowl(0.45F))};
    const TransferMesh mesh = transferMesh(objects, {.edge = 0, .sides = Sides::front});
    const auto areaOf = [](const TransferMesh& any) {
        double area = 0;
        for (const TransferVertex& vertex : any.vertices) area += vertex.area;
        return area;
    };
    const double whole = areaOf(transferMesh(std::vector{objectOf("all", bowl(2))}, {.edge = 0}));
    const double open = 1 - areaOf(mesh) / whole, albedo = 0.7;
    const GatheredTransfer gathered = gather(mesh, rayScene(mesh), {.order = 1, .rays = 400});
    const std::vector<TransferMaterial> grey{
        {.name = "grey", .source = {}, .albedo = {albedo, albedo, albedo}}};
    const InterreflectedTransfer result = interreflect(mesh, gathered, grey, {.passes = 8});
    ASSERT_EQ(result.energy.size(), 9);
    EXPECT_NEAR(result.energy[0], albedo * open, 0.02 * albedo * open);
    for (std::size_t k = 1; k < 9; ++k) {
        EXPECT_NEAR(result.energy[k] / result.energy[k - 1], albedo * (1 - open),
                    0.02 * albedo * (1 - open))
            << k;
    }
}

std::vector<SurfaceObject> corner() {
    Mesh wall = squareMesh();
    for (MeshVector& p : wall.positions) p = {-1, p[0], p[1] + 1};
    return {objectOf("floor", squareMesh()), objectOf("wall", wall),
            objectOf("ball", moved(sphereMesh(1), 0.3F, {0.1F, 0.2F, 0.4F}))};
}

TEST(PrecomputedTransfer, HasTheSameBitsOnAnyNumberOfThreads) {
    const TransferMesh mesh = transferMesh(corner(), {.edge = 0.5});
    const std::vector<TransferMaterial> red{
        {.name = "red", .source = {}, .albedo = {0.8, 0.3, 0.2}}};
    const auto run = [&] {
        const GatheredTransfer gathered =
            gather(mesh, rayScene(mesh), {.order = 3, .rays = 100, .localOrder = 2});
        InterreflectedTransfer result = interreflect(mesh, gathered, red, {.passes = 2});
        const MatrixClusters clusters = clusterMatrices(
            {.order = 3, .localOrder = 2, .channels = 3, .matrices = result.matrices},
            {.clusters = 4, .components = 3});
        result.vectors.insert(result.vectors.end(), clusters.weights.begin(),
                              clusters.weights.end());
        return result;
    };
    const InterreflectedTransfer many = run();
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    const InterreflectedTransfer single = run();
    EXPECT_EQ(many.vectors, single.vectors);
    EXPECT_EQ(many.matrices, single.matrices);
    EXPECT_EQ(many.energy, single.energy);
}

/// A run that takes every other part from an earlier one has the same bits.
TEST(PrecomputedTransfer, GoesOnFromKeptParts) {
    const TransferMesh mesh = transferMesh(corner(), {.edge = 0.3});
    const std::vector<TransferMaterial> red{
        {.name = "red", .source = {}, .albedo = {0.8, 0.3, 0.2}}};
    std::mutex mutex;
    std::map<std::uint64_t, std::vector<std::byte>> parts, passes;
    const auto keepIn = [&](auto& map) {
        return [&](std::uint64_t part, std::span<const std::byte> bytes) {
            const std::lock_guard lock(mutex);
            map[part].assign(bytes.begin(), bytes.end());
        };
    };
    const auto findIn = [&](auto& map) {
        return [&](std::uint64_t part) -> std::optional<std::vector<std::byte>> {
            const auto found = map.find(part);
            if (part % 2 == 1 || found == map.end()) return {};
            return found->second;
        };
    };
    GatheringOptions gathering{.order = 3, .rays = 64, .localOrder = 2};
    InterreflectionOptions interreflection{.passes = 3};
    gathering.kept.keep = keepIn(parts);
    interreflection.kept.keep = keepIn(passes);
    const GatheredTransfer once = gather(mesh, rayScene(mesh), gathering);
    const InterreflectedTransfer all = interreflect(mesh, once, red, interreflection);
    gathering.kept = {.find = findIn(parts)};
    interreflection.kept = {.find = findIn(passes)};
    const GatheredTransfer again = gather(mesh, rayScene(mesh), gathering);
    const InterreflectedTransfer allAgain = interreflect(mesh, again, red, interreflection);
    EXPECT_GT(again.found, mesh.vertices.size() / 3);
    EXPECT_LT(again.found, mesh.vertices.size());
    EXPECT_EQ(once.shadowed, again.shadowed);
    EXPECT_EQ(once.unshadowedMatrices, again.unshadowedMatrices);
    EXPECT_EQ(once.noise, again.noise);
    EXPECT_EQ(all.vectors, allAgain.vectors);
    EXPECT_EQ(all.matrices, allAgain.matrices);
    parts[0].resize(100);
    EXPECT_THROW(gather(mesh, rayScene(mesh), gathering), InputError);
}

double relative(const std::vector<float>& a, const std::vector<float>& b) {
    double gap = 0, whole = 0;
    for (std::size_t k = 0; k < a.size(); ++k) {
        gap += std::pow(static_cast<double>(a[k] - b[k]), 2);
        whole += std::pow(static_cast<double>(b[k]), 2);
    }
    return std::sqrt(gap / whole);
}

/// Matrices of a diffuse material give what vectors give: cos(theta) is in two bands of HSH.
TEST(PrecomputedTransfer, HasVectorsInItsMatrices) {
    const TransferMesh mesh = transferMesh(corner(), {.edge = 0.5});
    const GatheredTransfer gathered =
        gather(mesh, rayScene(mesh), {.order = 3, .rays = 900, .localOrder = 2});
    const auto local = bases::make("hsh", 2);
    std::vector<double> cosine(4), h(4);
    overHemisphere({0, 0, 1}, [&](const Direction& d, const Direction&, double weight) {
        local->evaluate(d, h.data());
        for (std::size_t j = 0; j < 4; ++j) cosine[j] += weight * d.z * h[j] / pi;
    });
    for (const auto& [vectors, matrices] :
         {std::pair{&gathered.unshadowed, &gathered.unshadowedMatrices},
          std::pair{&gathered.shadowed, &gathered.shadowedMatrices}}) {
        std::vector<float> products(vectors->size());
        for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
            for (std::size_t j = 0; j < 4; ++j)
                for (std::size_t i = 0; i < 9; ++i)
                    products[v * 9 + i] +=
                        static_cast<float>(cosine[j]) * (*matrices)[(v * 4 + j) * 9 + i];
        EXPECT_LE(relative(products, *vectors), vectors == &gathered.unshadowed ? 1e-5 : 5e-3);
    }
}

/// Passes over rays with the coefficients of a diffuse material, with its albedo alone, and over
/// links of vertices agree.
TEST(PrecomputedTransfer, ReflectsByCoefficientsAsByAnAlbedo) {
    const TransferMesh mesh = transferMesh(corner(), {.edge = 0.5});
    const GatheredTransfer gathered =
        gather(mesh, rayScene(mesh), {.order = 2, .rays = 225, .localOrder = 2});
    GatheredTransfer linked = gathered;
    linked.localOrder = 0;
    linked.shadowedMatrices.clear();
    const auto lambert = brdfs::open("lambert:kd=.8/.4/.2");
    TransferMaterial byAlbedo = transferMaterial("lambert", *lambert, 2);
    ASSERT_TRUE(byAlbedo.diffuse);
    EXPECT_NEAR(byAlbedo.albedo[1], 0.4, 1e-12);
    TransferMaterial byCoefficients = byAlbedo;
    const auto local = bases::make("hsh", 2);
    const Basis* const all[] = {local.get()};
    byCoefficients.response = project(*lambert, all, OutgoingSet::elevations(responseElevations),
                                      {.quantity = Quantity::brdfCosine})[0]
                                  .coefficients;
    const InterreflectionOptions options{.passes = 3};
    const auto links = interreflect(mesh, linked, std::vector{byAlbedo}, options);
    const auto rays = interreflect(mesh, gathered, std::vector{byAlbedo}, options);
    const auto glossy = interreflect(mesh, gathered, std::vector{byCoefficients}, options);
    // Weights of corners are kept in 16 bits.
    EXPECT_LE(relative(rays.vectors, links.vectors), 1e-4);
    // The means of both sums over rays differ by their noise.
    EXPECT_LE(relative(glossy.vectors, rays.vectors), 5e-3);
    EXPECT_LE(relative(glossy.matrices, rays.matrices), 5e-3);
}

TEST(MatrixClusters, StateTheirErrorAndHoldEverythingWithEnoughComponents) {
    const TransferMesh mesh = transferMesh(corner(), {.edge = 0.8});
    const GatheredTransfer gathered =
        gather(mesh, rayScene(mesh), {.order = 2, .rays = 64, .localOrder = 2, .links = false});
    const TransferView view{.order = 2, .localOrder = 2, .matrices = gathered.shadowedMatrices};
    const MatrixClusters all = clusterMatrices(view, {.clusters = 3, .components = 16});
    ASSERT_EQ(all.errors.size(), 17);
    for (std::size_t k = 1; k <= 16; ++k)
        EXPECT_LE(all.errors[k].relativeL2, all.errors[k - 1].relativeL2 + 1e-12);
    EXPECT_LE(all.errors.back().relativeL2, 1e-6);
    const MatrixClusters some = all.truncated(4);
    std::vector<float> again;
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        const std::vector<float> matrix = some.matrix(v);
        again.insert(again.end(), matrix.begin(), matrix.end());
    }
    EXPECT_NEAR(relative(again, gathered.shadowedMatrices), all.errors[4].relativeL2, 1e-5);
    EXPECT_EQ(all.errors[4].bytes,
              4 * (some.means.size() + some.basis.size() + some.weights.size() + some.of.size()));
}

TEST(TransferMesh, HalvesLongEdgesWithoutCracks) {
    const std::vector<SurfaceObject> objects{objectOf("box", cube())};
    const TransferMesh mesh = transferMesh(objects, {.edge = 0.7});
    double area = 0;
    std::map<std::pair<MeshVector, MeshVector>, int> edges;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        for (std::size_t k = 0; k < 3; ++k) {
            const MeshVector a = mesh.vertices[mesh.triangles[t][k]].position,
                             b = mesh.vertices[mesh.triangles[t][(k + 1) % 3]].position;
            EXPECT_LE(std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]), 0.7F + 1e-6F);
            ++edges[{a, b}];
        }
    }
    for (const TransferVertex& vertex : mesh.vertices) area += vertex.area;
    EXPECT_NEAR(area, 24, 1e-4);
    EXPECT_EQ(mesh.triangles.size(), mesh.fronts) << "a closed box has no inside";
    for (const auto& [edge, count] : edges) {
        EXPECT_EQ(count, 1);
        EXPECT_EQ((edges.count({edge.second, edge.first})), 1);
    }
}

TEST(TransferMesh, RefusesWhatIsNoNumberAndLeavesOutTrianglesWithoutArea) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const auto messageOf = [](const SurfaceObject& object) {
        try {
            transferMesh(std::vector{object});
        } catch (const UsageError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    SurfaceObject place = objectOf("ball", sphereMesh(1)), normal = place;
    place.mesh.positions[3][1] = nan;
    normal.mesh.normals[7][0] = nan;
    EXPECT_NE(messageOf(place).find("object 'ball': vertex 3"), std::string::npos);
    EXPECT_NE(messageOf(normal).find("corner 1 of triangle 2"), std::string::npos);
    SurfaceObject flat = objectOf("flat", squareMesh());
    flat.mesh.triangles.push_back({0, 1, 1});
    flat.mesh.normals.insert(flat.mesh.normals.end(), 3, MeshVector{0, 0, 1});
    const TransferMesh mesh = transferMesh(std::vector{flat}, {.edge = 0});
    EXPECT_EQ(mesh.fronts, 2);
    flat.mesh.triangles.assign(1, {0, 1, 1});
    flat.mesh.normals.resize(3);
    EXPECT_NE(messageOf(flat).find("without a triangle"), std::string::npos);
}

}  // namespace
}  // namespace hshfit
