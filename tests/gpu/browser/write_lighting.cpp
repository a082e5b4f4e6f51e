// write_lighting FOLDER COEFFS LIGHT SIZE [MESH.obj]: what lighting.mjs draws. Exports the lighting
// of COEFFS under LIGHT to FOLDER, and writes the normals of a sphere (and of a mesh) with their
// radiance by direct integration, and by each model as the library computes it.

#include <hshfit/error.h>
#include <hshfit/light/catalog.h>
#include <hshfit/meshes/mesh_file.h>
#include <hshfit/rendering/lit_picture.h>

#include <hshfit/coefficient_files/representation_file.h>

#include <jobs/lighting/lighting.h>
#include <jobs/source/source.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

using namespace hshfit;

namespace {

void writeFloats(const std::string& path, const std::vector<float>& values) {
    std::ofstream out(path, std::ios::binary);
    out.write(reinterpret_cast<const char*>(values.data()),
              static_cast<std::streamsize>(values.size() * sizeof(float)));
    if (!out) throw OutputError(path + ": cannot be written");
}

/// One normal for each pixel, in the world, or its tangent, and the share of the pixel as the
/// fourth number.
std::vector<float> normalsOf(const SurfacePoints& points, bool tangents = false) {
    std::vector<float> values;
    for (std::size_t pixel = 0; pixel < points.coverage.size(); ++pixel) {
        const bool hit = points.first[pixel + 1] > points.first[pixel];
        Direction n = hit ? points.normals[points.first[pixel]] : Direction{0, 0, 1};
        if (tangents) n = frameAt(n).tangent;
        for (const double value : {n.x, n.y, n.z}) values.push_back(static_cast<float>(value));
        values.push_back(hit ? 1.0F : 0.0F);
    }
    return values;
}

void run(const std::vector<std::string>& words) {
    const std::string &folder = words[0], &file = words[1], &lightText = words[2];
    const int size = std::stoi(words[3]);
    jobs::LightingExportOptions options{.light = lightText,
                                        .targets = "glsl-es,wgsl",
                                        .name = "lit",
                                        .measureError = false,
                                        .force = true};
    jobs::exportLighting(file, folder, options);

    const bool coefficients = std::filesystem::path(file).extension() == ".json";
    const auto source =
        jobs::openBrdf(coefficients ? readRepresentation(file).head.source : file, true);
    const std::vector<Light> lights = parseLights(lightText).lights;
    const DirectIntegral direct(lights);
    const auto models = jobs::selectLightingModels("all");
    const auto tables =
        jobs::fitLightingTables(*jobs::openSource(file, true), models, options.errors.tables);
    const auto light = jobs::lightFor(tables, lights, options.errors.tables);
    const View view(radians(75), 0);
    nlohmann::ordered_json scenes = nlohmann::ordered_json::array();
    const auto add = [&](const std::string& name, const SurfacePoints& points) {
        writeFloats(folder + "/" + name + ".normals.bin", normalsOf(points));
        writeFloats(folder + "/" + name + ".tangents.bin", normalsOf(points, true));
        const LitPicture truth = renderByIntegration(*source, points, view, direct);
        writeFloats(folder + "/" + name + ".integration.bin", truth.picture.radiance);
        nlohmann::ordered_json scene = {{"name", name}, {"size", size}, {"error", truth.error}};
        for (const jobs::LightingModel* model : models) {
            const auto shaded =
                lighting::render(jobs::shadingOf(model->kind, tables, light), points, view);
            writeFloats(fmt::format("{}/{}.{}.bin", folder, name, model->name),
                        shaded.picture.radiance);
            const PictureDifference d = differenceOf(truth.picture, shaded.picture);
            scene["models"][std::string(model->name)] = {{"relative_l2", d.relativeL2},
                                                         {"maximum", d.maximum},
                                                         {"nanoseconds", shaded.nanoseconds}};
        }
        scenes.push_back(scene);
    };
    add("sphere", spherePoints(view, size, 1));
    if (words.size() > 4) {
        MeshFile mesh = readMesh(words[4]);
        turnUpright(mesh.mesh);
        add("mesh", meshPoints(mesh.mesh, view, size, 1));
    }
    nlohmann::ordered_json document = {{"sidecar", "lit.lighting.json"},
                                       {"viewer", {view.towards.x, view.towards.y, view.towards.z}},
                                       {"scenes", scenes}};
    std::ofstream(folder + "/scenes.json") << document.dump(1) << '\n';
}

}  // namespace

int main(int count, char** words) {
    try {
        const std::vector<std::string> all(words + 1, words + count);
        if (all.size() < 4) throw UsageError("write_lighting FOLDER SPEC LIGHT SIZE [MESH]");
        run(all);
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
