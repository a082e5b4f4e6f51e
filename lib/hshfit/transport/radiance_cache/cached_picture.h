#pragma once

#include <hshfit/transport/radiance_cache/cache.h>

namespace hshfit::inline transport::inline radiance_cache {

struct CachedPictureOptions {
    int samples = 16;  ///< rays through a pixel, stratified as far as the number allows
    /// Receives finished and total work, records and rows together.
    TransportProgress progress = {};
};

/// A picture with its records.
struct CachedPicture {
    PathPicture picture;
    std::size_t made = 0;       ///< records that this picture added
    std::size_t uncovered = 0;  ///< meetings of lines of sight that no record reaches, sampled
};

/// Makes the records that a camera needs and takes its picture by them. Records are made in rounds
/// from a coarse raster of pixels to each pixel: all of a round in parallel, their places and
/// order by the pixels alone, so that nothing depends on the number of threads. `error` is the
/// standard error by the samples of a pixel; the error of the records, which they share, is not in
/// it.
CachedPicture takePicture(RadianceCache& cache, const Camera& camera,
                          const CachedPictureOptions& options);

/// A record that a camera sees.
struct RecordPlace {
    int column = 0, row = 0;
    std::size_t record = 0;
};
std::vector<RecordPlace> recordPlaces(const RadianceCache& cache, const Camera& camera);

}  // namespace hshfit::inline transport::inline radiance_cache
