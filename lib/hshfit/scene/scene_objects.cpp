#include <hshfit/scene/internal/scene_fields.h>

#include <fmt/format.h>

#include <algorithm>

namespace hshfit::scene {
namespace {

/// The largest coordinate and size: single precision still tells parts of it apart.
constexpr double farthest = 1e6;

Point place(const JsonFields& fields, const char* key) {
    const std::vector<double> numbers = fields.numbers(key, 3);
    for (const double number : numbers) {
        if (!(std::abs(number) <= farthest))
            fields.fail(fmt::format("holds {:g}; the limit is {:g}", number, farthest), key);
    }
    return {numbers[0], numbers[1], numbers[2]};
}

/// One number, or three along the mesh's axes.
Point scaleOf(const JsonFields& fields) {
    Point scale{};
    if (fields.at("scale").is_number())
        scale.fill(fields.number("scale"));
    else
        scale = place(fields, "scale");
    for (const double factor : scale) {
        if (!(factor >= 1e-6 && factor <= farthest))
            fields.fail(fmt::format("holds {:g}; it has to be from 1e-6 to {:g}", factor, farthest),
                        "scale");
    }
    return scale;
}

}  // namespace

Object objectOf(const JsonFields& fields, const std::vector<Material>& materials,
                const std::string& scene) {
    onlyKeys(fields,
             {"name", "mesh", "material", "emission", "up", "scale", "theta", "phi", "turn", "at"});
    Object object{.name = fields.has("name") ? nameOf(fields) : std::string(),
                  .mesh = fields.word("mesh")};
    if (object.mesh != "sphere" && object.mesh != "square")
        object.mesh = placeOf(object.mesh, scene);
    const std::string wanted = fields.word("material");
    const auto found = std::ranges::find(materials, wanted, &Material::name);
    if (found == materials.end()) {
        Keys names;
        for (const Material& material : materials) names.push_back(material.name);
        failWord(fields, "material", names);
    }
    object.material = static_cast<std::size_t>(found - materials.begin());
    if (fields.has("emission")) object.emission = colour(fields, "emission");
    if (fields.has("up")) {
        const std::string up = fields.word("up");
        if (up != "y" && up != "z") failWord(fields, "up", {"y", "z"});
        object.yUp = up == "y";
    }
    if (fields.has("scale")) object.scale = scaleOf(fields);
    object.orientation = {angleOr0(fields, "theta", 0, 180), angleOr0(fields, "phi", -360, 360),
                          angleOr0(fields, "turn", -360, 360)};
    if (fields.has("at")) object.at = place(fields, "at");
    return object;
}

Camera cameraOf(const JsonFields& fields) {
    onlyKeys(fields, {"name", "position", "target", "up", "field_of_view", "width", "height"});
    Camera camera{.name = nameOf(fields),
                  .position = place(fields, "position"),
                  .target = place(fields, "target")};
    if (fields.has("up")) {
        const Point up = place(fields, "up");
        camera.up = {up[0], up[1], up[2]};
    }
    if (fields.has("field_of_view")) camera.fieldOfView = angle(fields, "field_of_view", 0.01, 179);
    if (fields.has("width")) camera.width = fields.integer("width", 1, 16384);
    camera.height = fields.has("height") ? fields.integer("height", 1, 16384) : camera.width;
    return camera;
}

}  // namespace hshfit::scene
