#pragma once

#include <jobs/common/listener.h>

#include <hshfit/pictures/sphere.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::jobs {

struct SphereSheetOptions {
    SphereRig rig = {};
    int size = SphereOptions{}.size;        ///< pixels along a sphere's square
    int samples = SphereOptions{}.samples;  ///< n: n x n a pixel
    std::optional<double> exposure = {};    ///< stops; none: automatic
};

struct SphereSheet {
    struct Sphere {
        std::string brdf, colours;  ///< SpherePicture::colours
        std::size_t column = 0;     ///< of its first pixel
        std::size_t notFinite = 0;
    };
    std::vector<Sphere> spheres;
    double stops = 0;  ///< the exposure
};

/// Spheres of materials under point lights and a dome (renderSphere), side by side in `output`,
/// .png or .exr. Folders stand for their measured files and coefficient files. Throws UsageError,
/// InputError and OutputError.
SphereSheet render(const std::vector<std::string>& sources, const std::string& output,
                   const SphereSheetOptions& options, const Listener& listener = {});

}  // namespace hshfit::jobs
