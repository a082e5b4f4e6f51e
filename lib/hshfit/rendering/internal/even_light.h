#pragma once

#include <hshfit/rendering/direct_integral.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <vector>

namespace hshfit::inline rendering {

/// The radiance of a light that shines alike from all around; nothing for other lights.
std::optional<Rgb> evenRadianceOf(const Light& light);

/// Radiance under even light of radiance 1, which depends on the direction of the viewer alone: by
/// interpolation in cells of (theta, phi), biquadratic through the corners and the middles of a
/// cell and of its sides. Cells are cut until bilinear interpolation between the corners is off by
/// less than half of the tolerance in these middles: a quarter of that bounds the error in the
/// four parts of a cell, an eighth of the tolerance.
class EvenLight {
public:
    struct Value {
        Rgb radiance{};
        double error = 0;  ///< summed over R, G and B: of interpolation and of the integrals
    };

    /// At most `most` integrals; cells that would need more of them, or whose time is over, do not
    /// serve. Nor do tables with steps, whose values between such middles are unknown.
    EvenLight(const Brdf& brdf, const IntegrationOptions& options, std::size_t most,
              const std::function<bool()>& goesOn);

    /// Nothing where no cell serves; those directions have integrals of their own.
    std::optional<Value> at(const Direction& wo) const;
    std::size_t evaluations() const { return evaluations_; }  ///< of f

private:
    /// In units of the finest step, of theta and of phi.
    struct Place {
        std::uint32_t theta, phi;
        auto operator<=>(const Place&) const = default;
    };
    struct Cell {
        Place corner;
        std::uint32_t size;
        std::size_t firstPart = 0;  ///< of those that it is cut into
        bool serves = false;
        double error = 0;
    };
    using Integrals = std::map<Place, Value>;

    Place within(const Place& place) const;
    /// Corner or middle i of 0, 1, 2 along theta and j along phi.
    Place placeIn(const Cell& cell, std::uint32_t i, std::uint32_t j) const;
    Value sum(const Cell& cell, const std::array<double, 3>& alongTheta,
              const std::array<double, 3>& alongPhi) const;
    void integrate(const std::vector<Place>& places, const Brdf& brdf,
                   const IntegrationOptions& options, const std::function<bool()>& goesOn);
    std::vector<std::size_t> judged(const std::vector<std::size_t>& open, double tolerance);

    bool isotropic_, mirrored_;
    std::uint32_t azimuths_ = 1;  ///< cells along phi before any is cut
    std::vector<Cell> cells_;
    Integrals integrals_;
    std::size_t evaluations_ = 0;
};

}  // namespace hshfit::inline rendering
