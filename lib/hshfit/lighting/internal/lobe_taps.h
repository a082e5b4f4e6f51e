#pragma once

#include <hshfit/lighting/lobe_kernel.h>
#include <hshfit/lighting/lobe_nodes.h>

#include <cstddef>
#include <vector>

namespace hshfit::lighting {

/// Weights of an odd number of directions at angles `offsets` times a spread about an axis: even
/// steps over two standard deviations of a Gaussian, to either side.
struct LobeTaps {
    std::vector<double> offsets, weights;  ///< weights add up to 1

    explicit LobeTaps(std::size_t count);
    double meanCosine(double spread) const;
    double meanSquareSine(double spread) const;
};

/// A lobe as a round kernel at taps along the direction in which the lobe is wide.
struct SpreadLobe {
    double meanCosine = 1;  ///< of the kernel
    double spread = 0;      ///< the standard deviation of the taps, radians
    double angle = 0;       ///< from AcrossAxis::first
};

/// Kernel and taps that keep a lobe's mean direction, its mean cosine about it and, as far as taps
/// can, the difference between its second moments across the axis.
class SpreadSolver {
public:
    SpreadSolver(const LobeKernel& kernel, const LobeTaps& taps);
    SpreadLobe solve(double meanCosine, const LobeSpread& spread) const;
    /// LobeKernel::scaleFor, interpolated in a table.
    double scaleFor(double meanCosine) const;

private:
    double lookUp(double meanCosine, const std::vector<double>& values) const;

    const LobeTaps& taps_;
    std::vector<double> logarithms_, cosines_, squares_;  ///< of falling scales, and their moments
};

/// The axis turned by an angle towards a direction across it.
Direction turnedAside(const Direction& axis, const Direction& across, double angle);

}  // namespace hshfit::lighting
