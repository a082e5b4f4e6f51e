#pragma once

#include <hshfit/brdf/directions.h>

#include <array>
#include <cstddef>

namespace hshfit::brdfs {

/// The layout of a MERL `.binary` file (Matusik et al. 2003, "A Data-Driven Reflectance Model",
/// ACM TOG 22(3)): int32 {90, 90, P}, then float64 planes for R, G and B, little-endian; P is 180,
/// or 360 for materials that are not reciprocal. Cell (h, d, p) of a plane is at p + P (d + 90 h)
/// and stands for the node
///     theta_h = (h/90)^2 90 deg,     theta_d = d deg,     phi_d = p deg
/// of Rusinkiewicz' half and difference angles (1998): h is the half vector, and (theta_d, phi_d)
/// is wi in the frame in which h is the pole and the normal lies at azimuth 180 deg.
/// The values times `merlScale` are f in 1/sr. Negative values mark cells without a value.
struct MerlLayout {
    static constexpr std::size_t halfCount = 90;
    static constexpr std::size_t differenceCount = 90;
    static constexpr std::size_t headerBytes = 12;

    std::size_t azimuthCount = 180;

    std::size_t cells() const { return halfCount * differenceCount * azimuthCount; }
    std::size_t fileBytes() const { return headerBytes + 3 * cells() * sizeof(double); }
    std::size_t cell(std::size_t h, std::size_t d, std::size_t p) const {
        return p + azimuthCount * (d + differenceCount * h);
    }
};

inline constexpr std::array<double, 3> merlScale = {1.0 / 1500, 1.15 / 1500, 1.66 / 1500};

/// theta_h in radians at a fractional index; theta_d and phi_d are `radians(index)`.
constexpr double merlHalfAngle(double h) {
    return (h / 90) * (h / 90) * (pi / 2);
}

/// The pair of directions at (fractional) indices; the half vector is at azimuth 0. Either may lie
/// below the horizon.
DirectionPair merlDirections(double h, double d, double p);

/// Whether one of the two directions is at or below the horizon (within 1e-12 of it).
bool merlBelowHorizon(double h, double d, double p);

}  // namespace hshfit::brdfs
