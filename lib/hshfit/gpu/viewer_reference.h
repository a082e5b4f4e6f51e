#pragma once

#include <hshfit/brdf/brdf.h>

#include <cstdint>
#include <string>
#include <vector>

namespace hshfit::gpu {

/// Steps of a reference table.
struct ReferenceOptions {
    int thetaHalf = 96, thetaDifference = 48, phiDifference = 33;  ///< isotropic BRDFs
    /// Anisotropic BRDFs: steps of h_x and of h_y in a quadrant, of theta_d and of phi_d. The
    /// product of the last two is at most 256.
    int half = 48, thetaDifferenceOfFour = 16, phiDifferenceOfFour = 14;
    int errorPairs = 1 << 15;  ///< pairs at which the error is measured
};

/// f over half and difference directions (Rusinkiewicz 1998): the table behind the viewer's
/// exact pane. Textures of width x height, layers of (azimuth, rest), linear in between.
///
///     isotropic    theta_h = u^2 pi/2; theta_d = v 89 degrees; phi_d; a single rest
///     anisotropic  h_x = u^2, h_y = v^2 (with a sign, where there is no mirror symmetry); phi_d +
///     phi_h,
///                  the azimuth after the least turn that brings h to the pole; theta_d
///
/// Every axis has nodes at both ends but for periodic azimuths. A node with a direction below 1
/// degree of elevation takes the pair with the largest theta_h above it. The table stores the
/// cube root of f cos(theta_d) in half precision. Its relative steps are 1.5e-3 at most,
/// highlights keep their shape between nodes, and there are no poles at the horizon.
struct ReferenceTable {
    static const double lastThetaDifference;  ///< radians; constant beyond
    bool isotropic = true, bilateral = true, reciprocal = true;
    int width = 1, height = 1, azimuths = 1, rest = 1;
    int channels = 1;  ///< 1 or 3
    /// [rest][azimuth][row][column][channel], binary16.
    std::vector<std::uint16_t> cubeRoots;
    /// Root mean square error of f cos(theta_i), over the root mean square of f cos(theta_i), for
    /// wi and wo uniform over the hemisphere above 5 degrees of elevation, with as many pairs again
    /// whose half vector is near the normal.
    double error = 0;
    /// A GGX roughness about as wide as the highlight, for sampling directions.
    double roughness = 1;

    /// The f that the shader interpolates; `f` has one value per channel.
    void eval(const Direction& wi, const Direction& wo, double* f) const;
};

/// Tabulates a grey or RGB BRDF. Throws UsageError for a spectral one.
ReferenceTable tabulate(const Brdf& brdf, const ReferenceOptions& options = {});

}  // namespace hshfit::gpu
