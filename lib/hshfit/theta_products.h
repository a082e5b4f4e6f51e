#pragma once

#include <hshfit/bases/basis.h>
#include <hshfit/quadrature.h>
#include <hshfit/rings.h>

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace hshfit {

/// The second half of the transform: from the azimuth transform on a panel's rings to the moments
/// against the analysis functions of every basis. Theta functions times quadrature weights are kept
/// for all outgoing directions where panels recur (those from halving do), up to 64 MB in all. Safe
/// to use from many threads; what is kept does not change a result.
class ThetaProducts {
public:
    explicit ThetaProducts(std::span<const Basis* const> bases);
    ~ThetaProducts();

    std::span<const Basis* const> bases() const { return bases_; }
    /// Values that `moments` writes for each basis: channels * slots.
    std::size_t size(std::size_t basis, std::size_t channels) const {
        return channels * static_cast<std::size_t>(bases_[basis]->slots());
    }

    /// Moments over panel number `panel` of the grid, [basis][channel][slot], to `out`. `a` and `b`
    /// are the panel's ends in u. With `even`, those of sines are 0.
    void moments(const HemisphereGrid& grid, std::size_t panel, double a, double b,
                 const RingSpectrum& spectrum, bool even, double* out) const;

private:
    struct Kept;
    std::vector<const Basis*> bases_;
    std::size_t pairs_ = 0;  ///< (l, m >= 0) over all bases
    std::unique_ptr<Kept> kept_;
};

}  // namespace hshfit
