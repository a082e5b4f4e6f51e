#pragma once

#include <hshfit/transport/radiance_cache/cache.h>

#include <span>
#include <vector>

namespace hshfit::inline transport::inline radiance_cache {

/// Predictions for a material that takes coefficients: CPU time of its indirect light in the
/// pictures of all cameras by records and by its sampler, at the error of the records. Seconds are
/// numbers of operations times constants of one machine (cost_prediction.cpp), so that they, and
/// what is chosen by them, are the same everywhere; their ratio is what counts. Errors are mean
/// squares over pixels relative to the radiance, with a tenth of its mean added as in relative_mse.
struct MaterialCost {
    double pixels = 0;         ///< that meet the material first
    double error = 0;          ///< of a pixel by records: their noise and their spacing
    double records = 0;        ///< that these pixels need
    double recordSeconds = 0;  ///< of one
    double lookUpSeconds = 0;  ///< of one line of sight
    double cacheSeconds = 0;   ///< of all
    double variance = 0;       ///< of one walk
    double walkSeconds = 0;    ///< of one
    int walks = 0;             ///< of a line of sight, for the same error
    double samplingSeconds = 0;
    bool samplingIsCheaper() const { return samplingSeconds < cacheSeconds; }
};

/// For each material of the scene; without pixels where no camera meets it, or where it has no
/// coefficients. Traces about 4000 lines of sight of each camera, and from some of their hits walks
/// and the rays of records. Independent of threads and of the records there are.
std::vector<MaterialCost> predictCosts(const RadianceCache& cache,
                                       std::span<const Camera* const> cameras, int samples);

}  // namespace hshfit::inline transport::inline radiance_cache
