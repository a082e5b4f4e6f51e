#pragma once

#include <jobs/common/listener.h>
#include <jobs/common/option_row.h>

#include <hshfit/transport/path_tracer.h>
#include <hshfit/transport/radiance_cache/cache.h>
#include <hshfit/transport/radiance_cache/cost_prediction.h>

#include <nlohmann/json_fwd.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::jobs {

enum class IlluminateMethod { path, radianceCache };

/// The grounds on which a material that has coefficients gets records: that predictCosts says they
/// are cheaper than sampling, or its loss alone.
enum class RecordsBy { cost, loss };

struct IlluminateOptions {
    IlluminateMethod method = IlluminateMethod::path;
    std::string camera = {};  ///< the one to take; empty: all of the scene
    /// Paths, or lines of sight, through each pixel; none: 64, and 16 by a radiance cache.
    std::optional<std::size_t> samples = {};
    PathOptions path = {};  ///< but for `samples`, which is above; `progress` is not called
    /// For a radiance cache, which takes bounces and seed from `path`.
    CacheOptions cache = {};
    RecordsBy chooseBy = RecordsBy::cost;
    std::vector<std::string> without = {};  ///< terms of the cache that are left out, by name
    bool published = false;                 ///< CacheOptions::asPublished
    double memory = 256;                    ///< MB of its records, at most
    /// A file of records, read where it stands and written with those that were added; empty: none.
    std::string records = {};
    /// An OpenEXR picture of the same size that `relative_mse` is measured against; empty: none.
    std::string reference = {};
    std::optional<double> exposure = {};  ///< stops of PNG files; none: automatic
    /// For the pictures together; each is of as many paths as fit into its share. None: no end.
    std::optional<double> seconds = {};
    bool force = false;  ///< replace existing files
    /// Keep the finished rows of each camera in FOLDER/.hshfit-CAMERA.partial until the files are
    /// written, and take rows that an earlier run kept there.
    bool resume = false;

    bool caches() const { return method == IlluminateMethod::radianceCache; }
};
OptionRows<IlluminateOptions> illuminateOptions();
/// The options of a radiance cache alone. OptionRow::inputs of both are bits of illuminateBit.
OptionRows<IlluminateOptions> cacheOptions();

constexpr unsigned illuminateBit(IlluminateMethod method) {
    return 1U << static_cast<unsigned>(method);
}

/// "path" or "radiance-cache".
std::string_view nameOf(IlluminateMethod method);

/// The distance of a picture from a reference.
struct ReferenceError {
    /// Mean over pixels and R, G, B of (L - R)^2 / (R^2 + (m / 10)^2), m the mean of R.
    double relativeMse = 0;
    double maximum = 0;  ///< the largest of these terms
    int column = 0, row = 0;
};

/// The picture of one camera.
struct IlluminatedCamera {
    std::string name;
    int width = 0, height = 0;
    double seconds = 0, cpuSeconds = 0;  ///< of the picture
    int samples = 0;                     ///< of a pixel
    std::size_t rays = 0, cut = 0;
    std::size_t resumedRows = 0;                                     ///< of an earlier run
    std::optional<std::size_t> records = {}, made = {}, bytes = {};  ///< of the cache
    std::size_t uncovered = 0;  ///< lines of sight that no record reached
    double mean = 0;            ///< radiance, over pixels and R, G, B
    /// The root of the mean square of the standard errors, and the largest of them with its pixel,
    /// over the mean; none of one sample, or of a dark picture. Errors of records are no part.
    std::optional<double> standardError = {}, largestError = {};
    int errorColumn = 0, errorRow = 0;
    double stops = 0;
    std::optional<ReferenceError> reference = {};
    std::vector<std::string> files = {};
};

/// The way in which a material got its indirect light from the cache.
struct LitMaterial {
    std::string name;
    LightWay way = LightWay::sampled;
    int order = 0;
    double loss = 0;
    std::string reason;
    int walks = 1;                          ///< of each line of sight, if sampled
    std::optional<MaterialCost> cost = {};  ///< where a camera sees it and it has coefficients
};

struct Illuminated {
    std::string scene;
    IlluminateMethod method = IlluminateMethod::path;
    std::size_t triangles = 0, degenerate = 0;
    double preparationSeconds = 0;  ///< reading, samplers, the tree of the rays, the cache
    double cacheCpuSeconds = 0;     ///< of choosing for materials and of light on diffuse surfaces
    std::vector<LitMaterial> materials = {};  ///< with a cache
    std::vector<IlluminatedCamera> cameras = {};
};

/// Pictures of a scene file (scene::readScene) with global illumination, in `folder`: CAMERA.exr
/// with R, G, B and their standard errors as error.R, error.G, error.B, and CAMERA.png. The
/// pictures do not depend on the number of threads. Throws UsageError, InputError, NumericError and
/// OutputError.
Illuminated illuminate(const std::string& scene, const std::string& folder,
                       const IlluminateOptions& options, const Listener& listener = {});

/// The answer of `illuminate` (docs/schemas/illuminate.schema.json).
nlohmann::ordered_json illuminateJson(const Illuminated& done);

}  // namespace hshfit::jobs
