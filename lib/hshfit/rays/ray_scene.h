#pragma once

#include <hshfit/meshes/mesh.h>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

namespace hshfit::inline rays {

/// The first meeting of a ray with a mesh.
struct RayHit {
    double distance = 0;
    std::uint32_t triangle = 0;
    double u = 0, v = 0;  ///< weights of the triangle's second and third corner
};

/// A ray for `RayScene::firstHits`; its direction in single precision, as Embree takes it.
struct Ray {
    std::array<double, 3> origin{};
    std::array<float, 3> direction{};
};

/// A mesh that rays can be traced through, by Embree with its robust intersection test. Distances
/// and weights are in single precision. Immutable; safe to use from many threads.
///
/// Embree's test misses a mesh where a ray passes through a vertex to within rounding. So a ray
/// that meets nothing is traced once more, turned by `secondTurn`, which closes those leaks and
/// blurs an outline by that angle (figures: docs/explanation/illuminate.md).
class RayScene {
public:
    /// Throws NumericError if Embree cannot build it.
    explicit RayScene(const Mesh& mesh);
    ~RayScene();
    RayScene(const RayScene&) = delete;
    RayScene& operator=(const RayScene&) = delete;

    /// The nearest meeting beyond `nearest`, on either side of a triangle; none where the ray
    /// leaves. `direction` need not have length 1; distances are in its units.
    std::optional<RayHit> firstHit(const std::array<double, 3>& origin, const Direction& direction,
                                   double nearest = 0) const;
    /// The same without the second ray.
    std::optional<RayHit> firstHitOnce(const std::array<double, 3>& origin,
                                       const Direction& direction, double nearest = 0) const;

    /// The middle of the mesh's bounds: rays are traced relative to it, so that single precision
    /// tells places apart by the size of the mesh, however far it is from the origin.
    const std::array<double, 3>& centre() const { return centre_; }

    /// Radians: 16 units of single precision's last place, and above its rounding.
    static constexpr double secondTurn = 16 * 0x1p-24;

    /// The first meetings of many rays: hits[k] belongs to rays[k], and its distance is infinite
    /// where the ray leaves. Packets of 8 rays are traced together: neighbours in the list should
    /// start near each other and go about the same way. As `firstHitOnce`, without the second ray.
    /// A hit does not depend on the calling thread.
    void firstHits(std::span<const Ray> rays, std::span<RayHit> hits) const;

private:
    struct Device;
    std::unique_ptr<Device> device_;
    std::array<double, 3> centre_{};
};

}  // namespace hshfit::inline rays
