#include <hshfit/precomputed_transfer/transfer_page.h>

#include <hshfit/brdf/vectors.h>
#include <hshfit/error.h>
#include <hshfit/files/checksum.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/files/template_text.h>
#include <hshfit/gpu/viewer_light.h>
#include <hshfit/pages/page_figures.h>
#include <hshfit/version.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <numeric>

namespace hshfit::embedded {
extern const std::string_view transfer_page, transfer_style, transfer_renderer, transfer_main,
    transfer_vert, transfer_frag;
}  // namespace hshfit::embedded

namespace hshfit::inline precomputed_transfer {
namespace {

using Json = nlohmann::ordered_json;
using kainjow::mustache::data;

constexpr std::size_t mostMaterials = 64;

template <class Number>
std::string coded(std::span<const Number> numbers) {
    return base64({reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes()});
}
template <class Number>
std::string coded(const std::vector<Number>& numbers) {
    return coded(std::span<const Number>(numbers));
}

/// [slot][R, G, B].
Json coefficientsJson(const LightCoefficients& light) {
    std::vector<double> values;
    for (std::size_t i = 0; i < light.slots(); ++i)
        for (std::size_t c = 0; c < 3; ++c)
            values.push_back(light.at(light.channels.count() == 1 ? 0 : c)[i]);
    return values;
}

Json lightJson(const PageLight& light) {
    Json json = {{"name", light.name}, {"stops", light.stops}};
    if (light.times.empty()) json["coefficients"] = coefficientsJson(light.coefficients);
    for (const PageLight& time : light.times) json["times"].push_back(lightJson(time));
    return json;
}

Json materialJson(const TransferMaterial& material) {
    Json json = {{"name", material.name}, {"albedo", material.albedo}};
    if (material.response) {
        const std::vector<double>& values = material.response->values;
        json["response"] = coded(std::vector<float>(values.begin(), values.end()));
        const OutgoingSet& outgoing = material.response->outgoing;
        json["side"] = outgoing.map == OutgoingSet::Map::parabolic ? outgoing.width : 0;
    }
    return json;
}

Json cameraJson(const Camera& camera) {
    return {{"name", camera.name},
            {"position", camera.position},
            {"target", camera.target},
            {"up", Json::array({camera.up.x, camera.up.y, camera.up.z})},
            {"fieldOfView", camera.fieldOfView},
            {"width", camera.width},
            {"height", camera.height}};
}

/// Means and components, one after the other for each cluster.
Json clustersJson(const MatrixClusters& clusters, std::size_t channels) {
    std::vector<float> bases;
    const auto add = [&](const std::vector<float>& from, std::size_t first, std::size_t number) {
        const auto begin = from.begin() + static_cast<std::ptrdiff_t>(first * clusters.dimension);
        bases.insert(bases.end(), begin,
                     begin + static_cast<std::ptrdiff_t>(number * clusters.dimension));
    };
    for (std::size_t c = 0; c < clusters.clusters; ++c) {
        add(clusters.means, c, 1);
        add(clusters.basis, c * clusters.components, clusters.components);
    }
    return {{"components", clusters.components},
            {"channels", channels},
            {"bases", coded(bases)},
            {"of", coded(clusters.of)},
            {"weights", coded(clusters.weights)}};
}

void addShape(const TransferMesh& mesh, Json& json) {
    std::vector<float> positions, normals;
    std::vector<std::uint32_t> triangles, materials;
    Direction low{1e30, 1e30, 1e30}, high = -low;
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        const TransferVertex& vertex = mesh.vertices[v];
        positions.insert(positions.end(), vertex.position.begin(), vertex.position.end());
        normals.insert(normals.end(), vertex.normal.begin(), vertex.normal.end());
        materials.push_back(static_cast<std::uint32_t>(mesh.material(v)));
        const Direction p = directionOf(vertex.position);
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    for (const auto& triangle : mesh.triangles)
        triangles.insert(triangles.end(), triangle.begin(), triangle.end());
    const Direction middle = 0.5 * (low + high), gap = high - low;
    json["positions"] = coded(positions);
    json["normals"] = coded(normals);
    json["materialOf"] = coded(materials);
    json["triangles"] = coded(triangles);
    json["fronts"] = mesh.fronts;
    json["middle"] = Json::array({middle.x, middle.y, middle.z});
    json["radius"] = std::sqrt(dot(gap, gap)) / 2;
}

void check(const TransferPageInput& input) {
    if (input.lights.empty() || input.cameras.empty() || input.materials.size() > mostMaterials) {
        throw UsageError(fmt::format(
            "a page of {} lights, {} cameras and {} materials; it takes "
            "lights, cameras, and up to {} materials",
            input.lights.size(), input.cameras.size(), input.materials.size(), mostMaterials));
    }
    const auto requireOrder = [&](const PageLight& light) {
        if (light.coefficients.order == input.order) return;
        throw UsageError(fmt::format("{}: a light of {} bands on a page of {}", light.name,
                                     light.coefficients.order, input.order));
    };
    for (const PageLight& light : input.lights) {
        if (light.times.empty()) requireOrder(light);
        for (const PageLight& time : light.times) requireOrder(time);
    }
}

}  // namespace

std::string transferPage(const TransferPageInput& input) {
    check(input);
    Json document = {{"order", input.order},
                     {"localOrder", input.clusters ? input.localOrder : 0},
                     {"elevations", responseElevations}};
    addShape(input.mesh, document);
    document["kinds"] = Json::array();
    document["references"] = Json::array();
    for (const PageKind& kind : input.kinds) {
        document["kinds"].push_back(
            {{"name", kind.name}, {"channels", kind.channels}, {"values", coded(kind.vectors)}});
    }
    for (const TransferMaterial& material : input.materials)
        document["materials"].push_back(materialJson(material));
    std::vector<std::size_t> own(input.sceneMaterials);
    std::iota(own.begin(), own.end(), std::size_t{0});
    document["sceneMaterials"] = own;
    if (input.clusters) document["clusters"] = clustersJson(*input.clusters, input.channels);
    for (const PageLight& light : input.lights) document["lights"].push_back(lightJson(light));
    for (const Camera& camera : input.cameras) document["cameras"].push_back(cameraJson(camera));
    for (const PageReference& reference : input.references) {
        document["references"].push_back(
            {{"camera", reference.camera},
             {"light", reference.light},
             {"note", reference.note},
             {"stops", reference.stops},
             {"picture", "data:image/png;base64," + base64(reference.png)}});
    }
    document["shaders"] = {{"vertex", embedded::transfer_vert},
                           {"fragment", embedded::transfer_frag}};
    data page, notes{data::type::list};
    for (const std::string& note : input.notes) notes.push_back(note);
    page.set("title", input.title);
    page.set("summary", input.summary);
    page.set("generator", std::string("hshfit ") + version);
    page.set("order", std::to_string(input.order));
    page.set("style", livePageStyle(embedded::transfer_style));
    page.set("notes", notes);
    page.set("data", scriptSafe(jsonText(document)));
    page.set("script", std::string(gpu::harmonicsScript()) +
                           std::string(embedded::transfer_renderer) +
                           std::string(embedded::transfer_main));
    return filledPage(embedded::transfer_page, page);
}

}  // namespace hshfit::inline precomputed_transfer
