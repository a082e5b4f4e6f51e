#pragma once

#include <jobs/common/listener.h>
#include <jobs/common/option_row.h>

#include <hshfit/lighting/harmonics.h>
#include <hshfit/lighting/lit_surface.h>
#include <hshfit/lighting/prefiltered_lobes.h>
#include <hshfit/lighting/split_sum.h>
#include <hshfit/lighting/transformed_cosines.h>

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::jobs {

/// A row of the table of models that light a BRDF in real time.
struct LightingModel {
    enum class Kind { coefficients, splitSum, cosines, prefiltered };
    Kind kind = Kind::coefficients;
    std::string_view name, summary;
};
std::span<const LightingModel> lightingModels();
std::vector<Word> lightingWords();  ///< their names, and "all"
/// Models of a comma-separated list of names, or "all". Throws UsageError with the known ones.
std::vector<const LightingModel*> selectLightingModels(std::string_view names);

struct LightingTableOptions {
    std::size_t rows = 32;  ///< elevations of wo
    /// Steps of its azimuth in a quarter turn, where the BRDF is not isotropic.
    std::size_t azimuthSteps = lighting::AzimuthNodes::defaultSteps;
    int order = 5;                 ///< bands of light that meet harmonics
    std::size_t face = 128;        ///< most texels along an edge of the cube's faces
    std::size_t tiles = 64;        ///< quadrilaterals that skies and pictures are cut into
    std::string engine = "three";  ///< prefilterNamed, of prefiltered environments
    std::size_t lobes = 2;         ///< lookups besides the diffuse one, of the same
};

/// Tables of a BRDF, of the models that were asked for; `seconds` in the order of
/// lightingModels().
struct LightingTables {
    std::optional<lighting::HarmonicTable> harmonics = {};
    std::optional<lighting::SplitSumTable> splitSum = {};
    std::optional<lighting::CosineTable> cosines = {};
    std::optional<lighting::PrefilteredTable> prefiltered = {};
    lighting::AzimuthNodes azimuths = {};  ///< of each table
    bool inPlane = true;                   ///< lighting::lobesInPlane of the BRDF
    double seconds[4] = {0, 0, 0, 0};

    const lighting::ElevationTable& table(LightingModel::Kind kind) const;
    std::size_t bytes(LightingModel::Kind kind) const;
};
LightingTables fitLightingTables(const Brdf& brdf, std::span<const LightingModel* const> models,
                                 const LightingTableOptions& options);

/// Light made ready for the tables' models.
struct LightingEnvironment {
    std::shared_ptr<const lighting::HarmonicShading> harmonics = {};
    lighting::EnvironmentCube cube = {};
    irradiance::NineRgb irradiance = {};
    std::vector<lighting::AreaLight> areas = {};
    lighting::EnvironmentCube engineCube = {};  ///< of prefiltered: the engine's own
    double seconds[4] = {0, 0, 0, 0};

    /// Bytes of the light: float32 of coefficients and of quadrilaterals (five texels of R, G, B),
    /// RGBA of the cube in float16, or in float32 where it is brighter than that holds; 0 for an
    /// engine's own cube, which is there without the material.
    std::size_t bytes(LightingModel::Kind kind) const;
};
/// Whether a cube fits float16, up to 65504.
bool fitsHalf(const lighting::EnvironmentCube& cube);
LightingEnvironment lightFor(const LightingTables& tables, std::span<const Light> lights,
                             const LightingTableOptions& options);

/// The model as a function of normal and viewer; both references have to outlive it.
lighting::Shading shadingOf(LightingModel::Kind kind, const LightingTables& tables,
                            const LightingEnvironment& light);

}  // namespace hshfit::jobs
