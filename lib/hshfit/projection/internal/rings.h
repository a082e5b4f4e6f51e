#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/coefficients/coefficients.h>
#include <hshfit/quadrature/azimuth_tables.h>
#include <hshfit/quadrature/quadrature.h>

#include <vector>

namespace hshfit::inline projection {

/// The azimuth transform of q = f or f cos(theta_i) on every ring of a grid, for one wo:
///     integral over phi of q_c(theta_ring, phi) az_m(phi) d phi.
/// The transform serves every basis; only the theta functions differ between them.
struct RingSpectrum {
    AzimuthColumns columns{1};
    std::size_t channels = 0, rings = 0;
    std::size_t evaluations = 0;  ///< BRDF evaluations made
    std::vector<double> parts;    ///< [ring][channel][column of m]
    std::vector<double> squares;  ///< per ring: integral over phi of q^2, summed over channels

    std::size_t ringSize() const { return channels * columns.all(); }
    double part(std::size_t ring, std::size_t channel, int m) const {
        return parts[ring * ringSize() + channel * columns.all() + columns.of(m)];
    }
};

/// Samples q on the grid and transforms it for |m| < tables.order(), block by block of points that
/// fit into the nearest caches; only `result` is stored, in memory that it reuses. With `even`, q
/// is taken to be even in phi, only half of each ring is evaluated, and the parts of sines are
/// undefined. Parallel over blocks; the result does not depend on the number of threads. Throws
/// NumericError with the directions where q is not finite.
void sampleRings(const Brdf& brdf, const Direction& wo, const HemisphereGrid& grid,
                 Quantity quantity, const AzimuthTables& tables, bool even, RingSpectrum& result);

}  // namespace hshfit::inline projection
