#include <hshfit/materials/glb.h>

#include <hshfit/error.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/version.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string_view>

namespace hshfit::inline materials {
namespace {

using Json = nlohmann::ordered_json;

/// Numbers of the specification (3.6.2, 3.7.2.1, 4.4).
constexpr int arrayBuffer = 34962, elementBuffer = 34963, float32 = 5126, uint16 = 5123,
              uint32 = 5125;
constexpr std::uint32_t magic = 0x46546C67, jsonChunk = 0x4E4F534A, binaryChunk = 0x004E4942;

void append(std::string& bytes, std::uint32_t value) {
    for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>((value >> shift) & 0xff);
}

/// The binary chunk, with the views and accessors that describe it.
struct Buffer {
    std::string bytes;
    Json views = Json::array(), accessors = Json::array();

    /// `Item` is an array of floats, or an index; both little-endian.
    template <class Item>
    std::size_t add(const std::vector<Item>& items, std::string_view type, int component,
                    int target) {
        const std::size_t offset = bytes.size();
        for (const Item& item : items) {
            std::array<std::uint32_t, sizeof(Item) / 4> words;
            std::memcpy(words.data(), &item, sizeof(Item));
            for (const std::uint32_t word : words) append(bytes, word);
        }
        views.push_back({{"buffer", 0},
                         {"byteOffset", offset},
                         {"byteLength", bytes.size() - offset},
                         {"target", target}});
        accessors.push_back({{"bufferView", views.size() - 1},
                             {"componentType", component},
                             {"count", items.size()},
                             {"type", type}});
        return accessors.size() - 1;
    }
};

/// Indices in two bytes where that suffices. The primitive restart value is no index.
std::size_t addIndices(const Surface& surface, Buffer& buffer) {
    if (surface.positions.size() > 0xffff)
        return buffer.add(surface.indices, "SCALAR", uint32, elementBuffer);
    std::vector<std::uint32_t> pairs((surface.indices.size() + 1) / 2);
    for (std::size_t k = 0; k < surface.indices.size(); ++k)
        pairs[k / 2] |= surface.indices[k] << (k % 2 * 16);
    const std::size_t accessor = buffer.add(pairs, "SCALAR", uint16, elementBuffer);
    buffer.accessors.back()["count"] = surface.indices.size();
    buffer.views.back()["byteLength"] = 2 * surface.indices.size();
    return accessor;
}

/// The bounds of an accessor, which positions have to have.
void addBounds(const std::vector<std::array<float, 3>>& positions, Json& accessor) {
    std::array<float, 3> least = positions.front(), most = least;
    for (const auto& position : positions) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            least[axis] = std::min(least[axis], position[axis]);
            most[axis] = std::max(most[axis], position[axis]);
        }
    }
    accessor["min"] = least;
    accessor["max"] = most;
}

void requireFinite(const Json& json, const std::string& place) {
    if (json.is_number_float() && !std::isfinite(json.get<double>()))
        throw NumericError(fmt::format("{} is not finite, which glTF cannot hold", place));
    if (!json.is_structured()) return;
    for (const auto& [key, value] : json.items()) requireFinite(value, place + "." + key);
}

/// The object of a material (5.19).
Json gltfJson(const GltfMaterial& material) {
    const MaterialColour& base = material.baseColour;
    Json extensions = Json::object();
    if (material.ior) extensions["KHR_materials_ior"] = {{"ior", *material.ior}};
    if (material.specular) {
        extensions["KHR_materials_specular"] = {{"specularFactor", material.specular->factor},
                                                {"specularColorFactor", material.specular->colour}};
    }
    if (material.sheen) {
        extensions["KHR_materials_sheen"] = {{"sheenColorFactor", material.sheen->colour},
                                             {"sheenRoughnessFactor", material.sheen->roughness}};
    }
    if (material.clearcoat) {
        extensions["KHR_materials_clearcoat"] = {
            {"clearcoatFactor", material.clearcoat->factor},
            {"clearcoatRoughnessFactor", material.clearcoat->roughness}};
    }
    if (material.anisotropy) {
        extensions["KHR_materials_anisotropy"] = {
            {"anisotropyStrength", material.anisotropy->strength},
            {"anisotropyRotation", material.anisotropy->rotation}};
    }
    if (material.iridescence) {
        // Without a texture the maximum is the thickness.
        extensions["KHR_materials_iridescence"] = {
            {"iridescenceFactor", material.iridescence->factor},
            {"iridescenceIor", material.iridescence->ior},
            {"iridescenceThicknessMaximum", material.iridescence->thickness}};
    }
    Json json = {{"name", material.name},
                 {"pbrMetallicRoughness",
                  {{"baseColorFactor", Json::array({base[0], base[1], base[2], 1.0})},
                   {"metallicFactor", material.metallic},
                   {"roughnessFactor", material.roughness}}}};
    if (!extensions.empty()) json["extensions"] = std::move(extensions);
    requireFinite(json, material.name);
    return json;
}

/// The file of a document and its buffer.
std::string containerOf(const Json& document, const Buffer& buffer) {
    std::string text = jsonText(document);
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const std::size_t length = 12 + 8 + text.size() + 8 + buffer.bytes.size();
    if (length > std::numeric_limits<std::uint32_t>::max())
        throw UsageError("a mesh of more than 4 GiB, which a .glb file cannot hold");
    std::string bytes;
    for (const std::uint32_t word : {magic, 2u, static_cast<std::uint32_t>(length),
                                     static_cast<std::uint32_t>(text.size()), jsonChunk})
        append(bytes, word);
    bytes += text;
    append(bytes, static_cast<std::uint32_t>(buffer.bytes.size()));
    append(bytes, binaryChunk);
    return bytes + buffer.bytes;
}

}  // namespace

std::string glbBytes(const GltfMaterial& material, const Surface& surface,
                     const std::string& extras) {
    if (surface.indices.empty()) throw UsageError("a surface without triangles");
    Json json = gltfJson(material);
    if (!extras.empty()) json["extras"] = Json::parse(extras);
    Buffer buffer;
    const std::size_t position = buffer.add(surface.positions, "VEC3", float32, arrayBuffer);
    addBounds(surface.positions, buffer.accessors.back());
    Json attributes = {{"POSITION", position},
                       {"NORMAL", buffer.add(surface.normals, "VEC3", float32, arrayBuffer)}};
    // Tangents matter to anisotropic materials alone.
    if (material.anisotropy)
        attributes["TANGENT"] = buffer.add(surface.tangents, "VEC4", float32, arrayBuffer);
    const std::size_t indices = addIndices(surface, buffer);
    const Json asset = {{"version", "2.0"}, {"generator", fmt::format("hshfit {}", version)}};
    const Json primitive = {{"attributes", attributes}, {"indices", indices}, {"material", 0}};
    Json document = {{"asset", asset},
                     {"scene", 0},
                     {"scenes", Json::array({{{"nodes", Json::array({0})}}})},
                     {"nodes", Json::array({{{"name", material.name}, {"mesh", 0}}})},
                     {"meshes", Json::array({{{"primitives", Json::array({primitive})}}})},
                     {"materials", Json::array({json})},
                     {"buffers", Json::array({{{"byteLength", buffer.bytes.size()}}})},
                     {"bufferViews", buffer.views},
                     {"accessors", buffer.accessors}};
    if (json.contains("extensions")) {
        for (const auto& [name, value] : json["extensions"].items())
            document["extensionsUsed"].push_back(name);
    }
    return containerOf(document, buffer);
}

std::string glbBytes(const std::string& name, std::span<const GlbAttribute> attributes,
                     std::span<const GlbPart> parts, const std::string& extras) {
    constexpr std::array<std::string_view, 4> types{"SCALAR", "VEC2", "VEC3", "VEC4"};
    Buffer buffer;
    Json places = Json::object(), primitives = Json::array(), materials = Json::array();
    for (const GlbAttribute& attribute : attributes) {
        const std::vector<float> values(attribute.values.begin(), attribute.values.end());
        places[attribute.name] =
            buffer.add(values, types.at(attribute.components - 1), float32, arrayBuffer);
        Json& accessor = buffer.accessors.back();
        accessor["count"] = values.size() / attribute.components;
        if (attribute.name != "POSITION") continue;
        std::vector<std::array<float, 3>> positions(values.size() / 3);
        for (std::size_t k = 0; k < values.size(); ++k) positions[k / 3][k % 3] = values[k];
        addBounds(positions, accessor);
    }
    for (const GlbPart& part : parts) {
        const MaterialColour& c = part.baseColour;
        primitives.push_back(
            {{"attributes", places},
             {"indices", buffer.add(part.indices, "SCALAR", uint32, elementBuffer)},
             {"material", materials.size()}});
        materials.push_back({{"name", part.name},
                             {"pbrMetallicRoughness",
                              {{"baseColorFactor", Json::array({c[0], c[1], c[2], 1.0})},
                               {"metallicFactor", 0},
                               {"roughnessFactor", 1}}}});
    }
    if (primitives.empty()) throw UsageError("a mesh without triangles");
    requireFinite(materials, name);
    // A quarter turn about -x, (x, y, z, w).
    const double half = std::sqrt(0.5);
    const Json upright = Json::array({-half, 0.0, 0.0, half});
    const Json asset = {{"version", "2.0"}, {"generator", fmt::format("hshfit {}", version)}};
    Json document = {
        {"asset", asset},
        {"scene", 0},
        {"scenes", Json::array({{{"nodes", Json::array({0})}}})},
        {"nodes", Json::array({{{"name", name}, {"mesh", 0}, {"rotation", upright}}})},
        {"meshes", Json::array({{{"primitives", primitives}, {"extras", Json::parse(extras)}}})},
        {"materials", materials},
        {"buffers", Json::array({{{"byteLength", buffer.bytes.size()}}})},
        {"bufferViews", buffer.views},
        {"accessors", buffer.accessors}};
    return containerOf(document, buffer);
}

}  // namespace hshfit::inline materials
