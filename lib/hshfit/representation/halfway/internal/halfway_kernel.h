#pragma once

#include <hshfit/brdf/directions.h>
#include <hshfit/representation/halfway/halfway_terms.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace hshfit::inline representation::inline halfway {

/// The halfway form laid out for vector code: runs over i, each with its coefficients for groups of
/// up to three channels.
struct HalfwayLayout {
    struct Run {
        std::uint16_t j, k, q, length;
        bool exchange, mirror, sine;
    };
    int half = 0, difference = 0, azimuth = 0, harmonics = 0;
    bool turns = false;  ///< the azimuth of h is used
    std::size_t channels = 0;
    std::vector<Run> runs;
    /// [group of three channels][run][i][channel of the group]
    std::vector<float> values;
    /// The envelope, if `logs` is not empty: ln E, [node along b][node along x][channel].
    int alongA = 1, alongB = 1;
    float ridge = 1;
    bool reciprocal = true;
    std::vector<float> logs;
    /// sqrt(2 n + 1) and the recurrence p_{n+1} = a_n t p_n - b_n p_{n-1}, [n] = {a, b}.
    std::vector<float> steps;
};

/// f at pairs k < count, out[channel * stride + k]. Runs code for the best instruction set that the
/// machine has.
void evaluateHalfwayPairs(const HalfwayLayout& layout, const DirectionBatch& wi,
                          const DirectionBatch& wo, std::size_t stride, float* out);

}  // namespace hshfit::inline representation::inline halfway
