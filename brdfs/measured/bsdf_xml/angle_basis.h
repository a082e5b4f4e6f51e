#pragma once

#include <hshfit/brdf/directions.h>

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::brdfs {

/// The hemisphere cut into rings of elevation, each into equal patches of azimuth (Klems 1994; the
/// bases of LBNL WINDOW). Patches are counted ring by ring from the pole; patch j of a ring with n
/// is centred on azimuth 360 j / n degrees. A ring reaches from its lower bound, inclusive, to its
/// upper one.
class AngleBasis {
public:
    static constexpr std::size_t none = static_cast<std::size_t>(-1);

    struct Ring {
        double lower = 0, upper = 0;  ///< degrees
        std::size_t azimuths = 0;
        std::size_t first = 0;  ///< patch at azimuth 0
    };

    std::string name;

    /// Adds the next ring. The caller has checked that bounds ascend without gaps.
    void add(double upper, std::size_t azimuths);

    const std::vector<Ring>& rings() const { return rings_; }
    std::size_t patches() const { return patches_; }
    std::size_t ringOf(std::size_t patch) const;

    /// Integral of cos(theta) over a patch of the ring: pi (sin^2 upper - sin^2 lower) / azimuths.
    /// Over all patches these add up to pi if the last ring ends at the horizon.
    double projectedSolidAngle(std::size_t ring) const { return projected_[ring]; }

    /// The patch of a direction with z > 0; `none` beyond the last ring.
    std::size_t patchOf(double x, double y, double z) const;

    /// cos(theta) where rings meet, descending, without the pole and the horizon.
    std::vector<double> boundaryCosines() const;

    /// Whether every patch turned by 180 degrees, or mirrored at the xz or the yz plane, is a
    /// patch.
    bool symmetric() const;
    /// The image of a patch when azimuths phi become sign * phi + turn * 180 degrees.
    std::size_t moved(std::size_t patch, int sign, int turn) const;

private:
    std::vector<Ring> rings_;
    std::vector<double> projected_, upperCosine_;
    std::size_t patches_ = 0;
};

/// Bases known by name ("LBNL/Klems Full", "… Half", "… Quarter"; case does not matter), in order
/// of preference; empty for an unknown name. Half and Quarter have two versions: one of WINDOW and
/// of Radiance today (rings end at 45.5, 58.5 and 71.5, or 45 and 63 degrees; 77 and 41 patches),
/// and one of Radiance before (46.5, 61.5 and 76.5, or 46 and 66 degrees; 73 and 41 patches).
std::vector<AngleBasis> standardAngleBases(std::string_view name);

}  // namespace hshfit::brdfs
