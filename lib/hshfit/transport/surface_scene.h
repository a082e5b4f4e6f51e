#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/light/light_samples.h>
#include <hshfit/meshes/mesh.h>
#include <hshfit/rays/ray_scene.h>
#include <hshfit/sampling/sampler.h>
#include <hshfit/transport/camera.h>
#include <hshfit/transport/environment_sampler.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::inline transport {

/// The material of surfaces. The BRDF is grey or RGB; without one, only the places of hits are
/// asked for.
struct SurfaceMaterial {
    std::string name;
    std::shared_ptr<const Brdf> brdf;
    std::shared_ptr<const Sampler> sampler;  ///< of the BRDF
};

/// A mesh in the world. Both sides reflect alike; the front emits.
struct SurfaceObject {
    std::string name;
    Mesh mesh;
    std::size_t material = 0;
    Rgb emission{};  ///< radiance that the front emits, the same in every direction
};

/// A ray's meeting with a surface.
struct SurfaceHit {
    Point position{};
    Direction flat;  ///< the triangle's normal, on the side of the ray
    Frame frame;     ///< with the interpolated normal, on the same side; frameAt (view.h)
    Direction wo;    ///< back along the ray, in the frame
    Rgb emission{};  ///< towards the ray
    bool front = true;
    double distance = 0;
    std::uint32_t triangle = 0;  ///< of the scene
    std::size_t object = 0;
};

/// A point of an emitting triangle.
struct EmitterSample {
    Point position{};
    Direction normal;  ///< of its front
    Rgb radiance{};
    double pdf = 0;  ///< per area
    std::uint32_t triangle = 0;
};

/// Meshes with materials and the light on them. Immutable; safe to use from many threads.
class SurfaceScene {
public:
    /// Throws UsageError for an object without such a material and a BRDF of spectra, NumericError
    /// where Embree cannot take the meshes.
    SurfaceScene(std::vector<SurfaceMaterial> materials, std::vector<SurfaceObject> objects,
                 std::vector<Light> lights);
    ~SurfaceScene();
    SurfaceScene(const SurfaceScene&) = delete;
    SurfaceScene& operator=(const SurfaceScene&) = delete;

    std::optional<SurfaceHit> firstHit(const Point& origin, const Direction& direction) const;
    /// The first hit of a ray that leaves a surface; `direction` on the side of its `flat`.
    std::optional<SurfaceHit> firstHit(const SurfaceHit& from, const Direction& direction) const;
    /// Whether nothing lies between a surface and a point, or, without one, infinity.
    bool visible(const SurfaceHit& from, const Direction& direction,
                 const std::optional<Point>& to = {}) const;

    /// Whether the sampled triangle, or a neighbour that the sample's rounding may reach, is the
    /// first that a ray towards the sample meets. Of emitters in one place one is seen.
    bool visible(const SurfaceHit& from, const Direction& direction,
                 const EmitterSample& light) const;

    /// f(wi, wo) at a hit, `wi` in its frame; values that are not finite count as 0.
    Rgb reflectance(const SurfaceHit& hit, const Direction& wi) const;
    const SurfaceMaterial& material(const SurfaceHit& hit) const;

    const EnvironmentSampler& environment() const { return environment_; }
    bool hasEmitters() const { return !emitters_.empty(); }
    /// Samples emitters in proportion to area times radiance, by three independent numbers `u`,
    /// uniform in [0, 1).
    EmitterSample sampleEmitters(const std::array<double, 3>& u) const;
    /// The density of `sampleEmitters` at a hit, per area; 0 where it emits nothing.
    double emitterPdf(const SurfaceHit& hit) const;

    /// A distance that single precision does not tell from 0 in this scene.
    double rounding() const { return rounding_; }
    std::size_t triangles() const { return all_.triangles.size(); }
    const std::vector<SurfaceObject>& objects() const { return objects_; }
    const std::vector<SurfaceMaterial>& materials() const { return materials_; }
    /// All triangles of the objects, one object after the other, in the world.
    const Mesh& mesh() const { return all_; }
    std::size_t objectOf(std::size_t triangle) const { return objectOf_[triangle]; }
    /// The point of a triangle at the weights u and v of its second and third corner, seen from
    /// its front or its back along the normal.
    SurfaceHit pointOf(std::uint32_t triangle, double u, double v, bool front) const;

private:
    SurfaceHit hitOf(const RayHit& hit, const Direction& direction) const;
    Point leaving(const SurfaceHit& from) const;
    std::optional<RayHit> meeting(const SurfaceHit& from, const Point& origin,
                                  const Direction& direction) const;
    bool adjoin(std::uint32_t a, std::uint32_t b) const;

    std::vector<SurfaceMaterial> materials_;
    std::vector<SurfaceObject> objects_;  ///< their meshes moved to `all_`
    Mesh all_;
    std::vector<std::uint32_t> objectOf_;  ///< of each triangle
    std::unique_ptr<RayScene> rays_;
    double rounding_ = 0;
    EnvironmentSampler environment_;
    std::vector<std::uint32_t> emitters_;  ///< triangles
    std::vector<double> power_;            ///< of them, cumulative
};

}  // namespace hshfit::inline transport
