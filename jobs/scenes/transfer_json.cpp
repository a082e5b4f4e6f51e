#include "transfer.h"

#include <hshfit/files/json_fields.h>
#include <hshfit/version.h>

#include <nlohmann/json.hpp>

namespace hshfit::jobs {
namespace {

using Json = nlohmann::ordered_json;

Json clusterJson(const ClusterError& error) {
    return {{"clusters", error.clusters}, {"components", error.components},
            {"bytes", error.bytes},       {"relative_l2", error.relativeL2},
            {"largest", error.largest},   {"vertex", error.vertex}};
}

Json pictureJson(const TransferPicture& picture) {
    Json orders = Json::array();
    for (const TransferPictureError& error : picture.errors) {
        orders.push_back(
            {{"order", error.order},
             {"relative_l2", error.relativeL2},
             {"maximum",
              {{"relative", error.maximum}, {"column", error.column}, {"row", error.row}}}});
    }
    return {{"camera", picture.camera},
            {"light", picture.light},
            {"captured", finiteOrNull(picture.captured)},
            {"reference_noise", picture.noise},
            {"errors", orders},
            {"files", picture.files}};
}

}  // namespace

Json transferJson(const Transferred& done, bool times) {
    const TransferOptions& options = done.options;
    Json materials = Json::array(), objects = Json::array(), pictures = Json::array();
    for (const TransferMaterial& material : done.materials) {
        materials.push_back({{"name", material.name},
                             {"brdf", material.source},
                             {"diffuse", material.diffuse},
                             {"albedo", material.albedo}});
    }
    for (std::size_t k = 0; k < done.objects.size(); ++k) {
        objects.push_back({{"name", done.objects[k]},
                           {"material", done.materials[done.objectMaterials[k]].name}});
    }
    for (const TransferPicture& picture : done.pictures) pictures.push_back(pictureJson(picture));
    Json rays = {{"per_vertex", options.rays},
                 {"traced", done.rays},
                 {"inside", done.inside},
                 {"seed", options.seed}};
    if (times) {
        rays["per_second"] = raysPerSecond(done);
        rays["embree_share"] =
            done.resumed > 0 || done.rays == 0 ? Json(nullptr) : Json(done.embreeShare);
        rays["resumed_vertices"] = done.resumed;
    }
    Json json = {
        {"format", "hshfit-transfer"},
        {"version", 1},
        {"generator", std::string("hshfit ") + version},
        {"scene", done.scene},
        {"kind", kindName(options.kind)},
        {"basis", "sh"},
        {"order", options.order},
        {"local_basis", options.localOrder > 0 ? Json("hsh") : Json(nullptr)},
        {"local_order", options.localOrder},
        {"channels", done.channels},
        {"vertices", done.vertices},
        {"triangles", done.triangles},
        {"degenerate", done.degenerate},
        {"two_sided", done.twoSided},
        {"edge", done.edge},
        {"buried", done.buried},
        {"rays", rays},
        {"noise",
         {{"relative", done.noise}, {"largest", done.largestNoise}, {"vertex", done.noisiest}}},
        {"energy", done.energy},
        {"bytes",
         {{"vectors", done.vectorBytes}, {"matrices", done.matrixBytes}, {"memory", done.memory}}},
        {"materials", materials},
        {"objects", objects},
        {"pictures", pictures},
        {"files", done.files}};
    if (done.compressed) {
        Json table = Json::array();
        for (const ClusterError& error : done.compression) table.push_back(clusterJson(error));
        json["compressed"] = clusterJson(*done.compressed);
        json["compression"] = table;
    }
    if (done.poor) json["poor"] = poorJson(*done.poor);
    if (times) json["seconds"] = {{"rays", done.seconds}, {"passes", done.passSeconds}};
    return json;
}

}  // namespace hshfit::jobs
