// Facts about a MERL table for `info` and the quadrature; its cells for fits.

#include <brdfs/measured/cell_measure.h>
#include <brdfs/measured/merl.h>

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace hshfit::brdfs {
namespace {

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
    const bool nearest = interpolation_ == MerlInterpolation::nearest;
    return {
        {"format", "merl"},
        {"dimensions", fmt::format("90 x 90 x {}", layout_.azimuthCount)},
        {"interpolation", nearest ? "nearest" : "linear"},
        {"cells", static_cast<std::int64_t>(layout_.cells())},
    };
}

Census MerlBrdf::census() const {
    Census census;
    census.values = 3 * layout_.cells();
    std::vector<double> cosines(layout_.azimuthCount);
    for (std::size_t p = 0; p < cosines.size(); ++p) {
        cosines[p] = std::cos(radians(static_cast<double>(p)));
    }
    const auto row = [&](std::size_t c, std::size_t h, std::size_t d) {
        const double thetaHalf = merlHalfAngle(static_cast<double>(h));
        const double thetaDifference = radians(static_cast<double>(d));
        const double along = std::cos(thetaHalf) * std::cos(thetaDifference);
        const double across = std::sin(thetaHalf) * std::sin(thetaDifference);
        for (std::size_t p = 0; p < layout_.azimuthCount; ++p) {
            const double value = stored(c, layout_.cell(h, d, p));
            if (along - across * std::fabs(cosines[p]) < 1e-12) {
                ++census.belowHorizon;
            } else if (std::fabs(value / merlScale[c] + 1) < 1e-12) {
                ++census.invalid;  // -1 in the file; the product and the quotient round
            } else {
                census.add(value);
            }
        }
    };
    for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t h = 0; h < MerlLayout::halfCount; ++h) {
            for (std::size_t d = 0; d < MerlLayout::differenceCount; ++d) row(c, h, d);
        }
    }
    return census;
}

void MerlBrdf::giveCells(CellReceiver& receiver) const {
    receiver.reserve(layout_.cells() * 4 / 5);
    for (std::size_t h = 0; h < MerlLayout::halfCount; ++h)
        for (std::size_t d = 0; d < MerlLayout::differenceCount; ++d) {
            const double th = static_cast<double>(h), td = static_cast<double>(d);
            const double measure = cellMeasure(merlHalfAngle, th, radians(td), radians(1));
            for (std::size_t p = 0; p < layout_.azimuthCount; ++p) {
                const DirectionPair pair = merlDirections(th, td, static_cast<double>(p));
                if (std::min(pair.wi.z, pair.wo.z) <= 1e-12) {
                    receiver.belowHorizon();
                    continue;
                }
                const std::size_t cell = layout_.cell(h, d, p);
                const std::array f{stored(0, cell), stored(1, cell), stored(2, cell)};
                if (std::ranges::any_of(f, [](double v) { return v < 0; }))
                    receiver.invalid();
                else
                    receiver.add(pair, f, measure);
            }
        }
}

std::vector<Axis> MerlBrdf::axes() const {
    const double lastHalf = degrees(merlHalfAngle(89));
    const double halfGap = lastHalf - degrees(merlHalfAngle(88));
    const std::size_t azimuths = layout_.azimuthCount;
    return {{"theta_half", "degrees", MerlLayout::halfCount, 0, lastHalf, halfGap},
            {"theta_difference", "degrees", MerlLayout::differenceCount, 0, 89, 1},
            {"phi_difference", "degrees", azimuths, 0, static_cast<double>(azimuths - 1), 1}};
}

}  // namespace hshfit::brdfs
