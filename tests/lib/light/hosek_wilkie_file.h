#pragma once

#include <fmt/format.h>

#include <functional>
#include <string>

namespace hshfit::test {

/// The place of a number in the tables of the Hosek-Wilkie sky: the channel from 0, albedo 0 or 1,
/// turbidity 1 to 10, the control point 0 to 5, and the coefficient 0 to 8 in the order A B C D E F
/// G I H, or 9 for the radiance.
struct HosekWilkiePlace {
    int channel, albedo, turbidity, point, coefficient;
};
using HosekWilkieValue = std::function<double(const HosekWilkiePlace&)>;

/// An array in the layout that the authors publish.
inline std::string hosekWilkieArray(const std::string& name, int channel, bool radiance,
                                    const HosekWilkieValue& value) {
    std::string text = "double " + name + "[] =\n{\n";
    for (const int albedo : {0, 1}) {
        for (int turbidity = 1; turbidity <= 10; ++turbidity) {
            text += fmt::format("\t// albedo {}, turbidity {}\n", albedo, turbidity);
            for (int point = 0; point < 6; ++point) {
                for (int k = radiance ? 9 : 0; k < (radiance ? 10 : 9); ++k)
                    text +=
                        fmt::format("\t{:.16e},\n", value({channel, albedo, turbidity, point, k}));
            }
        }
    }
    return text + "};\n\n";
}

/// A file of the authors' layout for "RGB", "XYZ", or "" for wavelengths.
inline std::string hosekWilkieFile(const std::string& space, const HosekWilkieValue& value) {
    std::string text = "/*\nMade by a test.\n*/\n\n",
                pointers = "double* datasets" + space + "[] =\n{\n";
    for (int channel = 0; channel < (space.empty() ? 11 : 3); ++channel) {
        const int number = space.empty() ? 320 + 40 * channel : channel + 1;
        const std::string name = fmt::format("dataset{}{}", space, number);
        text += hosekWilkieArray(name, channel, false, value);
        text +=
            hosekWilkieArray(fmt::format("dataset{}Rad{}", space, number), channel, true, value);
        pointers += "\t" + name + ",\n";
    }
    return text + pointers + "};\n";
}

/// Coefficients of a sky that is brighter about the sun and towards the horizon, made up: the
/// same at all control points, turbidities and albedos.
inline double plainHosekWilkie(const HosekWilkiePlace& place) {
    constexpr double values[] = {-1.1, -0.2, 1, 2, -2, 0.5, 0.1, 1, 0.7};
    return place.coefficient == 9 ? 10 + 2 * place.channel : values[place.coefficient];
}

}  // namespace hshfit::test
