#pragma once

#include <brdfs/measured/scattered/angle_tables.h>
#include <hshfit/brdf/directions.h>

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace hshfit::brdfs {

/// Interpolation on the tables of a file: bilinear in polar angle and azimuth, linear in the
/// incidence and, between rotations of an anisotropic sample, in the azimuth of wi. Between two
/// incidences a place keeps its polar angle and azimuth about the mirror direction, so that a
/// highlight moves along instead of being mixed with its flank.
///
/// Places without a sample are left out of the sums. f of an isotropic sample at normal incidence
/// is the mean over azimuth of the table there, or of the first one if that is within `reach`.
class TableInterpolant {
public:
    struct Options {
        bool isotropic = true;
        bool mirror = false;  ///< f is the same on both sides of the plane of incidence
        double reach = 0;     ///< radians past the last angle of a table within which it counts
    };

    /// values[sample * channels + channel]. `suits` has to hold.
    TableInterpolant(const std::vector<AngleTable>& tables, std::span<const double> values,
                     std::size_t channels, const Options& options);
    ~TableInterpolant();
    TableInterpolant(const TableInterpolant&) = delete;
    TableInterpolant& operator=(const TableInterpolant&) = delete;

    /// Whether the tables are more than scans in a plane, and have one azimuth of wi if the sample
    /// is isotropic and several if it is not.
    static bool suits(const std::vector<AngleTable>& tables, bool isotropic);

    /// Writes f into out[channel * stride] and returns its weight: 1 where at least half of the
    /// sums rests on samples, and from there to 0 in proportion. Zeros are written for weight 0.
    double evaluate(const Direction& wi, const Direction& wo, double* out,
                    std::size_t stride) const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace hshfit::brdfs
