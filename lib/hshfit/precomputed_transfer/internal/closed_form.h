#pragma once

#include <hshfit/meshes/mesh.h>

#include <cstddef>
#include <vector>

namespace hshfit::inline precomputed_transfer {

/// Transfer of light to a vertex with nothing in the way, exact:
///     T_{l,m} = A_l Y_{l,m}(n) / pi,   A the bands of the clamped cosine (transfer/convolution.h)
///     M = C D,   C from SH to HSH (rotation/basis_change.h), D the turn into the vertex's frame
/// laid out as in GatheredTransfer. Immutable; safe to use from many threads.
class ClosedForm {
public:
    /// `localOrder` 0: vectors alone.
    ClosedForm(int order, int localOrder);
    void vector(const MeshVector& normal, float* out) const;
    void matrix(const MeshVector& normal, float* out) const;

private:
    int order_, localOrder_;
    std::vector<double> bands_;   ///< A_l / pi
    std::vector<double> change_;  ///< [j][i]
};

}  // namespace hshfit::inline precomputed_transfer
