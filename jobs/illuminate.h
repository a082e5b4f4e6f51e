#pragma once

#include "listener.h"

#include <hshfit/transport/path_tracer.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::jobs {

struct IlluminateOptions {
    std::string camera = {};  ///< the one to take; empty: all of the scene
    PathOptions path = {};    ///< its `progress` is not called: the listener is
    /// An OpenEXR picture of the same size that `relative_mse` is measured against; empty: none.
    std::string reference = {};
    std::optional<double> stops = {};  ///< of PNG files; none: automatic
    bool force = false;                ///< replace existing files
};

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
    std::size_t rays = 0, cut = 0;
    double mean = 0;  ///< radiance, over pixels and R, G, B
    /// The root of the mean square of the standard errors, and the largest of them with its pixel,
    /// over the mean.
    double standardError = 0, largestError = 0;
    int errorColumn = 0, errorRow = 0;
    double stops = 0;
    std::optional<ReferenceError> reference = {};
    std::vector<std::string> files = {};
};

struct Illuminated {
    std::string scene;
    std::size_t triangles = 0, degenerate = 0;
    double preparationSeconds = 0;  ///< reading, samplers, the tree of the rays
    std::vector<IlluminatedCamera> cameras = {};
};

/// Pictures of a scene file (scene::readScene) with global illumination, in `folder`: CAMERA.exr
/// with R, G, B and their standard errors as error.R, error.G, error.B, and CAMERA.png. The
/// pictures do not depend on the number of threads. Throws UsageError, InputError, NumericError and
/// OutputError.
Illuminated illuminate(const std::string& scene, const std::string& folder,
                       const IlluminateOptions& options, const Listener& listener = {});

}  // namespace hshfit::jobs
