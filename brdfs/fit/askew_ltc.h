#pragma once

#include <hshfit/brdf/directions.h>

#include <array>
#include <vector>

namespace hshfit::brdfs {

/// A linearly transformed cosine (ltc.h) that need not lie in the plane of incidence: W takes
/// directions back to the cosine, D(w) = max(0, (W w)_z) |det W| / (pi |W w|^4). Factors of W and
/// turns about +z on its left do not change D; so the form | a 0 b | e 1 f | c g d | is enough, and
/// interpolates. By rows.
using AskewLtc = std::array<std::array<double, 3>, 3>;
/// The lobe of `w` in that form. Throws NumericError for a matrix that takes y to z, or is not
/// finite.
AskewLtc inStandardForm(const AskewLtc& w);
double density(const AskewLtc& w, const Direction& d);
/// The lobe turned by `angle` radians about y, from +z towards +x.
AskewLtc turnedAboutY(const AskewLtc& w, double angle);

/// A lobe f cos(theta_i) at nodes of a quadrature.
struct LobeSamples {
    std::vector<Direction> wi;
    std::vector<double> weights, values;
};

struct AskewFit {
    AskewLtc w;
    /// The minimised error, (integral of |f cos - magnitude D|^3 / integral of (f cos)^3)^(1/3).
    double error = 0;
};
/// The matrix that minimises the cubed error from `start` by Ceres, with the magnitude held at the
/// integral of f cos. The samples have to resolve the lobe; D is seen at them alone.
AskewFit fitAskewLtc(const LobeSamples& samples, const AskewLtc& start);

}  // namespace hshfit::brdfs
