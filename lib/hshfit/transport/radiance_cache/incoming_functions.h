#pragma once

#include <hshfit/bases/basis.h>
#include <hshfit/brdf/directions.h>

#include <cstddef>
#include <memory>
#include <vector>

namespace hshfit::inline transport::inline radiance_cache {

/// The functions W_i on the hemisphere by which records hold incoming radiance,
///     lambda_i = integral of L(d) W_i(d) d omega       (Gautron et al. 2004, Eq. 21):
/// the functions of a basis, times cos(theta) where its inner product has the cosine, or the cosine
/// alone, for which lambda is irradiance. Slots of functions that a basis lacks are left out.
class IncomingFunctions {
public:
    /// Irradiance.
    IncomingFunctions() = default;
    explicit IncomingFunctions(std::shared_ptr<const Basis> basis);

    std::size_t size() const { return basis_ ? slots_.size() : 1; }
    /// The functions of cos(m phi) and sin(m phi) of one degree, m > 0.
    struct Pair {
        int m;
        std::size_t cosine, sine;
    };
    const std::vector<Pair>& pairs() const { return pairs_; }
    /// The slots of the basis, in the order of the functions.
    const std::vector<int>& slots() const { return slots_; }
    const Basis* basis() const { return basis_.get(); }
    /// Whether the cosine is among the weights, so that rays are best drawn with it.
    bool cosine() const;
    /// Whether a function is the same at all azimuths; the others have the integral 0.
    bool zonal(std::size_t function) const;
    /// out[direction][function].
    void tabulate(DirectionBatch directions, float* out) const;

private:
    std::shared_ptr<const Basis> basis_ = nullptr;
    std::vector<int> slots_ = {};
    std::vector<Pair> pairs_ = {};
};

}  // namespace hshfit::inline transport::inline radiance_cache
