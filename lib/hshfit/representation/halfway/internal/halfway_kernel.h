#pragma once

#include <hshfit/brdf/directions.h>
#include <hshfit/representation/halfway/halfway_axes.h>
#include <hshfit/representation/halfway/halfway_terms.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace hshfit::inline representation::inline halfway {

class HalfwayExpansion;

/// The rows of a block's table, one for each function of its pairs: those of the mean from 0 on,
/// then those of the other axes and the factors.
struct HalfwayRows {
    std::uint16_t x, v, product, powers, harmonics, gap, handed, above, weight, count;
};

/// A run over i: its functions, and those that all of them are multiplied with.
struct HalfwayRunLayout {
    std::uint16_t first, length;           ///< the rows of its functions
    std::array<std::uint16_t, 5> factors;  ///< rows of the functions that all have
    std::uint16_t factorCount;
};

/// The halfway form laid out for vector code: runs over i, each with its coefficients for groups of
/// up to three channels, in single or double precision.
template <class T>
struct HalfwayLayout {
    using Run = HalfwayRunLayout;
    HalfwayCounts counts;
    HalfwayAxes::Constants axes;
    HalfwayRows rows;
    int powers = 0;     ///< x kappa^n, n from 1 to this
    int harmonics = 0;  ///< the largest q
    std::size_t channels = 0;
    std::vector<Run> runs;
    std::size_t smoothRuns = 0;  ///< those of the smooth exponent, which come first
    std::size_t terms = 0;       ///< a channel
    /// [group of three channels][run][i][channel of the group], and three more numbers
    std::vector<T> values;
    std::vector<T> ceilings;  ///< [channel][smooth, lobe, top]
    /// The recurrence of Legendre's polynomials, p_{n+1} = a_n t p_n - b_n p_{n-1}, [n] = {a, b}.
    std::vector<T> steps;
    /// `runs` for one pair alone, in whose table the functions of degree n along the mean, x, v and
    /// the product follow each other at 4 n, and after all of them the other factors.
    std::vector<Run> oneRuns;
    std::size_t oneRows = 0;
    static constexpr std::size_t mostOneRows = 1024;  ///< beyond these it is no faster
};

/// That of an expansion.
template <class T>
HalfwayLayout<T> halfwayLayoutOf(const HalfwayExpansion& expansion);

/// f at a pair, out[channel * stride], where `oneRows` is at most `mostOneRows`.
void evaluateHalfwayPair(const HalfwayLayout<float>& layout, const HalfwayPoint& point,
                         std::size_t stride, float* out);
void evaluateHalfwayPair(const HalfwayLayout<double>& layout, const HalfwayPoint& point,
                         std::size_t stride, double* out);

/// f at pairs k < count, out[channel * stride + k]. Runs code for the best instruction set that the
/// machine has.
void evaluateHalfwayPairs(const HalfwayLayout<float>& layout, const DirectionBatch& wi,
                          const DirectionBatch& wo, std::size_t stride, float* out);
void evaluateHalfwayPairs(const HalfwayLayout<double>& layout, const DirectionBatch& wi,
                          const DirectionBatch& wo, std::size_t stride, double* out);

}  // namespace hshfit::inline representation::inline halfway
