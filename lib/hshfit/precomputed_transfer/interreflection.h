#pragma once

#include <hshfit/precomputed_transfer/gathering.h>
#include <hshfit/precomputed_transfer/transfer_material.h>
#include <hshfit/time_limit.h>

#include <cstddef>
#include <span>
#include <vector>

namespace hshfit::inline precomputed_transfer {

struct InterreflectionOptions {
    int passes = 5;  ///< reflections before the last one, which is the vertex's own
    TransferProgress progress = {};
    TimeLimit limit = {};  ///< no pass begins after it
    KeptParts kept = {};   ///< passes over rays, each by its number; passes over links are quick
};

/// Transfer with light that came by other surfaces, the sum over passes.
struct InterreflectedTransfer {
    std::size_t channels = 1;          ///< 1 where every albedo is grey
    std::vector<float> vectors = {};   ///< [vertex][channel][slot], before the vertex's own albedo
    std::vector<float> matrices = {};  ///< [vertex][channel][j][i]
    /// [pass]: reflected radiance under light of radiance 1 from everywhere, the mean over area,
    /// and R, G, B; pass 0 is direct light.
    std::vector<double> energy = {};
};

/// Passes of interreflection (Sloan, Kautz, Snyder 2002, 4.1; Schönefeld 2005, 6.2). Vectors:
///     U^0 = shadowed vectors,   U^k_p = sum over q of F_pq albedo_q U^(k-1)_q
/// with F the links of `gathered`: the shares of a vertex's rays, weighted with cos(theta) / pi, by
/// the corners of the triangles that they meet. With matrices, each ray k towards d brings what its
/// corners q reflect towards -d: albedo_q U_q if diffuse, else c_q(-d)^T M_q with the response c_q,
///     M^k_ji = 2 pi mean over rays of H_j(d) t_i(q, -d).
/// Without responses, materials that are not diffuse reflect as diffuse ones of their albedo.
/// `materials`: as mesh.materials numbers them. Runs on all threads; the result does not depend on
/// their number. Throws UsageError where links were not kept, and for a response of another order.
InterreflectedTransfer interreflect(const TransferMesh& mesh, const GatheredTransfer& gathered,
                                    std::span<const TransferMaterial> materials,
                                    const InterreflectionOptions& options = {});

/// Whether R, G and B of all albedos are equal.
bool grey(std::span<const TransferMaterial> materials);

}  // namespace hshfit::inline precomputed_transfer
