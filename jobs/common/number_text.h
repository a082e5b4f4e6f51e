#pragma once

#include <hshfit/brdf/directions.h>

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::jobs {

/// Finite numbers with commas between them, from `least` to `most` of them. Throws UsageError that
/// names `member`, as Setting does, and asks for `form`.
std::vector<double> numbersIn(const std::string& text, std::size_t least, std::size_t most,
                              std::string_view member, std::string_view form);

/// Polar angle and azimuth in degrees.
struct Angles {
    double theta = 0, phi = 0;

    /// With a z of exactly 0 at 90 degrees, where the cosine of pi / 2 as a double is 6e-17.
    Direction direction() const;
};

/// "THETA,PHI", theta from 0 to `mostTheta`. Throws likewise.
Angles anglesIn(const std::string& text, std::string_view member, double mostTheta = 90);
std::string anglesText(const Angles& angles);

}  // namespace hshfit::jobs
