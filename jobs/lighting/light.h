#pragma once

#include <jobs/common/option_row.h>

#include <hshfit/coefficients/light_coefficients.h>
#include <hshfit/light/light_nodes.h>
#include <hshfit/light/sun_split.h>

#include <nlohmann/json_fwd.hpp>

#include <optional>
#include <string>
#include <vector>

namespace hshfit::jobs {

struct LightOptions {
    std::string basis = "sh";
    int order = 10;
    bool condonShortley = false;
    std::optional<Orientation> normal = {};  ///< of a hemisphere; none: the whole sphere
    double tolerance = 1e-6;                 ///< of coefficients that come from quadrature
    bool wavelets = false;                   ///< the captured energy of the best SOHO wavelets too
    bool splitSun = false;                   ///< the sun of a picture and the rest beside the file
};
OptionRows<LightOptions> lightOptions();

/// A picture as a sun and the rest.
struct SplitLight {
    SunSplit split;
    std::string rest;           ///< path of the picture without the sun
    std::string sun;            ///< specification
    std::string specification;  ///< of the sum, which is the light
    /// The relative difference of the coefficients of the sum from the coefficients of the picture,
    /// root of the sum of squares: of all bands, and of band 0 alone.
    double error = 0, meanError = 0;
};

/// `split` of docs/schemas/light.schema.json.
nlohmann::ordered_json splitJson(const SplitLight& split);

struct ProjectedLight {
    LightCoefficients light;
    std::vector<double> bands;  ///< energy of each, sum over m and channels of c^2
    /// The least order that captures the shares below; none within the order asked for.
    std::vector<std::optional<int>> enough;
    /// The captured share by the best n^2 wavelets, n = 1 .. order, and their error; if asked for
    /// and the energy exists.
    std::optional<LightCurve> wavelets = {};
    double waveletError = 0;
    /// The least number of wavelets among those that captures each share.
    std::vector<std::optional<int>> enoughWavelets = {};
    std::vector<std::string> remarks = {};  ///< on the files of the light
    std::optional<SplitLight> split = {};
};

/// Shares of the energy, one for each order in `enough`.
inline constexpr double lightShares[] = {0.9, 0.99, 0.999};

/// Coefficients of the sum of all specifications (light/catalog.h), to a file unless `output` is
/// empty. With `splitSun` the only specification is a picture, and NAME_rest.exr is written beside
/// the file NAME.json: throws UsageError for another light, and as splitSun does.
ProjectedLight light(const std::vector<std::string>& specs, const std::string& output,
                     const LightOptions& options);

}  // namespace hshfit::jobs
