#pragma once

#include <hshfit/brdf/directions.h>

#include <array>
#include <cstddef>

namespace hshfit::bases::kernels {

/// Orders up to this one are evaluated row by row in registers.
inline constexpr int shortOrders = 10;

/// The variables (s, X, Y, u) of a direction for
///     T_l^m az_m = u p_{l,m}(s) Re or Im (X + i Y)^m.
enum class Front {
    sphere,         ///< s = z,      X = x,                        u = 1
    sphereSquared,  ///< s = z^2,    X = x,                        u = 1
    hump,           ///< s = 2z - 1, X = 2 sqrt(z / (1 + z)) x,    u = 1, 0 below the horizon
    rootHump,       ///< the same with u = sqrt(z)
    chord,          ///< s = 1 - 2z, X = x / sqrt(1 + z),          u = 1, 0 below the horizon
};

/// p_{m,m} = first[m],  p_{l,m} = (a s + b) p_{l-step,m} + c p_{l-2 step,m}, in s itself: rounding
/// errors grow as l^2, which up to order 10 is less than 1e-14 of the maximum. The azimuth's
/// normalisation and the Condon-Shortley sign are in `first`; a, b of the second and c of the third
/// function of a column are multiplied by it, and p of the first function counts as 1 there.
template <class Real>
struct ShortTable {
    static constexpr std::size_t rows = shortOrders;
    std::array<Real, rows> first{};
    std::array<std::array<Real, 3>, rows*(rows + 1) / 2> step{};  ///< [l(l+1)/2 + m]: a, b, c
};

template <class Real>
struct ShortJob {
    Front front;
    int step;   ///< 1, or 2: functions with l - m odd are 0
    int order;  ///< at most shortOrders
    const ShortTable<Real>* table;
    DirectionBatch directions;
    bool bySlot;  ///< out[i * directions.count + k], else out[k * order^2 + i]
    Real* out;
};

/// All functions at all directions, by the best instruction set of the machine.
void tabulateShort(const ShortJob<double>& job);
void tabulateShort(const ShortJob<float>& job);

}  // namespace hshfit::bases::kernels
