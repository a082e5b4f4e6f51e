#include <hshfit/transport/surface_scene.h>

#include <hshfit/brdf/vectors.h>
#include <hshfit/error.h>
#include <hshfit/rendering/view.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline transport {
namespace {

Direction directionOf(const MeshVector& v) {
    return {v[0], v[1], v[2]};
}
Direction minus(const Direction& a, const Direction& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
Direction opposite(const Direction& d) {
    return {-d.x, -d.y, -d.z};
}
double meanOf(const Rgb& rgb) {
    return (rgb[0] + rgb[1] + rgb[2]) / 3;
}

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
    return cross(minus(corners.b, corners.a), minus(corners.c, corners.a));
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
        if (material.brdf->channels().kind == Channels::Kind::spectral)
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
    const Direction towards = opposite(direction);
    Direction flat = normalised(areaVector(corners));
    const bool front = dot(flat, towards) >= 0;
    if (!front) flat = opposite(flat);
    const MeshVector* normals = all_.normals.data() + 3 * std::size_t{hit.triangle};
    const Point n = weighted(
        {directionOf(normals[0]), directionOf(normals[1]), directionOf(normals[2])}, hit.u, hit.v);
    Direction smooth = normalised({n[0], n[1], n[2]});
    if (!(dot(smooth, smooth) > 0.5)) smooth = flat;
    // Of the ray's side, and with the ray above its horizon.
    if (dot(smooth, flat) < 0) smooth = opposite(smooth);
    if (!(dot(smooth, towards) > 1e-4)) smooth = flat;
    SurfaceHit result{.position = weighted(corners, hit.u, hit.v),
                      .flat = flat,
                      .frame = frameAt(smooth),
                      .wo = {},
                      .emission = {},
                      .distance = hit.distance,
                      .triangle = hit.triangle,
                      .object = objectOf_[hit.triangle]};
    result.wo = normalised(result.frame.toLocal(towards));
    if (front) result.emission = objects_[result.object].emission;
    return result;
}

/// Beside the surface by more than the rounding of single precision at its place.
Point SurfaceScene::leaving(const SurfaceHit& from) const {
    double largest = from.distance;
    for (const double x : from.position) largest = std::max(largest, std::abs(x));
    const double step = 4e-6 * largest;
    return {from.position[0] + step * from.flat.x, from.position[1] + step * from.flat.y,
            from.position[2] + step * from.flat.z};
}

std::optional<SurfaceHit> SurfaceScene::firstHit(const Point& origin,
                                                 const Direction& direction) const {
    const auto hit = rays_->firstHit(origin, direction);
    if (!hit) return {};
    return hitOf(*hit, direction);
}

std::optional<SurfaceHit> SurfaceScene::firstHit(const SurfaceHit& from,
                                                 const Direction& direction) const {
    return firstHit(leaving(from), direction);
}

bool SurfaceScene::visible(const SurfaceHit& from, const Direction& direction,
                           const std::optional<Point>& to) const {
    const Point origin = leaving(from);
    const auto hit = rays_->firstHit(origin, direction);
    if (!hit || !to) return !hit;
    const double gap = std::hypot((*to)[0] - origin[0], (*to)[1] - origin[1], (*to)[2] - origin[2]);
    return hit->distance > gap * (1 - 1e-4);
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
    return sample;
}

double SurfaceScene::emitterPdf(const SurfaceHit& hit) const {
    return emitters_.empty() ? 0 : meanOf(hit.emission) / power_.back();
}

}  // namespace hshfit::inline transport
