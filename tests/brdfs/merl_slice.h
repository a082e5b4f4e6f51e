#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/brdf/directions.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::brdfs {

/// Measured values of one MERL material on the plane of difference azimuth 90 degrees, and the
/// distance of a BRDF from them. float32 [theta_d][theta_h][RGB], 90 bins each, in 1/sr at standard
/// scale; bin j of theta_h stands for (j / 90)^2 90 degrees, bin i of theta_d for i degrees.
class MerlSlice {
public:
    static std::optional<MerlSlice> read(const std::string& folder, const std::string& material) {
        std::ifstream file(folder + "/" + material + ".slice", std::ios::binary);
        MerlSlice slice;
        const auto size = static_cast<std::streamsize>(slice.values_.size() * sizeof(float));
        if (!file.read(reinterpret_cast<char*>(slice.values_.data()), size)) return std::nullopt;
        return slice;
    }

    float value(int d, int h, int channel) const {
        return values_[static_cast<std::size_t>((d * bins + h) * 3 + channel)];
    }
    static double thetaH(int h) { return radians(90.0 * h * h / (bins * bins)); }

    /// f at a bin, per channel.
    static std::vector<double> evaluateAt(const Brdf& brdf, int d, int h) {
        const double s = std::sin(radians(d)), c = std::cos(radians(d));
        const double x = c * std::sin(thetaH(h)), z = c * std::cos(thetaH(h));
        return evaluate(brdf, {x, s, z}, {x, -s, z});
    }

    struct Distance {
        double error[3];   ///< median of |ln(f / measured)|
        double bias[3];    ///< median of ln(f / measured): a factor between the two
        double cubeRoot;   ///< mean |f^(1/3) - m^(1/3)| over mean m^(1/3), all channels
        double highlight;  ///< median of |ln(f / measured)| for theta_h < 10 degrees
        /// Relative L2 distance of f cos(theta), samples weighted by solid angle.
        double squares;
    };

    /// Over theta_d = 0, 3, … 75 degrees and every theta_h at which the measured value is positive.
    Distance distance(const Brdf& brdf) const {
        std::vector<double> ratios[3], peaks;
        double apart = 0, all = 0, squaredApart = 0, squared = 0;
        for (int d = 0; d <= 75; d += 3)
            for (int h = 0; h < bins; ++h) {
                const std::vector<double> f = evaluateAt(brdf, d, h);
                const double z = std::cos(radians(d)) * std::cos(thetaH(h));
                const double weight = z * z * std::sin(thetaH(h)) * h * std::sin(radians(2. * d));
                for (int c = 0; c < 3; ++c) {
                    const double m = value(d, h, c), own = f[f.size() == 1 ? 0 : c];
                    if (!(m > 0)) continue;
                    squaredApart += weight * (own - m) * (own - m), squared += weight * m * m;
                    apart += std::abs(std::cbrt(own) - std::cbrt(m)), all += std::cbrt(m);
                    const double ratio = std::log(std::max(own, 1e-9) / m);
                    ratios[c].push_back(ratio);
                    if (thetaH(h) < radians(10)) peaks.push_back(std::abs(ratio));
                }
            }
        Distance result{};
        for (int c = 0; c < 3; ++c) {
            result.bias[c] = median(ratios[c]);
            for (double& ratio : ratios[c]) ratio = std::abs(ratio);
            result.error[c] = median(ratios[c]);
        }
        result.cubeRoot = apart / all, result.highlight = median(peaks);
        result.squares = std::sqrt(squaredApart / squared);
        return result;
    }

    static double median(std::vector<double> values) {
        if (values.empty()) return 0;
        const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
        std::ranges::nth_element(values, middle);
        return *middle;
    }

private:
    static constexpr int bins = 90;
    std::vector<float> values_ = std::vector<float>(bins * bins * 3);
};

}  // namespace hshfit::brdfs
