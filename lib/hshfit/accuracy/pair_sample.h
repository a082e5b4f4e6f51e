#pragma once

#include <hshfit/brdf/brdf.h>

#include <array>
#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

namespace hshfit::inline accuracy {

/// Elevation bands of wo, in degrees: errors are given for each.
constexpr std::array<double, 5> bandEdges{0, 30, 60, 75, 90};
constexpr std::size_t bandCount = bandEdges.size() - 1;
/// The band of a direction above the horizon.
std::size_t bandOf(const Direction& wo);

/// Parts of both hemispheres on which errors hide behind a mean, and in which they are given too.
/// A pair is in the zone
///     horizon   if either direction is within 10 degrees of it
///     mirror    if the half vector is within 5 degrees of the normal
enum class PairZone { horizon, mirror };
constexpr std::size_t zoneCount = 2;
constexpr std::array<std::string_view, zoneCount> zoneNames{"horizon", "mirror"};
bool inZone(PairZone zone, const Direction& wi, const Direction& wo);

/// Pairs of directions with weights that add up to 1: sums over them are means over both
/// hemispheres (d omega_i d omega_o). Pairs of one wo stand together.
struct PairSample {
    std::vector<Direction> wo;       ///< one per group
    std::vector<std::size_t> first;  ///< [group], and the number of pairs: where a group begins
    std::vector<double> x, y, z;     ///< wi of every pair
    std::vector<double> weights;
    /// The number of the independent estimate, below `replicates`, that a pair belongs to. The
    /// scatter of the estimates gives the standard error of the mean.
    std::vector<unsigned char> replicate;
    int replicates = 1;
    /// Per group, the stratum of cos(theta_o) over which albedo is integrated; empty where the
    /// pairs do not cover the hemisphere.
    std::vector<std::size_t> stratum;

    std::size_t size() const { return x.size(); }
    Direction incoming(std::size_t k) const { return {x[k], y[k], z[k]}; }
    /// wo of pair k.
    const Direction& outgoing(std::size_t k) const;
    DirectionBatch group(std::size_t g) const {
        return {x.data() + first[g], y.data() + first[g], z.data() + first[g],
                first[g + 1] - first[g]};
    }
};

struct SpreadOptions {
    int replicates = 8;  ///< each of (`outgoing` + 2) x `incoming` pairs, shifted at random
    int outgoing = 16;   ///< equal strata of cos(theta_o); the lowest is divided into three
    unsigned seed = 1;   ///< others give an independent sample
    int incoming = 256;  ///< of eight, three spread evenly, three towards lobes, two to the horizon
};

/// Pairs over both hemispheres. wo is uniform in solid angle and stratified; the lowest of the
/// equal strata is divided at an eighth and at a 64th of it, so that each replicate has a wo nearly
/// at the horizon. wi is from three rank-1 lattices: uniform in solid angle; with half vectors
/// whose slope is spread evenly over the logarithm from 1e-4 to 10, so that lobes of every width
/// are seen; and with cosines likewise from 1e-4 to 1. Weights come from the mixture (Veach's
/// balance heuristic). The same on every machine: the shifts come from mt19937_64 with `seed`
/// (Cranley & Patterson 1976).
PairSample spreadPairs(const SpreadOptions& options = {});

/// Pairs as given; `weights` one per pair, or empty for equal ones. Replicates take turns. Pairs
/// with a direction that is not above the horizon are left out. Throws UsageError if none is left
/// or a weight is not positive.
PairSample pairsFrom(std::span<const Direction> wi, std::span<const Direction> wo,
                     std::span<const double> weights);

/// f at every pair, [channel * size + pair]. On all threads unless `serial`.
std::vector<double> evaluateOn(const Brdf& brdf, const PairSample& pairs, bool serial = false);

}  // namespace hshfit::inline accuracy
