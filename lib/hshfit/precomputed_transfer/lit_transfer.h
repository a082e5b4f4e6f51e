#pragma once

#include <hshfit/coefficients/light_coefficients.h>
#include <hshfit/precomputed_transfer/transfer_material.h>
#include <hshfit/precomputed_transfer/transfer_mesh.h>
#include <hshfit/rays/ray_scene.h>
#include <hshfit/transport/camera.h>

#include <cstddef>
#include <span>
#include <vector>

namespace hshfit::inline precomputed_transfer {

/// Transfer of one kind, laid out as in InterreflectedTransfer, without its memory.
struct TransferView {
    int order = 0, localOrder = 0;
    std::size_t channels = 1;
    std::span<const float> vectors = {}, matrices = {};  ///< no matrices: vectors alone

    std::size_t slots() const { return static_cast<std::size_t>(order) * order; }
    std::size_t localSlots() const { return static_cast<std::size_t>(localOrder) * localOrder; }
};

/// The radiance of vertices under a light by its first `bands` bands: albedo times T L, and c(wo)^T
/// M L of materials with a response where there are matrices. Light: RGB on the sphere, without the
/// Condon-Shortley sign.
class LitTransfer {
public:
    /// Throws UsageError for a light of fewer bands, on a hemisphere or with that sign.
    LitTransfer(const TransferMesh& mesh, std::span<const TransferMaterial> materials,
                const TransferView& transfer, const LightCoefficients& light, int bands);

    /// Towards a viewer in the world.
    Rgb radiance(std::uint32_t vertex, const Direction& viewer) const;

private:
    const TransferMesh& mesh_;
    std::span<const TransferMaterial> materials_;
    std::size_t localSlots_ = 0;
    std::vector<Rgb> reflected_;    ///< of vertices without a response
    std::vector<double> incident_;  ///< [vertex][R, G, B][j]
};

/// Radiance of the vertices, interpolated over triangles, in `samples` x `samples` points of each
/// pixel; 0 beside the surface. [row][column][R, G, B], row 0 at the top. The picture does not
/// depend on the number of threads.
std::vector<float> transferPicture(const TransferMesh& mesh, const RayScene& scene,
                                   const LitTransfer& lit, const Camera& camera, int samples = 2);

}  // namespace hshfit::inline precomputed_transfer
