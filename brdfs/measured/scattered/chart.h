#pragma once

#include <hshfit/brdf/directions.h>

#include <array>
#include <string_view>
#include <vector>

namespace hshfit::brdfs {

/// A position in a chart; coordinates past the chart's dimensions are 0.
using Point = std::array<double, 4>;

/// The coordinates of scattered samples: f is interpolated over them, and distances of pairs of
/// directions are measured in them.
///
/// Pairs. With p = sqrt(2) sin(theta/2) (cos phi, sin phi), the equal-area disc, s = p_i + p_o and
/// d = p_i - p_o: s = 0 is the mirror configuration and d = 0 the retro-reflecting one.
///   anisotropic  (4 s_x, 4 s_y, d_x, d_y)
///   isotropic    the Hopf map of (s, d), which has no seam and is the same for a pair and the pair
///                turned about the normal: (|s|^2 - |d|^2, 4 s.d, 4 s x d) / sqrt(|s|^2 + |d|^2)
/// Distances across a mirror lobe (s) count four times as much as along it (d): neighbours then lie
/// at the same position in the lobe for other incidences. Both are scaled to radians: turning
/// one direction by a small angle near the mirror configuration moves the point by that angle.
///
/// The other charts hold data that were reduced to fewer coordinates; angles in radians.
enum class Chart {
    isotropic,           ///< 3 coordinates
    anisotropic,         ///< 4
    halfAngle,           ///< theta_h
    halfDifference,      ///< theta_h, theta_d
    halfVector,          ///< half vector on the equal-area disc
    halfVectorDistance,  ///< half vector on the equal-area disc, theta_d
    betweenDirections,   ///< angle between wi and wo
    fromMirror,          ///< angle between wi and the mirror direction of wo
    backAngle,           ///< angle between the normal and wo + mirror(wi)
    backVector,          ///< wo + mirror(wi), normalised, on the equal-area disc
    stark,               ///< |H_p|, |B|: H = (wi + wo)/2, B = (wi - wo)/2, p: on the surface
    neumann,             ///< |H_p|, |B_p|
};

/// The number of coordinates of the points of a chart.
int dimensions(Chart chart);
/// "pairs of directions", "theta_h", …, as `info` prints it.
std::string_view chartName(Chart chart);

/// The position of a pair. Both wi and wo are above the horizon.
Point chartPoint(Chart chart, const Direction& wi, const Direction& wo);

/// The configurations that are taken to have the same f, for the two charts of pairs.
struct Folding {
    bool exchange = false;  ///< wi and wo exchanged
    bool mirror = false;    ///< isotropic: mirrored at the plane of incidence; else at both axes
};

/// The signs that take a point to its images, the identity first.
std::vector<Point> images(Chart chart, const Folding& folding);

/// The canonical one of the images of a point.
Point folded(const Point& point, const std::vector<Point>& images);

/// The Euclidean distance of two points of a chart.
double distance(const Point& a, const Point& b);

}  // namespace hshfit::brdfs
