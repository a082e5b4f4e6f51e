#include <hshfit/irradiance/zonal_form.h>

#include <hshfit/bases/sh.h>

#include <cmath>

namespace hshfit::inline irradiance {
namespace {

constexpr Rgb luminance = {0.2126, 0.7152, 0.0722};

/// Coefficients in band 2 of the zonal harmonic about the axis, of norm 1.
std::array<double, 5> zonalBand(const Direction& axis) {
    std::array<double, 9> values;
    bases::makeSh(3, {})->evaluate(axis, values.data());
    std::array<double, 5> band;
    for (std::size_t k = 0; k < 5; ++k) band[k] = values[4 + k] * std::sqrt(4 * pi / 5);
    return band;
}

}  // namespace

ZonalForm zonalForm(const NineRgb& coefficients) {
    ZonalForm form;
    Direction sum{0, 0, 0};
    for (std::size_t c = 0; c < 3; ++c) {
        sum.x += luminance[c] * coefficients[3][c];
        sum.y += luminance[c] * coefficients[1][c];
        sum.z += luminance[c] * coefficients[2][c];
    }
    const double length = std::sqrt(dot(sum, sum));
    if (length > 0) form.axis = {sum.x / length, sum.y / length, sum.z / length};
    for (std::size_t k = 0; k < 4; ++k) form.linear[k] = coefficients[k];
    const std::array<double, 5> band = zonalBand(form.axis);
    for (std::size_t k = 0; k < 5; ++k)
        for (std::size_t c = 0; c < 3; ++c) form.quadratic[c] += band[k] * coefficients[4 + k][c];
    return form;
}

NineRgb nineOf(const ZonalForm& form) {
    NineRgb nine{};
    for (std::size_t k = 0; k < 4; ++k) nine[k] = form.linear[k];
    const std::array<double, 5> band = zonalBand(form.axis);
    for (std::size_t k = 0; k < 5; ++k)
        for (std::size_t c = 0; c < 3; ++c) nine[4 + k][c] = band[k] * form.quadratic[c];
    return nine;
}

}  // namespace hshfit::inline irradiance
