#include "irradiance.h"

#include <jobs/common/nine_numbers.h>

#include <hshfit/bases/sh.h>
#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>
#include <hshfit/irradiance/direct_irradiance.h>
#include <hshfit/irradiance/geomerics.h>
#include <hshfit/light/catalog.h>
#include <hshfit/light/light_projection.h>
#include <hshfit/light/picture_light.h>
#include <hshfit/light/placement.h>
#include <hshfit/transfer/convolution.h>
#include <hshfit/transfer/windows.h>
#include <hshfit/wording.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace hshfit::jobs {
namespace {

NineRgb nineFrom(const LightCoefficients& light, int order) {
    NineRgb nine{};
    const auto known = static_cast<std::size_t>(std::min(order, 3) * std::min(order, 3));
    for (std::size_t k = 0; k < known; ++k)
        for (std::size_t c = 0; c < 3; ++c) nine[k][c] = light.at(c)[k];
    return nine;
}

/// Multiplies the bands of the light by the factors of the window.
void applyWindow(LightCoefficients& light, LitSurface& result, const std::string& name) {
    if (name == "least-negative") {
        LightCoefficients lit = light;
        for (std::size_t c = 0; c < 3; ++c)
            convolve({lit.at(c), lit.slots()}, clampedCosine(light.order));
        const LeastNegative found =
            leastNegativeWindow(lit.values, light.order, light.condonShortley);
        result.window = windowName(found.window);
        result.factors = found.factors;
    } else {
        result.window = name;
        result.factors = windowFactors(parseWindow(name), light.order);
    }
    if (result.factors.empty()) result.factors.assign(static_cast<std::size_t>(light.order), 1.0);
    for (std::size_t c = 0; c < 3; ++c) convolve({light.at(c), light.slots()}, result.factors);
}

Irradiances byCoefficients(LightCoefficients light, std::span<const Direction> normals) {
    for (std::size_t c = 0; c < 3; ++c)
        convolve({light.at(c), light.slots()}, clampedCosine(light.order));
    const auto harmonics = bases::makeSh(light.order, {});
    return atNormals(normals, [&](const Direction& normal) {
        std::vector<double> values(light.slots());
        harmonics->evaluate(normal, values.data());
        Rgb sum{};
        for (std::size_t c = 0; c < 3; ++c)
            for (std::size_t k = 0; k < values.size(); ++k) sum[c] += light.at(c)[k] * values[k];
        return sum;
    });
}

/// The nine coefficients of which the forms of two and three bands are made, whatever order the
/// errors are asked for.
NineRgb threeBands(std::span<const Light> lights, const NineRgb& nine,
                   const IrradianceOptions& options) {
    if (options.order >= 3) return nine;
    LightCoefficients light = projectLight(lights, *bases::makeSh(3, {}), {.tolerance = 1e-6});
    LitSurface unused;
    applyWindow(light, unused, options.window);
    return nineFrom(light, 3);
}

void writeByNormal(const std::string& path, std::span<const Direction> normals,
                   const Irradiances& direct, const Irradiances& approximation) {
    std::string text = "normal_x,normal_y,normal_z,direct_r,direct_g,direct_b,r,g,b\n";
    for (std::size_t k = 0; k < normals.size(); ++k) {
        text += fmt::format("{},{},{},{},{},{},{},{},{}\n", normals[k].x, normals[k].y,
                            normals[k].z, direct[k][0], direct[k][1], direct[k][2],
                            approximation[k][0], approximation[k][1], approximation[k][2]);
    }
    writeFile(path, text);
}

/// The conventions that are asked for, and the turn of an engine's import.
void chooseConventions(const IrradianceOptions& options, LitSurface& result) {
    const std::string& names = options.engine.empty() ? options.convention : options.engine;
    if (!names.empty()) result.conventions = selectConventions(names);
    if (options.engine.empty()) return;
    if (result.conventions.size() != 1)
        throw UsageError(fmt::format("{} {}: valid: one engine",
                                     Setting{"IrradianceOptions::engine"}, options.engine));
    result.turn = result.conventions.front()->turn;
}

}  // namespace

LitSurface irradianceOfLight(const std::vector<std::string>& specs,
                             const IrradianceOptions& options) {
    LitSurface result;
    chooseConventions(options, result);
    LightSpecification specification{.text = fmt::format("{}", fmt::join(specs, " + ")),
                                     .lights = lightsOf(specs)};
    if (result.turn != 0)
        for (Light& each : specification.lights)
            each = turned(std::move(each), radians(result.turn));
    LightCoefficients light =
        projectLight(specification.lights, *bases::makeSh(options.order, {}), {.tolerance = 1e-6});
    result.light = specification.text;
    result.remarks = remarksOf(specification.lights);
    applyWindow(light, result, options.window);
    result.radiance = nineFrom(light, options.order);
    result.irradiance = irradianceOf(result.radiance);

    const std::vector<Direction> normals = normalLattice(options.normals);
    const DirectIrradiance truth(specification.lights);
    const Irradiances direct =
        atNormals(normals, [&](const Direction& normal) { return truth.at(normal); });
    result.meanIrradiance = meanOf(direct);
    const Irradiances approximation = byCoefficients(light, normals);
    result.error = errorsOf(normals, direct, approximation);
    const auto errorOfNine = [&](const NineRgb& nine) {
        return errorsOf(normals, direct, atNormals(normals, [&](const Direction& normal) {
                            return evaluateNine(nine, normal);
                        }));
    };
    result.nineError = errorOfNine(result.irradiance);
    const NineRgb source = threeBands(specification.lights, result.radiance, options);
    result.zonal = zonalForm(source);
    result.zonalError = errorOfNine(irradianceOf(nineOf(result.zonal)));
    result.geomericsError =
        errorsOf(normals, direct, atNormals(normals, [&](const Direction& normal) {
                     return geomericsIrradiance(source, normal);
                 }));
    if (!options.byNormal.empty()) writeByNormal(options.byNormal, normals, direct, approximation);
    return result;
}

}  // namespace hshfit::jobs
