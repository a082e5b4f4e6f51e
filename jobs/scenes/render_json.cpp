#include "render_json.h"

#include <nlohmann/json.hpp>

namespace hshfit::jobs {
namespace {

using Json = nlohmann::ordered_json;

Json pointLightsJson(const SphereRig& rig) {
    Json lights = Json::array();
    for (const SphereLight& light : rig.lights)
        lights.push_back({{"theta", degrees(polarAngle(light.towards))},
                          {"phi", degrees(azimuth(light.towards))},
                          {"strength", light.strength}});
    return lights;
}

Json startDocument(const std::string& output, int size, int samples) {
    return {{"format", "hshfit-render"},
            {"version", 1},
            {"output", output},
            {"size", size},
            {"samples", samples}};
}

Json pictureJson(const RenderedPicture& picture) {
    Json json = {{"brdf", picture.brdf},         {"by", kindName(picture.kind)},
                 {"row", picture.row},           {"column", picture.column},
                 {"exposure", picture.exposure}, {"not_finite", picture.notFinite}};
    if (picture.kind != RenderedPicture::Kind::integration) {
        json["basis"] = picture.basis;
        json["order"] = picture.order;
    }
    if (picture.kind == RenderedPicture::Kind::difference)
        json["amplification"] = picture.amplification;
    if (picture.kind != RenderedPicture::Kind::difference) json["error"] = picture.error;
    if (picture.kind == RenderedPicture::Kind::integration) {
        json["evaluations"] = picture.evaluations;
        json["largest_error"] = picture.largest.error;
        json["largest_error_at"] = {{"column", picture.largest.column},
                                    {"row", picture.largest.row}};
        json["cut_points"] = picture.cut;
        json["early_points"] = picture.early;
        return json;
    }
    json["missed"] = picture.missed ? Json(*picture.missed) : Json();
    json["relative_l2"] = json["maximum"] = nullptr;
    if (!picture.difference) return json;
    json["relative_l2"] = picture.difference->relativeL2;
    json["maximum"] = picture.difference->maximum;
    json["maximum_at"] = {{"column", picture.difference->column}, {"row", picture.difference->row}};
    json["mean_radiance"] = picture.difference->meanRadiance;
    return json;
}

}  // namespace

Json renderJson(const Rendered& rendered, const RenderOptions& options, const std::string& output) {
    Json document = startDocument(output, options.size, options.samples);
    document["lights"] = pointLightsJson(options.rig);
    for (const std::string& light : options.lights) document["lights"].push_back(light);
    document["dome"] = options.rig.dome;
    document["view"] = {{"theta", options.view.theta}, {"phi", options.view.phi}};
    document["field_of_view"] = options.fieldOfView;
    document["mesh"] = nullptr;
    if (!rendered.mesh.empty()) {
        document["mesh"] = {{"file", rendered.mesh},
                            {"triangles", rendered.triangles},
                            {"degenerate", rendered.degenerate}};
    }
    document["points"] = rendered.points;
    document["quantity"] = options.cosine ? "brdf_cosine" : "brdf";
    document["light_coefficients"] = "from samples about each normal";
    document["exposure"] = {{"automatic", !options.exposure}, {"stops", rendered.stops}};
    document["pictures"] = Json::array();
    for (const RenderedPicture& picture : rendered.pictures)
        document["pictures"].push_back(pictureJson(picture));
    return document;
}

Json renderJson(const SphereSheet& sheet, const SphereSheetOptions& options,
                const std::string& output) {
    Json document = startDocument(output, options.size, options.samples);
    document["lights"] = pointLightsJson(options.rig);
    document["dome"] = options.rig.dome;
    document["exposure"] = {{"automatic", !options.exposure}, {"stops", sheet.stops}};
    document["spheres"] = Json::array();
    for (const SphereSheet::Sphere& sphere : sheet.spheres)
        document["spheres"].push_back({{"brdf", sphere.brdf},
                                       {"column", sphere.column},
                                       {"colours", sphere.colours},
                                       {"not_finite", sphere.notFinite}});
    return document;
}

}  // namespace hshfit::jobs
