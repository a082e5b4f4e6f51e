#include <hshfit/precomputed_transfer/transfer_mesh.h>

#include <hshfit/brdf/vectors.h>
#include <hshfit/error.h>
#include <hshfit/wording.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

namespace hshfit::inline precomputed_transfer {
namespace {

constexpr std::size_t mostTriangles = std::size_t{1} << 22;
/// Cosine of the angle between normals that count as one.
const double sameNormal = std::cos(radians(2));

using Edge = std::pair<std::uint32_t, std::uint32_t>;
Edge edgeOf(std::uint32_t a, std::uint32_t b) {
    return {std::min(a, b), std::max(a, b)};
}

MeshVector middle(const MeshVector& a, const MeshVector& b) {
    return {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2};
}
MeshVector single(const Direction& d) {
    return {static_cast<float>(d.x), static_cast<float>(d.y), static_cast<float>(d.z)};
}
double distance(const MeshVector& a, const MeshVector& b) {
    const Direction gap = directionOf(a) - directionOf(b);
    return std::sqrt(dot(gap, gap));
}

void requireNumbers(const SurfaceObject& object) {
    const auto finite = [](const MeshVector& v) {
        return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
    };
    const auto& positions = object.mesh.positions;
    const auto place = std::ranges::find_if_not(positions, finite);
    if (place != positions.end()) {
        throw UsageError(
            fmt::format("object '{}': vertex {} is at no place: a coordinate is not "
                        "a finite number",
                        object.name, place - positions.begin()));
    }
    const auto& normals = object.mesh.normals;
    const auto normal = std::ranges::find_if_not(normals, finite);
    if (normal != normals.end()) {
        throw UsageError(fmt::format(
            "object '{}': the normal of corner {} of triangle {} is not a finite "
            "vector; leave the normals out to have them computed",
            object.name, (normal - normals.begin()) % 3, (normal - normals.begin()) / 3));
    }
}

double areaOf(const Mesh& mesh) {
    double area = 0;
    for (const auto& t : mesh.triangles) {
        const Direction a = directionOf(mesh.positions[t[0]]);
        const Direction across =
            cross(directionOf(mesh.positions[t[1]]) - a, directionOf(mesh.positions[t[2]]) - a);
        area += std::sqrt(dot(across, across)) / 2;
    }
    return area;
}

/// One index for each place.
void weld(Mesh& mesh) {
    std::map<MeshVector, std::uint32_t> places;
    std::vector<std::uint32_t> index;
    std::vector<MeshVector> kept;
    for (const MeshVector& p : mesh.positions) {
        const auto [at, isNew] = places.try_emplace(p, static_cast<std::uint32_t>(kept.size()));
        if (isNew) kept.push_back(p);
        index.push_back(at->second);
    }
    for (auto& triangle : mesh.triangles)
        for (std::uint32_t& corner : triangle) corner = index[corner];
    mesh.positions = std::move(kept);
}

/// Triangles with corner normals, halved at edges.
class Refinement {
public:
    Refinement(Mesh& mesh, double edge) : mesh_(mesh), edge_(edge) {}

    void run() {
        // None is larger than the triangle of equal sides.
        require(areaOf(mesh_) / (std::sqrt(3.0) / 4 * edge_ * edge_));
        while (mark()) {
            split();
            require(static_cast<double>(mesh_.triangles.size()));
        }
    }

private:
    void require(double triangles) const {
        if (triangles <= static_cast<double>(mostTriangles)) return;
        throw UsageError(
            fmt::format("edges of at most {:g} make more than {} triangles; allow longer ones with "
                        "{}",
                        edge_, mostTriangles, Setting{"TransferMeshOptions::edge"}));
    }

    bool mark() {
        middles_.clear();
        for (const auto& t : mesh_.triangles) {
            for (std::size_t k = 0; k < 3; ++k) {
                const Edge edge = edgeOf(t[k], t[(k + 1) % 3]);
                const MeshVector a = mesh_.positions[edge.first], b = mesh_.positions[edge.second];
                if (!(distance(a, b) > edge_) || middles_.contains(edge)) continue;
                middles_[edge] = static_cast<std::uint32_t>(mesh_.positions.size());
                mesh_.positions.push_back(middle(a, b));
            }
        }
        return !middles_.empty();
    }

    struct Corner {
        std::uint32_t vertex;
        MeshVector normal;
    };
    void emit(const Corner& a, const Corner& b, const Corner& c) {
        triangles_.push_back({a.vertex, b.vertex, c.vertex});
        for (const Corner* corner : {&a, &b, &c}) normals_.push_back(corner->normal);
    }

    void split() {
        triangles_.clear();
        normals_.clear();
        for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
            std::array<Corner, 3> corners;
            std::array<std::optional<Corner>, 3> cuts;
            for (std::size_t k = 0; k < 3; ++k)
                corners[k] = {mesh_.triangles[t][k], mesh_.normals[3 * t + k]};
            for (std::size_t k = 0; k < 3; ++k) {
                const Corner &a = corners[k], &b = corners[(k + 1) % 3];
                const auto found = middles_.find(edgeOf(a.vertex, b.vertex));
                if (found == middles_.end()) continue;
                const Direction mean = directionOf(a.normal) + directionOf(b.normal);
                const bool opposite = !(dot(mean, mean) > 1e-12);
                cuts[k] = {found->second, opposite ? a.normal : single(normalised(mean))};
            }
            emitParts(corners, cuts);
        }
        std::swap(mesh_.triangles, triangles_);
        std::swap(mesh_.normals, normals_);
    }

    void emitParts(std::array<Corner, 3> corners, std::array<std::optional<Corner>, 3> cuts) {
        const auto number = std::ranges::count_if(cuts, [](const auto& cut) { return !!cut; });
        if (number == 0) return emit(corners[0], corners[1], corners[2]);
        // Turned so that the only cut, or the only edge without one, is the first.
        for (int turn = 0; turn < 2 && number < 3 && !!cuts[0] != (number == 1); ++turn) {
            std::rotate(corners.begin(), corners.begin() + 1, corners.end());
            std::rotate(cuts.begin(), cuts.begin() + 1, cuts.end());
        }
        if (number == 1) {
            emit(corners[0], *cuts[0], corners[2]);
            emit(*cuts[0], corners[1], corners[2]);
        } else if (number == 2) {
            emit(*cuts[1], corners[2], *cuts[2]);
            emit(corners[0], corners[1], *cuts[1]);
            emit(corners[0], *cuts[1], *cuts[2]);
        } else {
            emit(corners[0], *cuts[0], *cuts[2]);
            emit(*cuts[0], corners[1], *cuts[1]);
            emit(*cuts[2], *cuts[1], corners[2]);
            emit(*cuts[0], *cuts[1], *cuts[2]);
        }
    }

    Mesh& mesh_;
    double edge_;
    std::map<Edge, std::uint32_t> middles_;
    std::vector<std::array<std::uint32_t, 3>> triangles_;
    std::vector<MeshVector> normals_;
};

/// Whether each edge has one triangle on either side.
bool closed(const Mesh& mesh) {
    std::map<Edge, int> balance, count;
    for (const auto& t : mesh.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t a = t[k], b = t[(k + 1) % 3];
            balance[edgeOf(a, b)] += a < b ? 1 : -1;
            ++count[edgeOf(a, b)];
        }
    }
    return std::ranges::all_of(balance, [](const auto& edge) { return edge.second == 0; }) &&
           std::ranges::all_of(count, [](const auto& edge) { return edge.second == 2; });
}

double diagonalOf(std::span<const SurfaceObject> objects) {
    MeshVector low{1e30F, 1e30F, 1e30F}, high{-1e30F, -1e30F, -1e30F};
    for (const SurfaceObject& object : objects) {
        for (const MeshVector& p : object.mesh.positions) {
            for (std::size_t k = 0; k < 3; ++k) {
                low[k] = std::min(low[k], p[k]);
                high[k] = std::max(high[k], p[k]);
            }
        }
    }
    return distance(low, high);
}

/// The first vertex and the first triangle of an object.
struct ObjectPlace {
    std::size_t vertex = 0, triangle = 0;
    bool twoSided = false;
};

void addFront(TransferMesh& all, const Mesh& mesh, std::uint32_t object) {
    std::vector<std::vector<std::uint32_t>> at(mesh.positions.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        std::array<std::uint32_t, 3> triangle{};
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t place = mesh.triangles[t][k];
            const MeshVector& normal = mesh.normals[3 * t + k];
            const auto found = std::ranges::find_if(at[place], [&](std::uint32_t v) {
                return dot(directionOf(all.vertices[v].normal), directionOf(normal)) > sameNormal;
            });
            if (found != at[place].end()) {
                triangle[k] = *found;
                continue;
            }
            triangle[k] = static_cast<std::uint32_t>(all.vertices.size());
            at[place].push_back(triangle[k]);
            all.vertices.push_back({mesh.positions[place], normal, object, 0});
        }
        all.triangles.push_back(triangle);
    }
}

/// Adds vertices and triangles for the other side of an object, whose own go from `from` up to
/// `to`.
void addBacks(TransferMesh& all, const ObjectPlace& from, const ObjectPlace& to) {
    const auto shift = static_cast<std::uint32_t>(all.vertices.size() - from.vertex);
    for (std::size_t v = from.vertex; v < to.vertex; ++v) {
        TransferVertex back = all.vertices[v];
        for (float& x : back.normal) x = -x;
        all.vertices.push_back(back);
    }
    for (std::size_t t = from.triangle; t < to.triangle; ++t) {
        const auto front = all.triangles[t];
        all.backs[t] = static_cast<std::uint32_t>(all.triangles.size());
        all.triangles.push_back({front[0] + shift, front[2] + shift, front[1] + shift});
    }
}

void complete(TransferMesh& mesh) {
    mesh.first.assign(mesh.vertices.size() + 1, 0);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const Direction a = mesh.corner(t, 0);
        const Direction across = cross(mesh.corner(t, 1) - a, mesh.corner(t, 2) - a);
        mesh.normals.push_back(normalised(across));
        for (const std::uint32_t v : mesh.triangles[t]) {
            ++mesh.first[v + 1];
            mesh.vertices[v].area += std::sqrt(dot(across, across)) / 6;
        }
    }
    std::partial_sum(mesh.first.begin(), mesh.first.end(), mesh.first.begin());
    mesh.around.resize(3 * mesh.triangles.size());
    std::vector<std::uint32_t> next(mesh.first.begin(), mesh.first.end() - 1);
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
        for (const std::uint32_t v : mesh.triangles[t]) mesh.around[next[v]++] = t;
}

}  // namespace

TransferMesh transferMesh(std::span<const SurfaceObject> objects,
                          const TransferMeshOptions& options) {
    if (options.edge && !(*options.edge >= 0)) {
        throw UsageError(fmt::format("an edge of {:g}; {} is a length, or 0 for any", *options.edge,
                                     Setting{"TransferMeshOptions::edge"}));
    }
    for (const SurfaceObject& object : objects) requireNumbers(object);
    TransferMesh all;
    all.edge = options.edge.value_or(diagonalOf(objects) / 32);
    std::vector<ObjectPlace> places;
    for (std::size_t k = 0; k < objects.size(); ++k) {
        Mesh mesh = objects[k].mesh;
        if (mesh.normals.size() != 3 * mesh.triangles.size()) completeNormals(mesh);
        weld(mesh);
        dropDegenerate(mesh);
        const bool both =
            options.sides == Sides::both || (options.sides == Sides::automatic && !closed(mesh));
        if (all.edge > 0) Refinement(mesh, all.edge).run();
        places.push_back({all.vertices.size(), all.triangles.size(), both});
        all.materials.push_back(objects[k].material);
        addFront(all, mesh, static_cast<std::uint32_t>(k));
        all.twoSided += both ? 1 : 0;
    }
    all.fronts = all.triangles.size();
    if (all.fronts == 0) throw UsageError("a scene without a triangle that has an area");
    all.backs.assign(all.fronts, TransferMesh::none);
    places.push_back({all.vertices.size(), all.fronts, false});
    for (std::size_t k = 0; k < objects.size(); ++k)
        if (places[k].twoSided) addBacks(all, places[k], places[k + 1]);
    complete(all);
    return all;
}

}  // namespace hshfit::inline precomputed_transfer
