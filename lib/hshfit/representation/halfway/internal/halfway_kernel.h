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

/// The rows of a block's table, one for each function of its pairs: rows of the mean from 0 on,
/// then rows of the other axes and the factors.
struct HalfwayRows {
    std::uint16_t x, v, product, powers, harmonics, gap, handed, above, weight, count;
};

/// A run over i: its functions, and the factors that all of them are multiplied with.
struct HalfwayRunLayout {
    std::uint16_t first, length;           ///< the rows of its functions
    std::array<std::uint16_t, 5> factors;  ///< rows of the functions that all have
    std::uint16_t factorCount;
    /// The place of its coefficients in a group: [channel of the group][i < stored], with 0 from
    /// `length` on.
    std::uint32_t value, stored;
};

/// Coefficients of a run are stored as a multiple of this.
inline constexpr std::uint32_t halfwayPadding = 8;

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
    std::size_t smoothRuns = 0;  ///< runs of the smooth exponent, which come first
    std::size_t stored = 0;      ///< coefficients of a channel, with the padding of their runs
    std::vector<T> values;       ///< [group of three channels], and in it as its runs say
    std::vector<T> ceilings;     ///< [channel][smooth, lobe, top]
    /// The recurrence of Legendre's polynomials, p_{n+1} = a_n t p_n - b_n p_{n-1}, [n] = {a, b},
    /// for a multiple of four degrees.
    std::vector<T> steps;
    /// `runs` for one pair alone, in whose table the functions along the mean, x, v and the product
    /// follow each other, as many as there are steps, and after them the other factors. Smooth runs
    /// are first here too; within each part runs of one shape follow each other, so that the
    /// processor foresees its branches.
    std::vector<Run> oneRuns;
    std::size_t oneRows = 0;
    static constexpr std::size_t mostOneRows = 1024;  ///< beyond these it is no faster
};

/// The layout of an expansion.
template <class T>
HalfwayLayout<T> halfwayLayoutOf(const HalfwayExpansion& expansion);

/// f at a pair above the horizon, out[channel * stride], where `oneRows` is at most `mostOneRows`.
void evaluateHalfwayPair(const HalfwayLayout<float>& layout, const Direction& wi,
                         const Direction& wo, std::size_t stride, float* out);
void evaluateHalfwayPair(const HalfwayLayout<double>& layout, const Direction& wi,
                         const Direction& wo, std::size_t stride, double* out);

/// f at pairs k < count, out[channel * stride + k]. Runs code for the best instruction set that the
/// machine has.
void evaluateHalfwayPairs(const HalfwayLayout<float>& layout, const DirectionBatch& wi,
                          const DirectionBatch& wo, std::size_t stride, float* out);
void evaluateHalfwayPairs(const HalfwayLayout<double>& layout, const DirectionBatch& wi,
                          const DirectionBatch& wo, std::size_t stride, double* out);

}  // namespace hshfit::inline representation::inline halfway
