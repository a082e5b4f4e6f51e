#pragma once

#include <brdfs/fit/gaussian_mixture.h>
#include <brdfs/fit/loss.h>
#include <hshfit/coefficients/outgoing.h>

#include <cstddef>
#include <functional>

namespace hshfit::brdfs {

struct GaussianFitOptions {
    GaussianKind kind = GaussianKind::spherical;
    int lobes = 3;  ///< from 1 to 16
    /// A row of losses() but `picture`. The cube root of f cos(theta_i) is near what a picture
    /// shows; the squares of f cos(theta_i) see the peak alone, those of f the grazing wi.
    Loss::Kind loss = Loss::Kind::cubeRoot;
    /// Scales the amplitudes afterwards so that the albedo of each elevation and channel is kept.
    bool keepEnergy = false;
    /// As quadrature levels of the library; each has 2.25 times the points of the one before.
    int level = 1;
    std::function<void(std::size_t, std::size_t)> progress = {};
};

/// Gaussians of wi for every outgoing direction of the set: the least squares over solid angle of
/// m(f) - m(g), m the map of the loss, over the channels together, by Ceres. Axes stay in the plane
/// of incidence, amplitudes are not negative, sharpness lies in [0.01, 1e7]; shapes are shared by
/// the channels. At normal incidence lobes are round about the normal. Every elevation is fitted
/// from six starts that follow from the peak and the energy of f there, so that the result does not
/// depend on chance, on its neighbours or on threads.
///
/// `brdf` has to be isotropic and mirror-symmetric (UsageError); `outgoing` is elevations or one
/// direction. Throws NumericError where f is not finite, or so narrow that the quadrature has more
/// than a million points.
GaussianMixture fitGaussians(const Brdf& brdf, const OutgoingSet& outgoing,
                             const GaussianFitOptions& options = {});

}  // namespace hshfit::brdfs
