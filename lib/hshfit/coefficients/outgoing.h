#pragma once

#include <hshfit/brdf/directions.h>

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::inline coefficients {

/// The outgoing directions for which coefficients are kept, and how they are looked up.
///
/// parabolic   W x H texels, p = (x, y)/(1 + z) (Heidrich & Seidel 1999). The unit disc is inset by
///             one texel: p_x = (2 i + 1 - W)/(W - 2), row 0 at the lowest p_y. Texels outside the
///             disc take the direction where their radius meets the horizon ring; weight 0.
/// elevations  N radii r_k = tan(theta_k / 2) = k / (N - 1/2), phi = 0; for isotropic BRDFs only.
/// direction   one direction, weight 1.
///
/// Directions never go below `horizonRing`, 1 degree above the horizon.
struct OutgoingSet {
    enum class Map { parabolic, elevations, direction };

    Map map = Map::direction;
    int width = 1, height = 1;          ///< elevations: N x 1
    std::vector<Direction> directions;  ///< row by row
    /// Solid angle in sr that each direction stands for; the sum is 2 pi (1 for a direction).
    std::vector<double> solidAngles;

    std::size_t size() const { return directions.size(); }
    /// "32x32", "16" or "52,0": the command-line form.
    std::string spec() const;

    static OutgoingSet parabolic(int width, int height);
    static OutgoingSet elevations(int count);
    static OutgoingSet direction(double theta, double phi);

    /// "WxH", "N" or "theta,phi" in degrees. Throws UsageError with the three forms.
    static OutgoingSet parse(std::string_view text);
};

/// Bilinear (parabolic), linear (elevations) or exact lookup: up to four directions and weights.
struct OutgoingLookup {
    std::array<std::size_t, 4> index{};
    std::array<double, 4> weight{};
    int count = 0;
    /// Azimuth by which wi is to be turned back before the coefficients apply (elevations).
    double turn = 0;
};
OutgoingLookup lookUp(const OutgoingSet& set, const Direction& wo);
/// The same for an elevation set alone, by tan(theta_o / 2) in [0, 1]; no turn.
OutgoingLookup lookUpElevation(const OutgoingSet& set, double tangent);

}  // namespace hshfit::inline coefficients
