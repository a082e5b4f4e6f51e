#pragma once

#include <hshfit/light/light_samples.h>
#include <hshfit/meshes/mesh.h>
#include <hshfit/pictures/sphere.h>

#include <cstddef>
#include <vector>

namespace hshfit::inline rendering {

/// A picture's axes in the world: to the right, up, and to the viewer.
struct View {
    /// From the direction (theta, phi) to the viewer, radians; the world's +z is up in the picture.
    /// `fieldOfView` is the angle of a perspective picture from edge to edge, below pi; 0: lines
    /// of sight are parallel.
    View(double theta, double phi, double fieldOfView = 0);
    Direction toWorld(const Direction& inPicture) const;

    Direction right, up, towards;
    double fieldOfView = 0;
};

/// The points of a surface that the samples of a square picture see.
struct SurfacePoints {
    int size = 0;                    ///< pixels along an edge
    std::vector<float> coverage;     ///< [row][column], the share of samples on the surface
    std::vector<std::size_t> first;  ///< [pixel]: its points go up to first[pixel + 1]
    std::vector<Direction> normals;  ///< in the world, of each point
    std::vector<Direction> viewers;  ///< the same of the viewer; none where all are view.towards

    std::size_t count() const { return normals.size(); }
    const Direction& viewer(std::size_t k, const View& view) const {
        return viewers.empty() ? view.towards : viewers[k];
    }
};

/// A unit sphere in n x n samples a pixel, with the radius of sphere pictures (sphere.h); in
/// perspective its outline has that radius.
SurfacePoints spherePoints(const View& view, int size, int samples);

/// A mesh, framed so that its extent in the picture is the sphere's; in perspective, the extent of
/// its nearest plane. Normals are interpolated
/// between corners; they belong to the side that is seen, and are bent towards the viewer where
/// they would turn away, to a cosine of 0.01. Without shadows or reflections of the mesh in itself.
SurfacePoints meshPoints(const Mesh& mesh, const View& view, int size, int samples);

/// The axes of a surface with that normal. The tangent is horizontal, along z x n (+x where n is
/// +z or -z): brushed materials are brushed along the parallels.
Frame frameAt(const Direction& normal);

/// The picture of radiances at the points, averaged over each pixel's.
SpherePicture pictureOf(const SurfacePoints& points, const Radiance& radiance);

}  // namespace hshfit::inline rendering
