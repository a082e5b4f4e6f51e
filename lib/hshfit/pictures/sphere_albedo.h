#pragma once

#include <hshfit/brdf/brdf.h>

#include <cstddef>
#include <span>
#include <vector>

namespace hshfit::inline pictures {

/// Directional albedo, the integral of f(wi, wo) cos(theta_i) d omega_i, tabulated over outgoing
/// directions: the radiance of a surface under a dome of radiance 1.
///
/// Isotropic: every degree from 0 to 89. Otherwise every 5 degrees to 85 and 89, times 32 azimuths,
/// or 9 over the first quadrant under mirror symmetry. Linear in between, constant past 89 degrees.
/// Each entry is integrated with the grid of level 2 (quadrature.h), whose cost does not depend on
/// the values; values of f that are not finite are left out and counted. Results do not depend
/// on the number of threads.
///
/// Coarse, for pictures that are compared: every 5 degrees to 85 and 89 if isotropic, otherwise
/// every 10 degrees to 80, 85 and 89 times 16 azimuths, or 5; without an estimate of the error.
class AlbedoTable {
public:
    enum class Detail { fine, coarse };
    explicit AlbedoTable(const Brdf& brdf, Detail detail = Detail::fine);

    /// One value per channel of the BRDF, for any wo above the horizon.
    void at(const Direction& wo, std::span<double> albedo) const;

    /// The largest entry of all.
    double largest() const;
    /// The largest change from level 1 to level 2 over entries and channels; 0 if coarse.
    double error() const { return error_; }
    std::size_t notFinite() const { return notFinite_; }

private:
    void lookUpRow(std::size_t row, double share, const Direction& wo,
                   std::span<double> albedo) const;

    std::size_t channels_ = 1, azimuths_ = 1;
    bool mirrored_ = false;
    double azimuthStep_ = 0;
    std::vector<double> thetas_;
    std::vector<double> values_;  ///< [theta][azimuth][channel]
    double error_ = 0;
    std::size_t notFinite_ = 0;
};

}  // namespace hshfit::inline pictures
