#pragma once

#include <hshfit/precomputed_transfer/gathering.h>
#include <hshfit/precomputed_transfer/internal/directions_above.h>
#include <hshfit/precomputed_transfer/transfer_material.h>

#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace hshfit::inline precomputed_transfer {

/// Transfer of one pass, laid out as in InterreflectedTransfer.
struct TransferPass {
    std::vector<float> vectors, matrices;
};

/// Passes of interreflection over rays whose ends were kept, with glossy reflection. The directions
/// of the rays are made again from their seed.
class RayPasses {
public:
    RayPasses(const TransferMesh& mesh, const GatheredTransfer& gathered,
              std::span<const TransferMaterial> materials, std::size_t channels);

    /// `progress` receives the vertices done, from any thread.
    void pass(const TransferPass& before, TransferPass& now,
              const std::function<void(std::size_t)>& progress) const;

private:
    struct Desk;
    void gatherVertex(std::size_t v, const TransferPass& before, TransferPass& now,
                      Desk& desk) const;
    void addReflected(std::uint32_t q, double weight, const Direction& world,
                      const TransferPass& before, Desk& desk) const;

    const TransferMesh& mesh_;
    const GatheredTransfer& gathered_;
    std::span<const TransferMaterial> materials_;
    std::size_t channels_, rays_;
    DirectionStrata strata_;
    std::shared_ptr<const Basis> local_;
};

}  // namespace hshfit::inline precomputed_transfer
