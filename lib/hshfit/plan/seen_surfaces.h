#pragma once

#include <hshfit/light/views.h>
#include <hshfit/scene/scene.h>
#include <hshfit/transport/surface_scene.h>

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace hshfit::plan {

using scene::Limits;
using scene::Material;
using scene::Scene;

/// A material as cameras see it.
struct SeenMaterial {
    std::size_t rays = 0;  ///< of all cameras
    std::size_t hits = 0;  ///< of these on the material
    /// Groups of surface orientations with the tangent that pictures have, the largest first, and
    /// their shares of the hits.
    std::vector<Orientation> orientations = {};
    std::vector<double> shares = {};
    double spread = 0;     ///< the largest angle between a hit's normal and its group's normal
    ViewRange views = {};  ///< of the middle 98 % of hits, by elevation and by azimuth

    double share() const {
        return rays > 0 ? static_cast<double>(hits) / static_cast<double>(rays) : 0;
    }
};

struct SeenOptions {
    std::size_t rays = 4096;  ///< of a camera, one in each cell of a grid over the picture
    std::size_t mostOrientations = 16;  ///< of a material; each costs a sampling of all lights
    double narrow = 10 * (pi / 180);  ///< groups are added while a normal is farther off than this
};

/// Orientations and views of every material of the scene, from the first hits of rays through the
/// cameras' pixels. Normals are grouped by farthest points and Lloyd's steps (Lloyd 1982). The
/// materials' BRDFs are not used and may be null.
std::vector<SeenMaterial> seenMaterials(const SurfaceScene& surfaces,
                                        std::span<const Camera> cameras,
                                        const SeenOptions& options = {});

/// Puts them in the place of orientations and views that the scene does not state. A material that
/// no camera sees stays upright, with the scene's views.
void takeSeen(Scene& scene, std::span<const SeenMaterial> seen);

/// One sentence on a material, for a person.
std::string sentenceOf(const SeenMaterial& seen, std::size_t cameras);

}  // namespace hshfit::plan
