// What `info` and the quadrature want to know about a MERL table.

#include <brdfs/measured/merl.h>

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace hshfit::brdfs {
namespace {

struct Scan {
    std::int64_t belowHorizon = 0;         ///< cells (not times channels) below by geometry
    std::int64_t invalidBelow = 0;         ///< negative values there
    std::int64_t invalidAbove = 0;         ///< negative values elsewhere
    std::int64_t negativeNotMinusOne = 0;  ///< among all negative values
    std::int64_t notANumber = 0, infinite = 0;
    double least = std::numeric_limits<double>::infinity();
    double greatest = -std::numeric_limits<double>::infinity();

    void add(double stored, double scale, bool below) {
        if (std::isnan(stored)) {
            ++notANumber;
        } else if (std::isinf(stored)) {
            ++infinite;
        } else if (stored < 0) {
            ++(below ? invalidBelow : invalidAbove);
            // -1 is stored unscaled; the product and the quotient round.
            if (std::fabs(stored / scale + 1) > 1e-12) ++negativeNotMinusOne;
        } else if (!below) {
            least = std::min(least, stored);
            greatest = std::max(greatest, stored);
        }
    }
};

Scan scan(const MerlBrdf& brdf) {
    const MerlLayout& layout = brdf.layout();
    Scan result;
    std::vector<double> cosines(layout.azimuthCount);
    for (std::size_t p = 0; p < cosines.size(); ++p) {
        cosines[p] = std::cos(radians(static_cast<double>(p)));
    }
    for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t h = 0; h < MerlLayout::halfCount; ++h) {
            for (std::size_t d = 0; d < MerlLayout::differenceCount; ++d) {
                const double thetaHalf = merlHalfAngle(static_cast<double>(h));
                const double thetaDifference = radians(static_cast<double>(d));
                const double along = std::cos(thetaHalf) * std::cos(thetaDifference);
                const double across = std::sin(thetaHalf) * std::sin(thetaDifference);
                for (std::size_t p = 0; p < layout.azimuthCount; ++p) {
                    const bool below = along - across * std::fabs(cosines[p]) < 1e-12;
                    if (c == 0 && below) ++result.belowHorizon;
                    result.add(brdf.stored(c, layout.cell(h, d, p)), merlScale[c], below);
                }
            }
        }
    }
    return result;
}

/// Sum of the valid channels at a node on phi_d = 90 deg, none if no channel is valid there.
std::optional<double> brightness(const MerlBrdf& brdf, std::size_t h, std::size_t d) {
    const std::size_t cell = brdf.layout().cell(h, d, 90);
    double sum = 0;
    bool any = false;
    for (std::size_t c = 0; c < 3; ++c) {
        const double value = brdf.stored(c, cell);
        if (!(value >= 0) || !std::isfinite(value)) continue;
        sum += value;
        any = true;
    }
    return any ? std::optional(sum) : std::nullopt;
}

}  // namespace

std::vector<Lobe> MerlBrdf::lobes(const Direction& wo) const {
    const auto d = static_cast<std::size_t>(std::min(degrees(polarAngle(wo)) + 0.5, 89.0));
    std::array<std::optional<double>, MerlLayout::halfCount> profile;
    for (std::size_t h = 0; h < profile.size(); ++h) profile[h] = brightness(*this, h, d);
    if (!profile[0]) return {};
    double least = *profile[0];
    for (const auto& value : profile) {
        if (value) least = std::min(least, *value);
    }
    const double half = least + (*profile[0] - least) / 2;
    std::size_t fallen = 1;
    while (fallen < profile.size() && !(profile[fallen] && *profile[fallen] < half)) ++fallen;
    if (fallen == profile.size()) return {};
    // GGX falls to half where tan(theta_h) = sqrt(sqrt(2) - 1) alpha = 0.6436 alpha. Node 1, at
    // 0.011 deg, is the finest that the table resolves.
    const double slope = std::tan(merlHalfAngle(static_cast<double>(fallen)));
    return {{.about = Lobe::About::halfway, .width = slope / 0.6436, .axis = {}}};
}

std::vector<Fact> MerlBrdf::facts() const {
    const Scan found = scan(*this);
    const bool nearest = interpolation_ == MerlInterpolation::nearest;
    std::vector<Fact> facts = {
        {"format", "merl"},
        {"dimensions", fmt::format("90 x 90 x {}", layout_.azimuthCount)},
        {"interpolation", nearest ? "nearest" : "linear"},
        {"cells", static_cast<std::int64_t>(layout_.cells())},
        {"cells_below_horizon", found.belowHorizon},
        {"invalid_values_below_horizon", found.invalidBelow},
        {"invalid_values_above_horizon", found.invalidAbove},
        {"negative_values_not_minus_one", found.negativeNotMinusOne},
        {"nan_values", found.notANumber},
        {"infinite_values", found.infinite},
    };
    if (found.greatest >= found.least) {
        facts.emplace_back("least_value", found.least);
        facts.emplace_back("greatest_value", found.greatest);
    }
    return facts;
}

}  // namespace hshfit::brdfs
