#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::inline light {

/// The tables of one channel or wavelength of the sky of Hosek and Wilkie (hosek_wilkie_sky.h) in
/// the order of their authors: albedo 0 and 1, turbidity 1 to 10, six control points over the
/// elevation of the sun; at each, nine coefficients in `shape` and one number in `radiance`.
struct HosekWilkieChannel {
    static constexpr std::size_t albedos = 2, turbidities = 10, points = 6, coefficients = 9;
    std::vector<double> shape, radiance;
};

/// The tables of one of the authors' files.
struct HosekWilkieTables {
    enum class Kind { rgb, xyz, spectral };
    Kind kind = Kind::rgb;
    std::vector<HosekWilkieChannel> channels;  ///< R G B, X Y Z, or by `hosekWilkieWavelengths`
};

/// Nanometres of the spectral tables.
constexpr std::array<double, 11> hosekWilkieWavelengths{320, 360, 400, 440, 480, 520,
                                                        560, 600, 640, 680, 720};

/// Reads the C header that the authors publish with their sample code (version 1.4a, 2013), as
/// text: ArHosekSkyModelData_RGB.h with the arrays datasetRGB1 to 3 and datasetRGBRad1 to 3,
/// ..._CIEXYZ.h with datasetXYZ1 to 3 and datasetXYZRad1 to 3, or ..._Spectral.h with dataset320 to
/// dataset720 and datasetRad320 to datasetRad720. Other arrays, such as the ones for the sun's
/// disc, are passed over.
///
/// Throws InputError that starts with `name` for a text without any of these arrays, with some of a
/// kind but not all, with arrays of two kinds, with one twice, and with one that breaks off, has
/// another count, or something in it that is no finite number.
HosekWilkieTables hosekWilkieTablesIn(std::string_view text, const std::string& name);

/// The same from a file of at most 16 MiB.
HosekWilkieTables readHosekWilkieTables(const std::string& path);

}  // namespace hshfit::inline light
