#include "illuminate.h"

#include <hshfit/files/json_fields.h>

#include <nlohmann/json.hpp>

namespace hshfit::jobs {
namespace {

using Json = nlohmann::ordered_json;

const char* nameOf(LightWay way) {
    if (way == LightWay::irradiance) return "irradiance";
    return way == LightWay::coefficients ? "coefficients" : "sampled";
}

Json orNull(const std::optional<std::size_t>& count) {
    return count ? Json(*count) : Json(nullptr);
}

Json materialJson(const LitMaterial& material) {
    Json json = {{"name", material.name}, {"way", nameOf(material.way)}};
    if (material.way == LightWay::irradiance) return json;
    json["order"] = material.order;
    json["loss"] = material.loss;
    if (!material.reason.empty()) json["reason"] = material.reason;
    if (material.way == LightWay::sampled) json["walks"] = material.walks;
    if (!material.cost) return json;
    const MaterialCost& cost = *material.cost;
    json["predicted"] = {{"pixels", cost.pixels},
                         {"error", cost.error},
                         {"cache",
                          {{"records", cost.records},
                           {"record_seconds", cost.recordSeconds},
                           {"look_up_seconds", cost.lookUpSeconds},
                           {"cpu_seconds", cost.cacheSeconds}}},
                         {"sampling",
                          {{"variance", cost.variance},
                           {"walks", cost.walks},
                           {"walk_seconds", cost.walkSeconds},
                           {"cpu_seconds", cost.samplingSeconds}}}};
    return json;
}

Json cameraJson(const IlluminatedCamera& camera) {
    Json json = {{"camera", camera.name},
                 {"width", camera.width},
                 {"height", camera.height},
                 {"seconds", camera.seconds},
                 {"cpu_seconds", camera.cpuSeconds},
                 {"samples", camera.samples},
                 {"rays", camera.rays},
                 {"records", orNull(camera.records)},
                 {"new_records", orNull(camera.made)},
                 {"bytes", orNull(camera.bytes)},
                 {"uncovered", camera.uncovered},
                 {"mean", camera.mean},
                 {"standard_error", finiteOrNull(camera.standardError)},
                 {"largest_error",
                  {{"relative", finiteOrNull(camera.largestError)},
                   {"column", camera.errorColumn},
                   {"row", camera.errorRow}}},
                 {"cut", camera.cut},
                 {"resumed_rows", camera.resumedRows},
                 {"exposure", camera.stops},
                 {"files", camera.files}};
    if (camera.reference) {
        json["relative_mse"] = camera.reference->relativeMse;
        json["maximum"] = {{"relative_square", camera.reference->maximum},
                           {"column", camera.reference->column},
                           {"row", camera.reference->row}};
    }
    return json;
}

}  // namespace

Json illuminateJson(const Illuminated& done) {
    Json materials = Json::array(), cameras = Json::array();
    for (const LitMaterial& material : done.materials) materials.push_back(materialJson(material));
    for (const IlluminatedCamera& camera : done.cameras) cameras.push_back(cameraJson(camera));
    return {{"format", "hshfit-illuminate"},
            {"version", 1},
            {"scene", done.scene},
            {"method", nameOf(done.method)},
            {"triangles", done.triangles},
            {"degenerate", done.degenerate},
            {"preparation_seconds", done.preparationSeconds},
            {"cache_cpu_seconds", done.cacheCpuSeconds},
            {"materials", materials},
            {"cameras", cameras}};
}

}  // namespace hshfit::jobs
