#pragma once

#include <hshfit/meshes/mesh.h>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>

namespace hshfit::inline rays {

/// The first meeting of a ray with a mesh.
struct RayHit {
    double distance = 0;
    std::uint32_t triangle = 0;
    double u = 0, v = 0;  ///< weights of the triangle's second and third corner
};

/// A mesh that rays can be traced through, by Embree with its robust intersection test. Distances
/// and weights are in single precision. Immutable; safe to use from many threads.
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

private:
    struct Device;
    std::unique_ptr<Device> device_;
};

}  // namespace hshfit::inline rays
