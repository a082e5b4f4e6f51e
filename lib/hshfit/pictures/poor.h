#pragma once

#include <hshfit/pictures/picture_error.h>

#include <optional>
#include <string>

namespace hshfit::inline pictures {

/// The bounds beyond which a result is called poor, in every command: less than 90 % of the energy
/// captured, a mean FLIP above 0.1 (a Lambert surface that is 5 % too bright), or a dip or peak
/// above 10 % that the source does not have.
struct PoorBounds {
    double captured = 0.9, flip = 0.1, extremum = 0.1;
};

/// A sentence without its point for the first of these that a result exceeds; none for a good one.
/// Without a captured share or a picture error, that does not count.
std::optional<std::string> poorReason(const std::optional<double>& captured,
                                      const std::optional<PictureError>& error,
                                      const PoorBounds& bounds = {});

}  // namespace hshfit::inline pictures
