#pragma once

#include <hshfit/light/lights.h>

#include <array>
#include <cmath>

namespace hshfit::inline transport {

/// The place of one of several samples within a pixel: the first of them, as many as fill a square,
/// in a cell each, the others anywhere. `u` is uniform in [0, 1).
inline std::array<double, 2> placeInPixel(int sample, int samples, const std::array<double, 2>& u) {
    const int side = static_cast<int>(std::sqrt(samples));
    if (sample >= side * side) return u;
    return {(sample % side + u[0]) / side, (sample / side + u[1]) / side};
}

/// Mean and standard error of samples, by Welford's recurrence.
struct SampleMean {
    Rgb mean{}, squares{};
    double count = 0;

    void add(const Rgb& sample) {
        count += 1;
        for (std::size_t c = 0; c < 3; ++c) {
            const double off = sample[c] - mean[c];
            mean[c] += off / count;
            squares[c] += off * (sample[c] - mean[c]);
        }
    }
    Rgb error() const {
        Rgb error{};
        if (count < 2) return error;
        for (std::size_t c = 0; c < 3; ++c) error[c] = std::sqrt(squares[c] / (count - 1) / count);
        return error;
    }
};

}  // namespace hshfit::inline transport
