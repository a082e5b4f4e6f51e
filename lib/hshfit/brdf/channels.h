#pragma once

#include <string>
#include <vector>

namespace hshfit::inline brdf {

/// The colours or wavelengths that the values of a BRDF or of coefficients are for. grey: one value
/// that holds for every colour; rgb: linear Rec. 709; spectral: one per wavelength. named: elements
/// of Mueller matrices and other quantities by name, each at every wavelength, the first name
/// first; they may be below 0, and none but an "m00", which comes first, is a reflectance.
struct Channels {
    enum class Kind { grey, rgb, spectral, named };

    Kind kind = Kind::grey;
    std::vector<double> wavelengths = {};  ///< nm, ascending; of named ones none: one value each
    std::vector<std::string> quantities = {};  ///< only for named

    std::size_t count() const;
    /// "grey"; "R", "G", "B"; "550nm" and the like; "m01", or with wavelengths "m01_550nm".
    std::vector<std::string> names() const;
    /// The number of channels, the first ones, that are a reflectance for unpolarised light.
    std::size_t reflectances() const;
    /// Whether values for these channels serve as ones for `whole`: the same channels, or grey for
    /// channels that are all reflectances.
    bool serve(const Channels& whole) const;
    bool operator==(const Channels&) const = default;

    static Channels grey() { return {}; }
    static Channels rgb() { return {Kind::rgb, {}}; }
    static Channels spectral(std::vector<double> nanometres) {
        return {Kind::spectral, std::move(nanometres)};
    }
    static Channels named(std::vector<std::string> quantities, std::vector<double> nanometres) {
        return {Kind::named, std::move(nanometres), std::move(quantities)};
    }
};

}  // namespace hshfit::inline brdf
