#include <hshfit/transport/surface_scene.h>

#include <hshfit/brdf/vectors.h>
#include <hshfit/error.h>
#include <hshfit/rendering/view.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hshfit::inline transport {
namespace {

struct Corners {
    Direction a, b, c;
};
Corners cornersOf(const Mesh& mesh, std::size_t triangle) {
    const auto& t = mesh.triangles[triangle];
    return {directionOf(mesh.positions[t[0]]), directionOf(mesh.positions[t[1]]),
            directionOf(mesh.positions[t[2]])};
}
/// Twice the area times the normal of the front.
Direction areaVector(const Corners& corners) {
    return cross(corners.b - corners.a, corners.c - corners.a);
}
double areaOf(const Corners& corners) {
    const Direction d = areaVector(corners);
    return std::sqrt(dot(d, d)) / 2;
}

Point weighted(const Corners& corners, double u, double v) {
    const double w = 1 - u - v;
    return {w * corners.a.x + u * corners.b.x + v * corners.c.x,
            w * corners.a.y + u * corners.b.y + v * corners.c.y,
            w * corners.a.z + u * corners.b.z + v * corners.c.z};
}

void append(Mesh& all, const Mesh& mesh) {
    const auto first = static_cast<std::uint32_t>(all.positions.size());
    all.positions.insert(all.positions.end(), mesh.positions.begin(), mesh.positions.end());
    for (const auto& t : mesh.triangles)
        all.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    all.normals.insert(all.normals.end(), mesh.normals.begin(), mesh.normals.end());
}

}  // namespace

SurfaceScene::SurfaceScene(std::vector<SurfaceMaterial> materials,
                           std::vector<SurfaceObject> objects, std::vector<Light> lights)
    : materials_(std::move(materials)), objects_(std::move(objects)), environment_(lights) {
    for (const SurfaceMaterial& material : materials_) {
        if (material.brdf && material.brdf->channels().kind == Channels::Kind::spectral)
            throw UsageError(
                fmt::format("material '{}' has spectra; scenes take grey and RGB", material.name));
    }
    for (std::size_t k = 0; k < objects_.size(); ++k) {
        SurfaceObject& object = objects_[k];
        if (object.material >= materials_.size())
            throw UsageError(fmt::format("object '{}' has no material", object.name));
        if (object.mesh.normals.size() != 3 * object.mesh.triangles.size())
            completeNormals(object.mesh);
        append(all_, object.mesh);
        objectOf_.resize(all_.triangles.size(), static_cast<std::uint32_t>(k));
        object.mesh = {};
    }
    rays_ = std::make_unique<RayScene>(all_);
    for (const MeshVector& p : all_.positions) {
        for (std::size_t k = 0; k < 3; ++k) {
            const double from = std::abs(static_cast<double>(p[k]) - rays_->centre()[k]);
            rounding_ = std::max(rounding_, 32 * 0x1p-24 * from);
        }
    }
    double power = 0;
    for (std::uint32_t t = 0; t < all_.triangles.size(); ++t) {
        const double emitted = meanOf(objects_[objectOf_[t]].emission) * areaOf(cornersOf(all_, t));
        if (!(emitted > 0)) continue;
        emitters_.push_back(t);
        power_.push_back(power += emitted);
    }
}

SurfaceScene::~SurfaceScene() = default;

SurfaceHit SurfaceScene::hitOf(const RayHit& hit, const Direction& direction) const {
    const Corners corners = cornersOf(all_, hit.triangle);
    const Direction towards = -direction;
    Direction flat = normalised(areaVector(corners));
    const bool front = dot(flat, towards) >= 0;
    if (!front) flat = -flat;
    const MeshVector* normals = all_.normals.data() + 3 * std::size_t{hit.triangle};
    const Point n = weighted(
        {directionOf(normals[0]), directionOf(normals[1]), directionOf(normals[2])}, hit.u, hit.v);
    Direction smooth = normalised({n[0], n[1], n[2]});
    if (!(dot(smooth, smooth) > 0.5)) smooth = flat;
    // On the ray's side, and with the ray above its horizon.
    if (dot(smooth, flat) < 0) smooth = -smooth;
    if (!(dot(smooth, towards) > 1e-4)) smooth = flat;
    SurfaceHit result{.position = weighted(corners, hit.u, hit.v),
                      .flat = flat,
                      .frame = frameAt(smooth),
                      .wo = {},
                      .emission = {},
                      .front = front,
                      .distance = hit.distance,
                      .triangle = hit.triangle,
                      .object = objectOf_[hit.triangle]};
    result.wo = normalised(result.frame.toLocal(towards));
    if (front) result.emission = objects_[result.object].emission;
    return result;
}

SurfaceHit SurfaceScene::pointOf(std::uint32_t triangle, double u, double v, bool front) const {
    const Direction normal = normalised(areaVector(cornersOf(all_, triangle)));
    return hitOf({.distance = 0, .triangle = triangle, .u = u, .v = v}, front ? -normal : normal);
}

/// The origin of a ray that leaves a surface. It lies beside the triangle by more than the rounding
/// of Embree's single precision, which grows with the largest coordinate from the scene's middle.
/// The hit itself is on the triangle in double precision, however far the ray has come.
Point SurfaceScene::leaving(const SurfaceHit& from) const {
    const Corners corners = cornersOf(all_, from.triangle);
    double largest = 0;
    const auto& middle = rays_->centre();
    for (const Direction& c : {corners.a, corners.b, corners.c})
        largest = std::max({largest, std::abs(c.x - middle[0]), std::abs(c.y - middle[1]),
                            std::abs(c.z - middle[2])});
    const double step = 8 * 0x1p-24 * largest;
    return {from.position[0] + step * from.flat.x, from.position[1] + step * from.flat.y,
            from.position[2] + step * from.flat.z};
}

/// A flat triangle is never met again by a ray that leaves it.
std::optional<RayHit> SurfaceScene::meeting(const SurfaceHit& from, const Point& origin,
                                            const Direction& direction) const {
    auto hit = rays_->firstHit(origin, direction);
    if (hit && hit->triangle == from.triangle)
        hit = rays_->firstHit(
            origin, direction,
            std::nextafter(static_cast<float>(hit->distance), std::numeric_limits<float>::max()));
    return hit;
}

std::optional<SurfaceHit> SurfaceScene::firstHit(const Point& origin,
                                                 const Direction& direction) const {
    const auto hit = rays_->firstHit(origin, direction);
    if (!hit) return {};
    return hitOf(*hit, direction);
}

std::optional<SurfaceHit> SurfaceScene::firstHit(const SurfaceHit& from,
                                                 const Direction& direction) const {
    const auto hit = meeting(from, leaving(from), direction);
    if (!hit) return {};
    return hitOf(*hit, direction);
}

bool SurfaceScene::visible(const SurfaceHit& from, const Direction& direction,
                           const std::optional<Point>& to) const {
    const Point origin = leaving(from);
    const auto hit = meeting(from, origin, direction);
    if (!hit || !to) return !hit;
    const double gap = std::hypot((*to)[0] - origin[0], (*to)[1] - origin[1], (*to)[2] - origin[2]);
    return hit->distance > gap * (1 - 1e-4);
}

bool SurfaceScene::visible(const SurfaceHit& from, const Direction& direction,
                           const EmitterSample& light) const {
    const Point origin = leaving(from);
    const auto hit = meeting(from, origin, direction);
    if (!hit || hit->triangle == light.triangle) return true;
    const double gap = std::hypot(light.position[0] - origin[0], light.position[1] - origin[1],
                                  light.position[2] - origin[2]);
    if (hit->distance > gap * (1 + 1e-4)) return true;
    return hit->distance > gap * (1 - 1e-4) && adjoin(hit->triangle, light.triangle);
}

/// Whether two triangles have one or two corners in common; with three they are in one place.
bool SurfaceScene::adjoin(std::uint32_t a, std::uint32_t b) const {
    int common = 0;
    for (const std::uint32_t i : all_.triangles[a])
        for (const std::uint32_t j : all_.triangles[b])
            common += all_.positions[i] == all_.positions[j] ? 1 : 0;
    return common == 1 || common == 2;
}

Rgb SurfaceScene::reflectance(const SurfaceHit& hit, const Direction& wi) const {
    const Brdf& brdf = *material(hit).brdf;
    Rgb f{};
    brdf.eval(hit.wo, {&wi.x, &wi.y, &wi.z, 1}, f.data());
    if (brdf.channels().count() == 1) f[2] = f[1] = f[0];
    for (double& value : f)
        if (!std::isfinite(value)) value = 0;
    return f;
}

const SurfaceMaterial& SurfaceScene::material(const SurfaceHit& hit) const {
    return materials_[objects_[hit.object].material];
}

EmitterSample SurfaceScene::sampleEmitters(const std::array<double, 3>& u) const {
    const double wanted = u[2] * power_.back();
    const auto found = std::upper_bound(power_.begin(), power_.end() - 1, wanted);
    const std::uint32_t triangle = emitters_[static_cast<std::size_t>(found - power_.begin())];
    const Corners corners = cornersOf(all_, triangle);
    const double root = std::sqrt(u[0]);
    EmitterSample sample;
    sample.position = weighted(corners, root * (1 - u[1]), root * u[1]);
    sample.normal = normalised(areaVector(corners));
    sample.radiance = objects_[objectOf_[triangle]].emission;
    sample.pdf = meanOf(sample.radiance) / power_.back();
    sample.triangle = triangle;
    return sample;
}

double SurfaceScene::emitterPdf(const SurfaceHit& hit) const {
    return emitters_.empty() ? 0 : meanOf(hit.emission) / power_.back();
}

}  // namespace hshfit::inline transport
