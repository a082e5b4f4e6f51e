#pragma once

#include <hshfit/coefficients/coefficients.h>

#include <cstddef>
#include <span>
#include <vector>

namespace hshfit::inline transfer {

// Shading by coefficients: in an orthonormal basis the integral of BRDF times light is the dot
// product of their vectors (Gautron et al. 2004, Eq. 17). Light is in the local frame of each
// vertex, slot by slot: light[slot * vertices + v], so that vertices fill the lanes of vectors.
// The BRDF has the cosine (Quantity::brdfCosine), or the light has. Single precision; the error is
// some 1e-7 of the sum of the absolute products.

/// One coefficient set at many vertices: out[v] = sum over slots of brdf[slot] light[slot][v].
void shade(std::span<const float> brdf, const float* light, std::size_t vertices, float* out);
/// A set of its own at each: brdf[slot * vertices + v].
void shade(std::size_t slots, const float* brdf, const float* light, std::size_t vertices,
           float* out);

/// The outgoing directions of vertices in their local frames: z = cos(theta_o), and the cosine and
/// sine of the azimuth. At z <= 0 the result is 0.
struct ShadingViews {
    const float* z = nullptr;
    const float* cosine = nullptr;
    const float* sine = nullptr;
    std::size_t vertices = 0;
};

/// An isotropic material at many vertices, each with a view of its own: coefficients of an
/// elevation set are interpolated as by `lookUp`, turned by the azimuth of the view and multiplied
/// with the light. Coefficients of negative m are left out if the set is bilateral.
class ShadingTable {
public:
    /// Throws UsageError unless the set is isotropic, kept by elevations, and its basis
    /// orthonormal.
    explicit ShadingTable(const Coefficients& coefficients);

    int order() const { return order_; }
    std::size_t channels() const { return channels_; }
    /// light [channel][slot][vertex] to out [channel][vertex].
    void shade(const ShadingViews& views, const float* light, float* out) const;

private:
    int order_;
    std::size_t channels_, elevations_;
    bool bilateral_;
    std::vector<float> table_;  ///< [channel][slot][elevation], the last one twice
};

}  // namespace hshfit::inline transfer
