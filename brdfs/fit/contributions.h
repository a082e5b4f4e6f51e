#pragma once

#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::brdfs {

/// A quantity with an error q that all samples share.
///     scale      readings are 1 + q times what they should be
///     linearity  1 + q log10(f / largest f) times: q for each decade below the largest
///     offset     f + q
///     dark       f + q / cos(theta_o)
///     incidence  the zero of the angle of incidence (AngleZeros), degrees
///     detector   the zero of the detector's angle, degrees
struct ActsOn {
    enum class Kind { scale, linearity, offset, dark, incidence, detector };
    Kind kind = Kind::scale;
    std::string_view name, unit;
};
std::span<const ActsOn> contributionKinds();

/// The distribution of an error within its half width; its standard deviation is that over
/// `divisor` (JCGM 100:2008, 4.3.7 and 4.3.9).
struct ErrorDistribution {
    std::string_view name;
    double divisor = 0;  ///< 0: stated as a standard uncertainty only
};
std::span<const ErrorDistribution> errorDistributions();

/// A contribution to the uncertainty of a fit beside the scatter of its samples.
struct Contribution {
    std::string name;
    char type = 'B';
    std::string_view distribution = errorDistributions().front().name;
    double standard = 0;  ///< standard uncertainty, in `on.unit`
    double degrees = std::numeric_limits<double>::infinity();
    ActsOn on = contributionKinds().front();
};

/// "0.8%" or "0.008": the standard uncertainty of a scale. Throws UsageError.
Contribution parseCalibration(std::string_view text);

/// A file of contributions: JSON {"format": "hshfit-budget", "version": 1, "contributions":
/// [{...}]}, or CSV with a line of names. Fields: name; on (ActsOn); one of half_width and
/// standard_uncertainty, with % for a share; and, if they differ from the defaults, type,
/// distribution, degrees_of_freedom. Throws InputError.
std::vector<Contribution> readContributions(const std::string& path);

}  // namespace hshfit::brdfs
