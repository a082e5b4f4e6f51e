#pragma once

#include <hshfit/bases/basis.h>

#include <array>
#include <vector>

namespace hshfit::gpu {

/// A basis as a shader evaluates it, without an angle and without a singularity. For z > 0, with
///     o = (x^2 + y^2)/(1 + z) = 1 - z,   s = 1, 2 sqrt(z/(1 + z)) or 1/sqrt(1 + z),
///     u = s (x + i y),   W = sqrt(z) or 1,
/// the functions are B_{l,m} = p_k W {1, Re, Im}(u^|m|) for m = 0, > 0, < 0 and l = |m| + k
/// bandStep,
///     p_0 = start,   d_k = slope t p_k + carry[end] d_{k-1},   p_{k+1} = ratio[end] p_k + d_k
/// (Reinsch's form; see bases/jacobi.h). For `bothEnds`
///     end = 0, t = -2 near min(o, z) where o < z, and end = 1, t = 2 near min(o, z) elsewhere;
/// else end = 0 and t = -o.
struct BasisSteps {
    enum class Scale { one, hump, chord };  ///< s, in the order above

    struct Step {
        double slope;
        std::array<double, 2> ratio, carry;
    };
    struct Column {
        int m = 0;
        /// Holds the azimuth's 1/sqrt(2 pi) or 1/sqrt(pi) and the Condon-Shortley sign too.
        double start = 1;
        std::vector<Step> steps;
    };

    Scale scale = Scale::one;
    bool rootCosine = false;  ///< W = sqrt(z)
    bool bothEnds = false;
    int near = 1;  ///< 1 or -1
    int bandStep = 1;
    std::vector<Column> columns;  ///< m = 0 .. order - 1
};

/// The steps of any basis of the catalog. Throws UsageError for others outside the Jacobi family.
BasisSteps basisSteps(const Basis& basis);

}  // namespace hshfit::gpu
