#pragma once

#include <string>
#include <vector>

namespace hshfit::inline brdf {

/// The colours or wavelengths that the values of a BRDF or of coefficients are for. grey: one value
/// that holds for every colour; rgb: linear Rec. 709; spectral: one per wavelength.
struct Channels {
    enum class Kind { grey, rgb, spectral };

    Kind kind = Kind::grey;
    std::vector<double> wavelengths;  ///< nm, ascending; only for spectral

    std::size_t count() const;
    /// "grey"; "R", "G", "B"; or "550nm" and the like.
    std::vector<std::string> names() const;

    static Channels grey() { return {}; }
    static Channels rgb() { return {Kind::rgb, {}}; }
    static Channels spectral(std::vector<double> nanometres) {
        return {Kind::spectral, std::move(nanometres)};
    }
};

}  // namespace hshfit::inline brdf
