#pragma once

#include <hshfit/bases/basis.h>
#include <hshfit/projection/internal/rings.h>
#include <hshfit/quadrature/quadrature.h>

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace hshfit::inline projection {

/// The second half of the transform: from the azimuth transform on a panel's rings to the moments
/// against the analysis functions of every basis. Theta functions times quadrature weights are kept
/// for all outgoing directions where panels recur (panels from halving do), up to 64 MB in all.
/// Safe to use from many threads; results are bitwise identical with and without the cache.
class ThetaProducts {
public:
    explicit ThetaProducts(std::span<const Basis* const> bases);
    ~ThetaProducts();

    std::span<const Basis* const> bases() const { return bases_; }
    /// Values that `moments` writes for each basis.
    std::size_t size(std::size_t basis, std::size_t channels) const;

    /// Adds the moments over panel number `panel` of the grid to `out`, basis after basis, in an
    /// order that `toSlots` knows; 0 between them. `a` and `b` are the panel's ends in u. With
    /// `even`, the moments of sines are left alone.
    void addMoments(const HemisphereGrid& grid, std::size_t panel, double a, double b,
                    const RingSpectrum& spectrum, bool even, double* out) const;
    /// The output of `addMoments` for one basis as [channel][slot].
    std::vector<double> toSlots(std::size_t basis, std::size_t channels, const double* from) const;

private:
    struct Kept;
    std::vector<const Basis*> bases_;
    std::size_t lanes_ = 0;              ///< of theta for each ring, over all bases
    std::vector<std::size_t> columnOf_;  ///< of the azimuth functions of m and -m
    std::unique_ptr<Kept> kept_;
};

}  // namespace hshfit::inline projection
