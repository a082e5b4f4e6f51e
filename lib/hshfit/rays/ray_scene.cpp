#include <hshfit/rays/ray_scene.h>

#include <hshfit/error.h>

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace hshfit::inline rays {

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
        std::copy(mesh.positions.begin(), mesh.positions.end(), static_cast<MeshVector*>(vertices));
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
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit ray{};
    ray.ray.org_x = static_cast<float>(origin[0]);
    ray.ray.org_y = static_cast<float>(origin[1]);
    ray.ray.org_z = static_cast<float>(origin[2]);
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

}  // namespace hshfit::inline rays
