#include <hshfit/irradiance/irradiance.h>

#include <hshfit/bases/sh.h>
#include <hshfit/quadrature/quadrature.h>
#include <hshfit/stop_request.h>
#include <hshfit/transfer/convolution.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline irradiance {
namespace {

constexpr double golden = 0.6180339887498949;  // (sqrt 5 - 1) / 2

std::array<double, 9> functionsAt(const Direction& d) {
    static const auto harmonics = bases::makeSh(3, {});
    std::array<double, 9> values;
    harmonics->evaluate(d, values.data());
    return values;
}

}  // namespace

NineRgb irradianceOf(const NineRgb& radiance) {
    const std::vector<double> factors = clampedCosine(3);
    NineRgb result = radiance;
    for (int l = 0; l < 3; ++l)
        for (int m = -l; m <= l; ++m)
            for (double& value : result[static_cast<std::size_t>(slotOf(l, m))])
                value *= factors[static_cast<std::size_t>(l)];
    return result;
}

Rgb evaluateNine(const NineRgb& coefficients, const Direction& normal) {
    const std::array<double, 9> values = functionsAt(normal);
    Rgb sum{};
    for (std::size_t k = 0; k < 9; ++k)
        for (std::size_t c = 0; c < 3; ++c) sum[c] += coefficients[k][c] * values[k];
    return sum;
}

NineRgb inAxes(const NineRgb& coefficients,
               const std::function<Direction(const Direction&)>& axes) {
    // Products of two functions have degree 4: 3 Gauss rings and 6 azimuths are exact.
    NineRgb result{};
    const GaussRule& rule = gaussLegendre(3);
    constexpr int azimuths = 6;
    for (std::size_t r = 0; r < rule.nodes.size(); ++r) {
        for (int j = 0; j < azimuths; ++j) {
            const Direction d =
                directionFromAngles(std::acos(rule.nodes[r]), 2 * pi * j / azimuths);
            const Rgb value = evaluateNine(coefficients, d);
            const std::array<double, 9> functions = functionsAt(axes(d));
            for (std::size_t k = 0; k < 9; ++k)
                for (std::size_t c = 0; c < 3; ++c)
                    result[k][c] += rule.weights[r] * 2 * pi / azimuths * value[c] * functions[k];
        }
    }
    return result;
}

std::vector<Direction> normalLattice(std::size_t count) {
    std::vector<Direction> normals;
    for (std::size_t k = 0; k < count; ++k) {
        const double z = 1 - (2 * static_cast<double>(k) + 1) / static_cast<double>(count);
        const double s = std::sqrt((1 - z) * (1 + z));
        const double phi = 2 * pi * golden * static_cast<double>(k);
        normals.push_back({s * std::cos(phi), s * std::sin(phi), z});
    }
    return normals;
}

Irradiances atNormals(std::span<const Direction> normals,
                      const std::function<Rgb(const Direction&)>& irradiance) {
    Irradiances result(normals.size());
    tbb::parallel_for(std::size_t{0}, normals.size(), [&](std::size_t k) {
        stopIfRequested();
        result[k] = irradiance(normals[k]);
    });
    return result;
}

double meanOf(const Irradiances& irradiances) {
    double sum = 0;
    for (const Rgb& each : irradiances) sum += each[0] + each[1] + each[2];
    return irradiances.empty() ? 0 : sum / (3 * static_cast<double>(irradiances.size()));
}

IrradianceErrors errorsOf(std::span<const Direction> normals, const Irradiances& direct,
                          const Irradiances& approximation) {
    IrradianceErrors errors;
    const double mean = meanOf(direct);
    if (!(mean > 0)) return errors;
    for (std::size_t k = 0; k < normals.size(); ++k) {
        for (std::size_t c = 0; c < 3; ++c) {
            const double error = std::abs(approximation[k][c] - direct[k][c]) / mean;
            errors.mean += error / (3 * static_cast<double>(normals.size()));
            errors.negative = std::min(errors.negative, approximation[k][c] / mean);
            if (error <= errors.maximum) continue;
            errors.maximum = error;
            errors.worst = normals[k];
        }
    }
    return errors;
}

}  // namespace hshfit::inline irradiance
