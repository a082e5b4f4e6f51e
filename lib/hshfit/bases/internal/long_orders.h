#pragma once

#include <hshfit/bases/basis.h>
#include <hshfit/bases/internal/step_rows.h>
#include <hshfit/brdf/directions.h>

#include <array>
#include <cstddef>
#include <span>

namespace hshfit::bases::kernels {

/// d_k = slope y p_k + carry d_{k-1},  p_{k+1} = ratio p_k + d_k,  y = t - 1 or t + 1.
template <class Real>
struct Step {
    Real slope, ratio, carry;
};

/// t = mu, F = sin(theta); t = 2 mu - 1, F = 2 sqrt(mu (1 - mu)); t = 1 - 2 mu, F = sqrt(1 - mu).
/// The last two are 0 below the horizon.
enum class Domain { sphere, hump, chord };

/// One member of the Jacobi family (bases/jacobi.h) in the form that runs at any order.
template <class Real>
struct Recurrences {
    Domain domain;
    bool symmetric;  ///< the weight is even in t: steps from -1 follow from those from 1
    bool timesRootCosine;
    int bandStep;
    bool evenOnly;
    bool condonShortley;
    int order;
    const double* starts;                    ///< c_m
    const std::size_t* offsets;              ///< where the steps of each m begin
    std::array<const Step<Real>*, 2> steps;  ///< from t = 1 and from t = -1
    /// The same row by row, which `tabulateLong` needs; where the weight is symmetric the first.
    std::array<const StepRows<Real>*, 2> rows{};
};

/// All functions at all directions, orders above the short ones: out[k * order^2 + i]. Starts below
/// the range of Real carry an exponent of their own.
void tabulateLong(const Recurrences<double>& r, DirectionBatch directions, double* out);
void tabulateLong(const Recurrences<float>& r, DirectionBatch directions, float* out);
/// The same numbers as out[i * directions.count + k].
void tabulateLongBySlot(const Recurrences<double>& r, DirectionBatch directions, double* out);
void tabulateLongBySlot(const Recurrences<float>& r, DirectionBatch directions, float* out);

/// Theta parts of one m, laid out as for Basis::theta.
void theta(const Recurrences<double>& r, int m, std::span<const Elevation<double>> points,
           double* out);
void theta(const Recurrences<float>& r, int m, std::span<const Elevation<float>> points,
           float* out);

}  // namespace hshfit::bases::kernels
