#pragma once

#include <hshfit/accuracy/pair_sample.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <string>

namespace hshfit::jobs {

/// A row of a CSV of direction pairs: the columns wi_x, wi_y, wi_z, wo_x, wo_y, wo_z as text and
/// as unit vectors, and the column `weight` if there is one. A file without any of the six may have
/// theta_i, phi_i, theta_o, phi_o in degrees; `cells` has the vectors then.
struct PairRow {
    std::array<std::string, 6> cells;
    Direction wi, wo;
    std::optional<double> weight = {};
};

/// The length of a vector whose length is near 1. Squares of others may overflow or vanish: their
/// length is then infinite or 0, and isUnit refuses it too.
inline double lengthOf(double x, double y, double z) {
    return std::sqrt(x * x + y * y + z * z);
}
/// Whether it may stand for 1. Not NaN.
inline bool isUnit(double length) {
    return std::abs(length - 1) <= 1e-3;
}

/// `d` over its length: the rule for directions that somebody else wrote. Throws InputError that
/// begins with `where()` for a length that is not 1 within 0.001; angles are a likely mistake.
Direction unitDirection(const Direction& d, const std::function<std::string()>& where);

/// Calls `take` for each row of the file; other columns are ignored. Throws InputError for a file
/// that cannot be read, a missing column, and cells that are no unit vectors within 0.001, no
/// polar angles from 0 to 180 or, for azimuths and the weight, no numbers.
void readPairs(const std::string& path, const std::function<void(const PairRow&)>& take);

/// The pairs of such a file as a sample, weighted by its column `weight` if there is one.
PairSample readPairSample(const std::string& path);

}  // namespace hshfit::jobs
