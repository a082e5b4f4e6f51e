#include <hshfit/error.h>
#include <hshfit/light/catalog.h>
#include <hshfit/scene/internal/scene_fields.h>

#include <cmath>
#include <filesystem>

namespace hshfit::scene {
namespace {

Direction towards(const JsonFields& fields) {
    return directionFromAngles(angle(fields, "theta", 0, 180), angleOr0(fields, "phi", -360, 360));
}

DiscLight discLight(const JsonFields& fields) {
    onlyKeys(fields, {"kind", "theta", "phi", "angular_diameter", "irradiance", "radiance"});
    DiscLight light{.towards = towards(fields),
                    .radius = angle(fields, "angular_diameter", 0.01, 180) / 2};
    if (fields.has("irradiance") == fields.has("radiance")) {
        fields.fail("needs 'irradiance' (across the beam) or 'radiance', one of the two");
    }
    if (fields.has("radiance")) {
        light.radiance = colour(fields, "radiance");
        return light;
    }
    light.radiance = colour(fields, "irradiance");
    for (double& value : light.radiance) value /= pi * std::pow(std::sin(light.radius), 2);
    return light;
}

PanelLight panelLight(const JsonFields& fields) {
    onlyKeys(fields, {"kind", "theta", "phi", "width", "height", "turn", "radiance"});
    return {.towards = towards(fields),
            .width = angle(fields, "width", 0.01, 170),
            .height = angle(fields, "height", 0.01, 170),
            .turn = angleOr0(fields, "turn", -360, 360),
            .radiance = colour(fields, "radiance")};
}

SkyLight skyLight(const JsonFields& fields) {
    onlyKeys(fields, {"kind", "model", "radiance", "ground"});
    SkyLight light;
    const std::string model = fields.word("model");
    if (model == "overcast") {
        light.model = SkyLight::Model::overcast;
    } else if (model != "uniform") {
        failWord(fields, "model", {"uniform", "overcast"});
    }
    light.zenith = colour(fields, "radiance");
    if (fields.has("ground")) light.ground = colour(fields, "ground");
    return light;
}

PictureLight pictureLight(const JsonFields& fields, const std::string& scene) {
    onlyKeys(fields, {"kind", "file", "scale", "turn"});
    PictureLight light =
        readPictureLight(placeOf(fields.word("file"), scene),
                         fields.has("scale") ? numberIn(fields, "scale", 0, brightest) : 1);
    light.turn = angleOr0(fields, "turn", -360, 360);
    return light;
}

}  // namespace

std::vector<Light> lightsOf(const JsonFields& fields, const std::string& scene) {
    if (fields.has("light")) {
        onlyKeys(fields, {"light"});
        const std::string folder = std::filesystem::path(scene).parent_path().string();
        try {
            return parseLights(fields.word("light"), folder).lights;
        } catch (const UsageError& error) {
            fields.fail(error.what(), "light");
        }
    }
    const std::string kind = fields.word("kind");
    if (kind == "disc") return {discLight(fields)};
    if (kind == "panel") return {panelLight(fields)};
    if (kind == "sky") return {skyLight(fields)};
    if (kind == "environment") return {pictureLight(fields, scene)};
    failWord(fields, "kind", {"disc", "panel", "sky", "environment"});
}

}  // namespace hshfit::scene
