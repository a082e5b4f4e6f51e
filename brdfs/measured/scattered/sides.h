#pragma once

#include <brdfs/measured/scattered/samples.h>
#include <hshfit/specification/parameters.h>

#include <array>
#include <span>
#include <string>
#include <string_view>

namespace hshfit::brdfs {

/// The option `side` of a scattered format that holds reflections and transmissions.
Parameter sideParameter(std::string_view help);

/// Samples of a surface with two sides, sorted by the side of the light and by whether it goes
/// through: "reflection-front", "reflection-back", "transmission-front", "transmission-back" of
/// the option `side`. Directions are in the frame of the front, +z out of it, and have any sign of
/// z. Pairs of light from the back are turned about y, (-x, y, -z), so that +z points out of that
/// side; outgoing directions of transmissions are mirrored at the surface
/// (hshfit/brdf/transmission.h).
class SidedSamples {
public:
    explicit SidedSamples(const Channels& channels);

    /// Adds a sample as Samples::add does, and returns the samples of its side; null where it is
    /// left out. Directions up to 0.06 degrees below the horizon belong to the front, as roundings
    /// do.
    Samples* add(const Direction& in, const Direction& out, std::span<const double> f,
                 const Row& row);

    /// The samples of a side by its word; of "auto" the samples of the first of the four, in the
    /// order above, that has any. The others are named as left out. Throws InputError that starts
    /// with `where` for a side without samples, naming those that have some.
    Samples take(std::string_view side, const std::string& where);

private:
    std::array<Samples, 4> sides_;
};

/// The words of the option in the order of `SidedSamples`.
inline constexpr std::array<std::string_view, 4> sideWords = {
    "reflection-front", "reflection-back", "transmission-front", "transmission-back"};

}  // namespace hshfit::brdfs
