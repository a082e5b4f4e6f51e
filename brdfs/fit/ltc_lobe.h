#pragma once

#include <brdfs/fit/ltc.h>
#include <hshfit/brdf/brdf.h>

namespace hshfit::brdfs {

/// A lobe f(wi, wo) cos(theta_i) as a linearly transformed cosine, for one wo.
struct LtcLobe {
    Ltc ltc;
    double magnitude = 0;  ///< the integral of f cos(theta_i): what to multiply the density by
    double fresnel = 0;    ///< the same with the factor (1 - cos theta_d)^5, Schlick's
    /// The minimised error, (integral of |f cos - magnitude D|^3 / integral of (f cos)^3)^(1/3).
    double error = 0;
    /// Half the integral of |f cos - magnitude D| over the magnitude: the share that is misplaced.
    double misplaced = 0;
    /// The change of magnitude and Fresnel part, over the magnitude, when the quadrature last
    /// became half as dense again. Beyond 2e-4 only for narrow lobes close to grazing.
    double uncertainty = 0;
    int iterations = 0;  ///< of Ceres, over all rounds
    bool converged = false;
};

struct LtcFitOptions {
    /// Quadrature nodes follow the lobe of the last round; rounds end when the matrix moves by
    /// less than `settled` in its own frame.
    int rounds = 8;
    double settled = 1e-3;
    bool symmetric = false;  ///< wo is the normal: the lobe is one of revolution
};

/// The four numbers of the matrix that minimise the cubed error of the paper (above) from `start`
/// by Ceres, with the magnitude held at the integral. `brdf` is isotropic, mirror-symmetric and of
/// one channel; wo.y = 0 and wo.x >= 0. Integrals are taken where D puts its weight: a feature of f
/// much narrower than the start, and far from it, can be missed.
/// Throws NumericError where f is not finite or vanishes.
LtcLobe fitLtc(const Brdf& brdf, const Direction& wo, const Ltc& start,
               const LtcFitOptions& options = {});

/// Where to start when nothing better is known: about the mirror direction, as wide as f says that
/// it is (Brdf::lobes).
Ltc firstLtc(const Brdf& brdf, const Direction& wo);

/// Magnitude, Fresnel part and errors of `ltc` as it is. Nodes lie as they do for `around`, which
/// has to be about as wide; so that two lobes are judged by the same nodes.
LtcLobe judgeLtc(const Brdf& brdf, const Direction& wo, const Ltc& ltc, const Ltc& around);

}  // namespace hshfit::brdfs
