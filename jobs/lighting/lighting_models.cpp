#include "lighting_models.h"

#include <jobs/common/clock.h>

#include "lighting_cosines.h"

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/light/light_projection.h>
#include <hshfit/lighting/lobe_nodes.h>
#include <hshfit/rendering/view.h>
#include <hshfit/specification/parameters.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

namespace hshfit::jobs {
namespace {

using Kind = LightingModel::Kind;

constexpr std::array lightingTable{
    LightingModel{Kind::coefficients, "coefficients",
                  "harmonics of f cos by elevation against rotated coefficients of light"},
    LightingModel{Kind::splitSum, "split-sum",
                  "light convolved with the BRDF's own lobe in levels of a cube map, scaled by "
                  "elevation; irradiance in nine coefficients"},
    LightingModel{Kind::cosines, "ltc",
                  "linearly transformed cosines of the BRDF for polygons of light"},
    LightingModel{Kind::prefiltered, "prefiltered",
                  "lookups in an environment that an engine has prefiltered for GGX, whatever its "
                  "light"},
};

double secondsOf(const std::function<void()>& work) {
    const auto start = Clock::now();
    work();
    return secondsSince(start);
}

}  // namespace

std::span<const LightingModel> lightingModels() {
    return lightingTable;
}

std::vector<const LightingModel*> selectLightingModels(std::string_view names) {
    std::vector<std::string_view> known;
    for (const LightingModel& model : lightingTable) known.push_back(model.name);
    std::vector<bool> wanted(lightingTable.size(), names == "all");
    for (std::size_t from = 0; names != "all" && from <= names.size();) {
        const std::size_t to = std::min(names.find(',', from), names.size());
        const std::string_view name = names.substr(from, to - from);
        bool found = false;
        for (std::size_t k = 0; k < lightingTable.size(); ++k) {
            if (lightingTable[k].name != name) continue;
            wanted[k] = found = true;
        }
        if (!found)
            throw UsageError(fmt::format("unknown model of lighting '{}'{}; known: all, {}", name,
                                         suggestion(name, known), joined(known)));
        from = to + 1;
    }
    std::vector<const LightingModel*> models;
    for (std::size_t k = 0; k < lightingTable.size(); ++k)
        if (wanted[k]) models.push_back(&lightingTable[k]);
    return models;
}

const lighting::ElevationTable& LightingTables::table(Kind kind) const {
    switch (kind) {
        case Kind::coefficients:
            return harmonics->table;
        case Kind::splitSum:
            return splitSum->table;
        case Kind::prefiltered:
            return prefiltered->table;
        case Kind::cosines:
            break;
    }
    return cosines->table;
}

std::size_t LightingTables::bytes(Kind kind) const {
    return table(kind).bytes();
}

LightingTables fitLightingTables(const Brdf& brdf, std::span<const LightingModel* const> models,
                                 const LightingTableOptions& options) {
    const lighting::ElevationRows rows{.count = options.rows};
    if (options.rows < 2 || options.rows > 1024)
        throw UsageError(fmt::format("{} elevations: from 2 to 1024 are possible", options.rows));
    const std::size_t steps = options.azimuthSteps;
    if (steps < 1 || steps > 64)
        throw UsageError(
            fmt::format("{} azimuths in a quarter turn: from 1 to 64 are possible", steps));
    LightingTables tables{.azimuths = lighting::AzimuthNodes(brdf.laws(), steps),
                          .inPlane = lighting::lobesInPlane(brdf.laws())};
    for (const LightingModel* model : models) {
        tables.seconds[static_cast<int>(model->kind)] = secondsOf([&] {
            if (model->kind == Kind::coefficients)
                tables.harmonics = lighting::fitHarmonics(brdf, options.order, rows, steps);
            else if (model->kind == Kind::splitSum)
                tables.splitSum = lighting::fitSplitSum(brdf, rows, steps);
            else if (model->kind == Kind::prefiltered)
                tables.prefiltered = lighting::fitPrefiltered(
                    brdf, lighting::prefilterNamed(options.engine), options.lobes, rows, steps);
            else
                tables.cosines = fitCosineTable(brdf, rows, steps);
        });
    }
    return tables;
}

std::size_t LightingEnvironment::bytes(Kind kind) const {
    constexpr std::size_t single = 4, half = 2;
    switch (kind) {
        case Kind::coefficients:
            return harmonics->light().size() * 3 * single;
        case Kind::splitSum:
            return cube.texels() * 4 * (fitsHalf(cube) ? half : single) + 9 * 3 * single;
        case Kind::prefiltered:
            return 0;
        case Kind::cosines:
            break;
    }
    return areas.size() * 5 * 3 * single;
}

bool fitsHalf(const lighting::EnvironmentCube& cube) {
    constexpr float largestHalf = 65504;
    return std::ranges::all_of(cube.levels, [&](const lighting::EnvironmentCube::Level& level) {
        return std::ranges::all_of(level.rgb, [&](float v) { return std::abs(v) <= largestHalf; });
    });
}

LightingEnvironment lightFor(const LightingTables& tables, std::span<const Light> lights,
                             const LightingTableOptions& options) {
    LightingEnvironment result;
    if (tables.harmonics) {
        result.seconds[0] = secondsOf([&] {
            result.harmonics = std::make_shared<lighting::HarmonicShading>(
                *tables.harmonics,
                projectLight(lights, *bases::make("sh", tables.harmonics->order)));
        });
    }
    if (tables.splitSum) {
        result.seconds[1] = secondsOf([&] {
            result.cube = lighting::prefilter(*tables.splitSum, lights, options.face);
            result.irradiance = lighting::irradianceNine(lights);
        });
    }
    if (tables.cosines)
        result.seconds[2] =
            secondsOf([&] { result.areas = lighting::areaLights(lights, options.tiles); });
    if (tables.prefiltered)
        result.seconds[3] = secondsOf([&] {
            result.engineCube = lighting::prefiltered(*tables.prefiltered->engine, lights);
        });
    return result;
}

lighting::Shading shadingOf(Kind kind, const LightingTables& tables,
                            const LightingEnvironment& light) {
    if (kind == Kind::coefficients) {
        return [&light](const Direction& normal, const Direction& viewer) {
            return light.harmonics->radiance(normal, viewer, frameAt(normal).tangent);
        };
    }
    if (kind == Kind::splitSum) {
        return [&](const Direction& normal, const Direction& viewer) {
            return lighting::radiance(*tables.splitSum, light.cube, light.irradiance, normal,
                                      viewer, frameAt(normal).tangent);
        };
    }
    if (kind == Kind::prefiltered) {
        return [&](const Direction& normal, const Direction& viewer) {
            return lighting::radiance(*tables.prefiltered, light.engineCube, normal, viewer,
                                      frameAt(normal).tangent);
        };
    }
    return [&](const Direction& normal, const Direction& viewer) {
        return lighting::radiance(*tables.cosines, light.areas, normal, viewer,
                                  frameAt(normal).tangent);
    };
}

}  // namespace hshfit::jobs
