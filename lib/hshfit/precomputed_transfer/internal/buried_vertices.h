#pragma once

#include <hshfit/precomputed_transfer/transfer_mesh.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace hshfit::inline precomputed_transfer {

/// Values for vertices that lie within closed objects, as a floor's under a box: the mean of the
/// values beside them and at the same place on the same side, from the edge of the hidden region
/// inwards, so that no darkness is interpolated out from under the box. Vertices without any way to
/// the open keep their values.
class BuriedVertices {
public:
    BuriedVertices(const TransferMesh& mesh, std::span<const std::uint32_t> buried);

    /// `values`: [vertex][stride].
    void fill(std::vector<float>& values, std::size_t stride) const;

private:
    struct Vertex {
        std::uint32_t vertex;
        std::vector<std::uint32_t> sources;
    };
    std::vector<Vertex> order_;  ///< sources stand before
};

}  // namespace hshfit::inline precomputed_transfer
