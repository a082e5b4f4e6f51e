#pragma once

#include <hshfit/brdf/brdf.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace hshfit::lighting {

/// The lobe of a BRDF at normal incidence as a kernel about an axis: (f - even part) cos(theta_i),
/// the mean over channels, as a function of t = tan(alpha / 2), alpha the angle from the axis. The
/// axis is the normal, and for lobes that are not of revolution (lobesInPlane) the lobe's own, with
/// f along the narrowest direction across it, the mean of both sides.
/// Wider and narrower kernels have the same shape in t / scale: a stereographic map of the lobe.
/// Each integrates to 1 over the sphere.
class LobeKernel {
public:
    /// A BRDF without a lobe gets the cosine's.
    /// `evenShare`: of summarise().
    LobeKernel(const Brdf& brdf, double evenShare);
    /// From values at t = tan(alpha / 2), ascending and at most 1; 0 beyond.
    LobeKernel(std::vector<double> t, std::vector<double> values);

    /// Means under the kernel, and its integral before it was scaled to 1.
    struct Moments {
        double integral = 0, meanCosine = 0, meanSquare = 0;  ///< of cos(alpha)
    };
    Moments moments(double scale) const;

    /// Mean of cos(alpha) under the kernel: 1 for a mirror's, falling with `scale`.
    double meanCosine(double scale) const;
    /// The scale of that mean cosine, from 1e-3 to 30.
    double scaleFor(double meanCosine) const;

    /// The kernel at one scale, tabulated for many lookups.
    class Scaled {
    public:
        /// Per steradian.
        double at(double cosine) const {
            const auto last = static_cast<double>(table_.size() - 1);
            const double place = std::sqrt(std::clamp((1 - cosine) / 2, 0.0, 1.0)) * last;
            const auto k = std::min(static_cast<std::size_t>(place), table_.size() - 2);
            const double share = place - static_cast<double>(k);
            return table_[k] + share * (table_[k + 1] - table_[k]);
        }
        /// Values at sin(alpha / 2) = k / (size - 1), between which `at` is linear.
        std::span<const float> table() const { return table_; }

    private:
        friend class LobeKernel;
        std::vector<float> table_;  ///< over sin(alpha / 2), from 0 to 1
    };
    Scaled scaled(double scale) const;

private:
    double shape(double t) const;
    std::vector<double> t_, values_;
};

}  // namespace hshfit::lighting
