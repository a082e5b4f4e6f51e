#include <hshfit/rays/ray_scene.h>

#include <hshfit/error.h>

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace hshfit::inline rays {

namespace {

/// The middle of the bounds of all triangles, rounded to single precision: differences between it
/// and places near it are then exact.
std::array<double, 3> middleOf(const Mesh& mesh) {
    std::array<double, 3> middle{};
    if (mesh.triangles.empty()) return middle;
    MeshVector least = mesh.positions[mesh.triangles[0][0]], most = least;
    for (const auto& triangle : mesh.triangles) {
        for (const std::uint32_t v : triangle) {
            for (std::size_t i = 0; i < 3; ++i) {
                least[i] = std::min(least[i], mesh.positions[v][i]);
                most[i] = std::max(most[i], mesh.positions[v][i]);
            }
        }
    }
    for (std::size_t i = 0; i < 3; ++i)
        middle[i] = static_cast<float>((double{least[i]} + double{most[i]}) / 2);
    return middle;
}

}  // namespace

struct RayScene::Device {
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;

    ~Device() {
        if (scene) rtcReleaseScene(scene);
        if (device) rtcReleaseDevice(device);
    }
    void check(const char* step) const {
        const RTCError error = rtcGetDeviceError(device);
        if (error == RTC_ERROR_NONE) return;
        throw NumericError(
            fmt::format("the mesh cannot be made ready for rays: {} failed with "
                        "Embree's error {}",
                        step, static_cast<int>(error)));
    }
};

RayScene::RayScene(const Mesh& mesh) : device_(std::make_unique<Device>()) {
    device_->device = rtcNewDevice(nullptr);
    device_->check("opening a device");
    device_->scene = rtcNewScene(device_->device);
    rtcSetSceneFlags(device_->scene, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(device_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                             sizeof(MeshVector), mesh.positions.size());
    void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                            3 * sizeof(std::uint32_t), mesh.triangles.size());
    if (vertices && indices) {
        centre_ = middleOf(mesh);
        std::ranges::transform(mesh.positions, static_cast<MeshVector*>(vertices),
                               [&](const MeshVector& p) {
                                   MeshVector moved{};
                                   for (std::size_t i = 0; i < 3; ++i)
                                       moved[i] = static_cast<float>(p[i] - centre_[i]);
                                   return moved;
                               });
        std::copy(mesh.triangles.begin(), mesh.triangles.end(),
                  static_cast<std::array<std::uint32_t, 3>*>(indices));
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(device_->scene, geometry);
    }
    rtcReleaseGeometry(geometry);
    device_->check("copying triangles");
    rtcCommitScene(device_->scene);
    device_->check("building the tree");
}

RayScene::~RayScene() = default;

std::optional<RayHit> RayScene::firstHit(const std::array<double, 3>& origin,
                                         const Direction& direction, double nearest) const {
    if (const auto hit = firstHitOnce(origin, direction, nearest)) return hit;
    // Across the direction, away from its smallest component.
    const Direction& d = direction;
    const double x = std::abs(d.x), y = std::abs(d.y), z = std::abs(d.z);
    Direction across{0, d.z, -d.y};
    if (y <= x && y <= z)
        across = {-d.z, 0, d.x};
    else if (z <= x && z <= y)
        across = {d.y, -d.x, 0};
    const Direction turned{d.x + secondTurn * across.x, d.y + secondTurn * across.y,
                           d.z + secondTurn * across.z};
    return firstHitOnce(origin, turned, nearest);
}

std::optional<RayHit> RayScene::firstHitOnce(const std::array<double, 3>& origin,
                                             const Direction& direction, double nearest) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit ray{};
    ray.ray.org_x = static_cast<float>(origin[0] - centre_[0]);
    ray.ray.org_y = static_cast<float>(origin[1] - centre_[1]);
    ray.ray.org_z = static_cast<float>(origin[2] - centre_[2]);
    ray.ray.dir_x = static_cast<float>(direction.x);
    ray.ray.dir_y = static_cast<float>(direction.y);
    ray.ray.dir_z = static_cast<float>(direction.z);
    ray.ray.tnear = static_cast<float>(nearest);
    ray.ray.tfar = std::numeric_limits<float>::infinity();
    ray.ray.mask = ~0U;
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(device_->scene, &context, &ray);
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    return RayHit{ray.ray.tfar, ray.hit.primID, ray.hit.u, ray.hit.v};
}

void RayScene::firstHits(std::span<const Ray> rays, std::span<RayHit> hits) const {
    constexpr std::size_t width = 8;
    constexpr float infinity = std::numeric_limits<float>::infinity();
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    RTCRayHit8 packet{};
    alignas(32) std::array<int, width> valid{};
    for (std::size_t first = 0; first < rays.size(); first += width) {
        const std::size_t count = std::min(width, rays.size() - first);
        for (std::size_t k = 0; k < width; ++k) {
            const Ray& ray = rays[first + std::min(k, count - 1)];
            valid[k] = k < count ? -1 : 0;
            packet.ray.org_x[k] = static_cast<float>(ray.origin[0] - centre_[0]);
            packet.ray.org_y[k] = static_cast<float>(ray.origin[1] - centre_[1]);
            packet.ray.org_z[k] = static_cast<float>(ray.origin[2] - centre_[2]);
            packet.ray.dir_x[k] = ray.direction[0];
            packet.ray.dir_y[k] = ray.direction[1];
            packet.ray.dir_z[k] = ray.direction[2];
            packet.ray.tnear[k] = packet.ray.time[k] = 0;
            packet.ray.tfar[k] = infinity;
            packet.ray.mask[k] = ~0U;
            packet.ray.flags[k] = 0;
            packet.hit.geomID[k] = packet.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
        }
        rtcIntersect8(valid.data(), device_->scene, &context, &packet);
        for (std::size_t k = 0; k < count; ++k) {
            const bool met = packet.hit.geomID[k] != RTC_INVALID_GEOMETRY_ID;
            hits[first + k] = {met ? packet.ray.tfar[k] : infinity, packet.hit.primID[k],
                               packet.hit.u[k], packet.hit.v[k]};
        }
    }
}

}  // namespace hshfit::inline rays
