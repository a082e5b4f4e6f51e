#include <hshfit/meshes/mesh.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

namespace hshfit::inline meshes {
namespace {

using Vector = std::array<double, 3>;

/// Triangles at one vertex beyond which creases are not looked for: their pairs would take time
/// with the square of the number.
constexpr std::size_t mostPairs = 256;

Vector minus(const MeshVector& a, const MeshVector& b) {
    return {double{a[0]} - b[0], double{a[1]} - b[1], double{a[2]} - b[2]};
}
Vector cross(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double dot(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
/// The vector at length 1; 0 for a vector that is 0.
Vector unit(const Vector& a) {
    const double length = std::hypot(a[0], a[1], a[2]);
    if (!(length > 0)) return {};
    return {a[0] / length, a[1] / length, a[2] / length};
}
MeshVector single(const Vector& a) {
    return {static_cast<float>(a[0]), static_cast<float>(a[1]), static_cast<float>(a[2])};
}

struct Corner {
    Vector faceNormal{};
    double angle = 0;
};

Vector faceNormal(const Mesh& mesh, std::size_t triangle) {
    const auto& t = mesh.triangles[triangle];
    const MeshVector& a = mesh.positions[t[0]];
    return unit(cross(minus(mesh.positions[t[1]], a), minus(mesh.positions[t[2]], a)));
}

Corner cornerOf(const Mesh& mesh, std::size_t at) {
    const auto& t = mesh.triangles[at / 3];
    const MeshVector& here = mesh.positions[t[at % 3]];
    const Vector a = minus(mesh.positions[t[(at + 1) % 3]], here);
    const Vector b = minus(mesh.positions[t[(at + 2) % 3]], here);
    const Vector across = cross(a, b);
    return {faceNormal(mesh, at / 3), std::atan2(std::sqrt(dot(across, across)), dot(a, b))};
}

/// The corners at each vertex: vertex v has corners[first[v]] up to corners[first[v + 1]].
struct CornersOfVertices {
    explicit CornersOfVertices(const Mesh& mesh) : first(mesh.positions.size() + 1) {
        for (const auto& triangle : mesh.triangles) {
            for (const std::uint32_t v : triangle) ++first[v + 1];
        }
        std::partial_sum(first.begin(), first.end(), first.begin());
        corners.resize(3 * mesh.triangles.size());
        std::vector<std::size_t> next(first.begin(), first.end() - 1);
        for (std::size_t at = 0; at < corners.size(); ++at) {
            corners[next[mesh.triangles[at / 3][at % 3]]++] = at;
        }
    }
    std::vector<std::size_t> first, corners;
};

}  // namespace

void completeNormals(Mesh& mesh) {
    mesh.normals.resize(3 * mesh.triangles.size());
    const CornersOfVertices around(mesh);
    const double crease = std::cos(creaseAngle);
    std::vector<Corner> corners;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        const std::size_t first = around.first[v], count = around.first[v + 1] - first;
        corners.clear();
        for (std::size_t k = 0; k < count; ++k) {
            const std::size_t at = around.corners[first + k];
            const MeshVector& n = mesh.normals[at];
            const Vector given = unit({n[0], n[1], n[2]});
            mesh.normals[at] = single(given);
            if (corners.empty() && dot(given, given) > 0) continue;
            for (std::size_t j = corners.size(); j < count; ++j) {
                corners.push_back(cornerOf(mesh, around.corners[first + j]));
            }
            if (dot(given, given) > 0) continue;
            Vector sum{};
            for (const Corner& other : corners) {
                if (count <= mostPairs && dot(other.faceNormal, corners[k].faceNormal) < crease)
                    continue;
                for (std::size_t i = 0; i < 3; ++i) sum[i] += other.angle * other.faceNormal[i];
            }
            const Vector mean = unit(sum);
            mesh.normals[at] = single(dot(mean, mean) > 0 ? mean : corners[k].faceNormal);
            // One normal for all: the others at this vertex are the same.
            if (count > mostPairs) {
                for (std::size_t j = k; j < count; ++j) {
                    MeshVector& other = mesh.normals[around.corners[first + j]];
                    if (other == MeshVector{}) other = mesh.normals[at];
                }
            }
        }
    }
}

std::size_t dropDegenerate(Mesh& mesh) {
    std::size_t kept = 0;
    const bool normals = !mesh.normals.empty();
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const Vector n = faceNormal(mesh, t);
        if (!(dot(n, n) > 0)) continue;
        mesh.triangles[kept] = mesh.triangles[t];
        for (std::size_t k = 0; normals && k < 3; ++k) {
            mesh.normals[3 * kept + k] = mesh.normals[3 * t + k];
        }
        ++kept;
    }
    const std::size_t dropped = mesh.triangles.size() - kept;
    mesh.triangles.resize(kept);
    if (normals) mesh.normals.resize(3 * kept);
    return dropped;
}

void turnUpright(Mesh& mesh) {
    for (auto* vectors : {&mesh.positions, &mesh.normals}) {
        for (MeshVector& v : *vectors) v = {v[0], -v[2], v[1]};
    }
}

Mesh sphereMesh(int levels) {
    Mesh mesh;
    mesh.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                      {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    for (int level = 0; level < levels; ++level) {
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
        const auto middle = [&](std::uint32_t a, std::uint32_t b) {
            const auto [place, fresh] = middles.try_emplace(
                std::minmax(a, b), static_cast<std::uint32_t>(mesh.positions.size()));
            if (fresh) {
                const MeshVector &p = mesh.positions[a], &q = mesh.positions[b];
                mesh.positions.push_back(
                    single(unit({double{p[0]} + q[0], double{p[1]} + q[1], double{p[2]} + q[2]})));
            }
            return place->second;
        };
        std::vector<std::array<std::uint32_t, 3>> finer;
        for (const auto& [a, b, c] : mesh.triangles) {
            const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
        }
        mesh.triangles = std::move(finer);
    }
    for (const auto& triangle : mesh.triangles) {
        for (const std::uint32_t v : triangle) mesh.normals.push_back(mesh.positions[v]);
    }
    return mesh;
}

Mesh squareMesh() {
    Mesh mesh;
    mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    completeNormals(mesh);
    return mesh;
}

}  // namespace hshfit::inline meshes
