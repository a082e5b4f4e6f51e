#pragma once

#include <hshfit/precomputed_transfer/transfer_mesh.h>
#include <hshfit/rays/ray_scene.h>
#include <hshfit/time_limit.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace hshfit::inline precomputed_transfer {

/// Receives the finished and the total amount of the work, from any thread.
using TransferProgress = std::function<void(std::size_t done, std::size_t total)>;

/// Finished parts of the work by number, of a run that was stopped, and the place to keep them in.
struct KeptParts {
    std::function<std::optional<std::vector<std::byte>>(std::uint64_t part)> find = {};
    std::function<void(std::uint64_t part, std::span<const std::byte> bytes)> keep = {};
};

/// Settings of the gathering of light at vertices.
struct GatheringOptions {
    int order = 5;            ///< bands of light, 1 to 16
    std::size_t rays = 2025;  ///< of a vertex; 2,025 = 45 x 45 as in Schönefeld 2005
    int localOrder = 0;       ///< bands of HSH above each vertex; 0: no matrices
    bool shadows = true;      ///< trace rays; without them there is the closed form alone
    bool links = true;        ///< keep what every vertex sees, for interreflection
    std::uint64_t seed = 1;
    TransferProgress progress = {};
    KeptParts kept = {};  ///< of partVertices vertices each
};
/// Vertices of a finished part of the work, as `KeptParts` stores it.
constexpr std::size_t partVertices = 64;

/// A vertex that another one sees, and the share of its irradiance that comes from there.
struct TransferLink {
    std::uint32_t vertex = 0;
    float share = 0;
};

/// The end of a ray, for matrices: the triangle on the side that is seen, with weights of its
/// second and third corner in 1/65535.
struct TransferHit {
    static constexpr std::uint32_t escapes = TransferMesh::none, untold = TransferMesh::none - 1;
    std::uint32_t triangle = escapes;
    std::uint16_t u = 0, v = 0;

    bool meets() const { return triangle < untold; }
    std::array<double, 3> weights() const {
        const double second = u / 65535.0, third = v / 65535.0;
        return {1 - second - third, second, third};
    }
};

/// The way of light from far away to each vertex, with Y_i the real spherical harmonics of `order`
/// bands in the world (slot l(l+1)+m), H_j the HSH in the frame frameAt(normal) (rendering/view.h)
/// and V 1 where nothing is in the way:
///     vectors   T_i = 1/pi integral of V Y_i cos(theta) d omega      (Sloan, Kautz, Snyder 2002)
///     matrices  M_ji = integral of V Y_i H_j d omega
/// Without V both are in closed form: the clamped cosine's bands, and the product of the change of
/// basis with the rotation into the frame. With V, the sum is over the rays that meet something,
/// taken from the closed form, or over the rays that do not, whichever are fewer.
struct GatheredTransfer {
    int order = 0, localOrder = 0;
    std::vector<float> unshadowed = {}, shadowed = {};                  ///< [vertex][slot]
    std::vector<float> unshadowedMatrices = {}, shadowedMatrices = {};  ///< [vertex][j][i]
    std::vector<std::vector<TransferLink>> links = {};  ///< of each vertex, by rising vertex
    std::vector<TransferHit> hits = {};                 ///< [vertex][ray], with both
    std::uint64_t seed = 1;                             ///< of the rays' directions
    /// Vertices whose rays nearly all end inside of closed objects: they lie in one. Their transfer
    /// is taken from the vertices beside them.
    std::vector<std::uint32_t> buried = {};

    std::size_t rays = 0;       ///< of all vertices
    std::size_t found = 0;      ///< vertices whose part was kept by an earlier run
    std::size_t inside = 0;     ///< that met a side without vertices, and are left out
    double tracingSeconds = 0;  ///< of all threads, in RayScene
    double seconds = 0;         ///< of all threads, with everything
    /// Standard error of the shadowed vectors as their two halves of the rays show it: root of the
    /// mean square over vertices, and the largest, over the root of the mean square of vectors.
    double noise = 0, largestNoise = 0;
    std::uint32_t noisiest = 0;  ///< vertex of the largest

    std::size_t slots() const { return static_cast<std::size_t>(order) * order; }
    std::size_t localSlots() const { return static_cast<std::size_t>(localOrder) * localOrder; }
};

/// The most memory that gathering and what follows take for a mesh, bytes.
std::size_t gatheringBytes(const TransferMesh& mesh, const GatheringOptions& options,
                           std::size_t channels);

/// The mesh's triangles for rays, one for each front.
RayScene rayScene(const TransferMesh& mesh);

/// As many rays of a vertex as fit into the time that is left, from 64 to `options.rays`, by the
/// time that 64 of each take. All of them where there is no limit.
std::size_t raysWithin(const TransferMesh& mesh, const RayScene& scene,
                       const GatheringOptions& options, const TimeLimit& limit);

/// Traces the rays of every vertex once. A ray starts 1/20 of the way from the vertex to the
/// middle of a triangle around it, above that triangle, and so neither within nor behind a
/// face that touches the vertex. Runs on all threads; the result does not depend on their number.
/// Throws UsageError for orders out of range and without rays.
GatheredTransfer gather(const TransferMesh& mesh, const RayScene& scene,
                        const GatheringOptions& options = {});

}  // namespace hshfit::inline precomputed_transfer
