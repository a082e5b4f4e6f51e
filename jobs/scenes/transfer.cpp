#include "transfer.h"

#include <jobs/common/clock.h>

#include "scene_surfaces.h"
#include "transfer_clusters.h"
#include "transfer_pictures.h"

#include <hshfit/error.h>
#include <hshfit/files/checkpoint.h>
#include <hshfit/files/file_set.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/files/tensor_file_writer.h>
#include <hshfit/materials/glb.h>
#include <hshfit/wording.h>

#include <fmt/format.h>

#include <algorithm>
#include <memory>

namespace hshfit::jobs {
namespace {

std::string inUnits(std::size_t bytes) {
    return fmt::format("{:.3g} MB", static_cast<double>(bytes) / 1e6);
}

void requireMemory(std::size_t needed, const TransferOptions& options, std::size_t vertices) {
    if (static_cast<double>(needed) <= 1e6 * options.memory) return;
    throw UsageError(fmt::format(
        "{} vertices need up to {} of memory, and {} allows {}; take longer edges ({}), fewer rays "
        "({}) or bands ({})",
        vertices, inUnits(needed), Setting{"TransferOptions::memory"},
        fmt::format("{:.3g} MB", options.memory), Setting{"TransferMeshOptions::edge"},
        Setting{"GatheringOptions::rays"}, Setting{"TransferOptions::order"}));
}

/// The first numbers of passes and of clusters in a checkpoint, beyond the numbers of vertices.
constexpr std::uint64_t firstPass = std::uint64_t{1} << 40, firstClusters = firstPass << 1;

/// Options that parts depend on.
std::string keyOf(const std::string& inputs, const TransferOptions& options,
                  const TransferMesh& mesh) {
    return fmt::format("transfer\n{}\n{} {} {} {} {} {} {} {}", inputs, kindName(options.kind),
                       options.order, options.localOrder, options.rays, options.seed, mesh.edge,
                       mesh.vertices.size(), mesh.triangles.size());
}

KeptParts partsOf(Checkpoint* kept, std::uint64_t first) {
    if (!kept) return {};
    return {[kept, first](std::uint64_t part) { return kept->block(first + part); },
            [kept, first](std::uint64_t part, std::span<const std::byte> bytes) {
                kept->add(first + part, bytes);
            }};
}

/// Emitting objects reflect, and their own light is left out.
void dropEmission(std::vector<SurfaceObject>& objects, const Listener& listener) {
    for (SurfaceObject& object : objects) {
        if (object.emission == Rgb{}) continue;
        listener.say(
            fmt::format("object '{}' emits; only light from far away is transferred, and "
                        "the object is dark",
                        object.name));
        object.emission = {};
    }
}

/// The arrays of transfer.tensor. They point into the rest.
struct Arrays {
    std::vector<float> positions, normals, areas, albedos;
    std::vector<std::uint32_t> objects, triangles, materials;

    Arrays(const TransferMesh& mesh, const std::vector<TransferMaterial>& all) {
        for (const TransferVertex& vertex : mesh.vertices) {
            positions.insert(positions.end(), vertex.position.begin(), vertex.position.end());
            normals.insert(normals.end(), vertex.normal.begin(), vertex.normal.end());
            areas.push_back(static_cast<float>(vertex.area));
            objects.push_back(vertex.object);
            materials.push_back(static_cast<std::uint32_t>(mesh.materials[vertex.object]));
        }
        for (const auto& triangle : mesh.triangles)
            triangles.insert(triangles.end(), triangle.begin(), triangle.end());
        for (const TransferMaterial& material : all)
            for (const double x : material.albedo) albedos.push_back(static_cast<float>(x));
    }
};

void writeTensors(const TransferMesh& mesh, const std::vector<TransferMaterial>& materials,
                  const GatheredTransfer& gathered, const InterreflectedTransfer& reflected,
                  TransferKind kind, FileSet& files) {
    const Arrays arrays(mesh, materials);
    const std::uint64_t count = mesh.vertices.size(), slots = gathered.slots(),
                        rows = gathered.localSlots(), channels = reflected.channels;
    TensorFileWriter writer;
    writer.add("positions", {count, 3}, arrays.positions);
    writer.add("normals", {count, 3}, arrays.normals);
    writer.add("areas", {count}, arrays.areas);
    writer.add("objects", {count}, arrays.objects);
    writer.add("materials", {count}, arrays.materials);
    writer.add("albedos", {materials.size(), 3}, arrays.albedos);
    writer.add("triangles", {mesh.triangles.size(), 3}, arrays.triangles);
    writer.add("unshadowed", {count, slots}, gathered.unshadowed);
    if (rows > 0)
        writer.add("unshadowed_matrices", {count, rows, slots}, gathered.unshadowedMatrices);
    if (kind != TransferKind::unshadowed) {
        writer.add("shadowed", {count, slots}, gathered.shadowed);
        if (rows > 0)
            writer.add("shadowed_matrices", {count, rows, slots}, gathered.shadowedMatrices);
    }
    if (kind == TransferKind::interreflected) {
        writer.add("interreflected", {count, channels, slots}, reflected.vectors);
        if (rows > 0)
            writer.add("interreflected_matrices", {count, channels, rows, slots},
                       reflected.matrices);
    }
    files.write("transfer.tensor", [&](AtomicFile& file) { writer.write(file); });
}

TransferView viewOf(const GatheredTransfer& gathered, const InterreflectedTransfer& reflected,
                    TransferKind kind) {
    TransferView view{.order = gathered.order, .localOrder = gathered.localOrder};
    switch (kind) {
        case TransferKind::unshadowed:
            view.vectors = gathered.unshadowed;
            view.matrices = gathered.unshadowedMatrices;
            break;
        case TransferKind::shadowed:
            view.vectors = gathered.shadowed;
            view.matrices = gathered.shadowedMatrices;
            break;
        case TransferKind::interreflected:
            view.channels = reflected.channels;
            view.vectors = reflected.vectors;
            view.matrices = reflected.matrices;
            break;
    }
    return view;
}

/// transfer.glb: the asked kind as attributes _TRANSFER_0 and so on, one for each slot.
std::string glbOf(const TransferMesh& mesh, const std::vector<TransferMaterial>& materials,
                  const TransferView& view, const Transferred& done) {
    const Arrays arrays(mesh, materials);
    const std::size_t count = mesh.vertices.size(), slots = view.slots();
    std::vector<std::vector<float>> columns(slots);
    for (std::size_t i = 0; i < slots; ++i)
        for (std::size_t k = 0; k < count * view.channels; ++k)
            columns[i].push_back(view.vectors[k * slots + i]);
    std::vector<GlbAttribute> attributes{{"POSITION", 3, arrays.positions},
                                         {"NORMAL", 3, arrays.normals}};
    for (std::size_t i = 0; i < slots; ++i)
        attributes.push_back({fmt::format("_TRANSFER_{}", i), view.channels, columns[i]});
    std::vector<GlbPart> parts;
    for (const TransferMaterial& material : materials)
        parts.push_back({material.name, material.albedo, {}});
    for (const auto& triangle : mesh.triangles) {
        std::vector<std::uint32_t>& indices = parts[mesh.material(triangle[0])].indices;
        indices.insert(indices.end(), triangle.begin(), triangle.end());
    }
    std::erase_if(parts, [](const GlbPart& part) { return part.indices.empty(); });
    const nlohmann::ordered_json extras = {
        {"hshfit:kind", kindName(done.options.kind)},
        {"hshfit:basis", "sh"},
        {"hshfit:order", view.order},
        {"hshfit:radiance", "albedo times the sum over slots l(l+1)+m of _TRANSFER times light"}};
    return glbBytes("transfer", attributes, parts, jsonText(extras));
}

std::vector<PageKind> pageKinds(const GatheredTransfer& gathered,
                                const InterreflectedTransfer& reflected, TransferKind kind) {
    std::vector<PageKind> kinds;
    for (const TransferKind one :
         {TransferKind::unshadowed, TransferKind::shadowed, TransferKind::interreflected}) {
        if (one > kind) break;
        const TransferView view = viewOf(gathered, reflected, one);
        kinds.push_back({kindName(one), view.channels, view.vectors});
    }
    return kinds;
}

/// The facts of the scene.
void describe(const TransferMesh& mesh, const SceneSurfaces& surfaces, Transferred& done) {
    done.vertices = mesh.vertices.size();
    done.triangles = mesh.triangles.size();
    done.degenerate = surfaces.degenerate;
    done.twoSided = mesh.twoSided;
    done.edge = mesh.edge;
    for (const SurfaceObject& object : surfaces.objects) {
        done.objects.push_back(object.name);
        done.objectMaterials.push_back(object.material);
    }
    for (const SurfaceMaterial& material : surfaces.materials)
        done.materials.push_back(
            transferMaterial(material.name, *material.brdf, done.options.localOrder));
}

/// Traces the rays, after a check of the memory that all of the work needs.
GatheredTransfer gatheredOf(const TransferMesh& mesh, const RayScene& rays, Checkpoint* kept,
                            const TimeLimit& limit, const Listener& listener, Transferred& done) {
    TransferOptions& options = done.options;
    GatheringOptions gathering{.order = options.order,
                               .rays = options.rays,
                               .localOrder = options.localOrder,
                               .shadows = options.kind != TransferKind::unshadowed,
                               .links = options.kind == TransferKind::interreflected,
                               .seed = options.seed,
                               .progress = listener.part("rays")};
    done.memory = gatheringBytes(mesh, gathering, grey(done.materials) ? 1 : 3);
    requireMemory(done.memory, options, done.vertices);
    gathering.kept = partsOf(kept, 0);
    const auto start = Clock::now();
    if (gathering.shadows) gathering.rays = raysWithin(mesh, rays, gathering, limit.share(3));
    if (gathering.rays < options.rays)
        listener.say(
            fmt::format("{} of {} rays a vertex fit into the time", gathering.rays, options.rays));
    options.rays = gathering.rays;
    GatheredTransfer gathered = gather(mesh, rays, gathering);
    done.seconds = secondsSince(start);
    done.embreeShare = gathered.seconds > 0 ? gathered.tracingSeconds / gathered.seconds : 0;
    done.rays = gathered.rays;
    done.inside = gathered.inside;
    done.resumed = gathered.found;
    done.buried = gathered.buried.size();
    done.noise = gathered.noise;
    done.largestNoise = gathered.largestNoise;
    done.noisiest = gathered.noisiest;
    return gathered;
}

InterreflectedTransfer reflectedOf(const TransferMesh& mesh, const GatheredTransfer& gathered,
                                   Checkpoint* kept, const TimeLimit& limit,
                                   const Listener& listener, Transferred& done) {
    const auto start = Clock::now();
    InterreflectedTransfer reflected = interreflect(mesh, gathered, done.materials,
                                                    {.passes = done.options.passes,
                                                     .progress = listener.part("passes"),
                                                     .limit = limit,
                                                     .kept = partsOf(kept, firstPass)});
    done.passSeconds = secondsSince(start);
    done.energy = reflected.energy;
    const int passes = static_cast<int>(reflected.energy.size()) - 1;
    if (passes < done.options.passes)
        listener.say(fmt::format("{} of {} passes fit into the time", passes, done.options.passes));
    done.options.passes = passes;
    done.channels = reflected.channels;
    return reflected;
}

}  // namespace

std::string kindName(TransferKind kind) {
    constexpr const char* names[] = {"unshadowed", "shadowed", "interreflected"};
    return names[static_cast<std::size_t>(kind)];
}

double raysPerSecond(const Transferred& done) {
    return static_cast<double>(done.rays - done.resumed * done.options.rays) / done.seconds;
}

Transferred transfer(const std::string& path, const std::string& folder,
                     const TransferOptions& given, const Listener& listener) {
    TransferOptions options = given;
    std::erase(options.clusters, 0U);
    Transferred done{.scene = path, .options = options};
    const scene::Scene read = scene::readScene(path, scene::Purpose::transport);
    const std::vector<const Camera*> cameras = camerasOf(read, options.camera);
    const std::vector<NamedLight> lights = namedLights(read, options.lights);
    if (options.referenceSamples > 0 && lights.empty()) {
        throw UsageError(fmt::format("{}: it has no 'lights' for pictures: name some with {}", path,
                                     Setting{"TransferOptions::lights"}));
    }
    FileSet files(folder, options.force);
    for (const char* name : {"transfer.tensor", "transfer.glb", "transfer.html", "transfer.json"})
        files.requireFree(name);
    SceneSurfaces surfaces = surfacesOf(read, listener);
    dropEmission(surfaces.objects, listener);
    const TransferMesh mesh = transferMesh(surfaces.objects, options.mesh);
    describe(mesh, surfaces, done);
    const std::string inputs = options.resume ? inputsKey(read, surfaces) : "";
    std::unique_ptr<Checkpoint> kept;
    if (options.resume)
        kept = std::make_unique<Checkpoint>((files.folder() / ".hshfit-transfer.partial").string(),
                                            keyOf(inputs, options, mesh));
    const RayScene rays = rayScene(mesh);
    const TimeLimit limit(options.seconds);
    const GatheredTransfer gathered = gatheredOf(mesh, rays, kept.get(), limit, listener, done);
    InterreflectedTransfer reflected;
    if (options.kind == TransferKind::interreflected)
        reflected = reflectedOf(mesh, gathered, kept.get(), limit.share(2), listener, done);
    const TransferView view = viewOf(gathered, reflected, options.kind);
    done.vectorBytes = view.vectors.size_bytes();
    done.matrixBytes = view.matrices.size_bytes();
    const auto written = [&](const std::string& name) {
        done.files.push_back((files.folder() / name).string());
    };
    writeTensors(mesh, done.materials, gathered, reflected, options.kind, files);
    written("transfer.tensor");
    files.write("transfer.glb", glbOf(mesh, done.materials, view, done));
    written("transfer.glb");
    std::optional<MatrixClusters> clusters;
    if (!view.matrices.empty() && !options.clusters.empty()) {
        clusters = compressed(view, partsOf(kept.get(), firstClusters), listener, done);
        writeClusters(*clusters, view, files);
        written("clusters.tensor");
    }
    const PictureScene scene{mesh, rays, view, done.materials, surfaces};
    ReferencePictures pictures;
    if (options.referenceSamples > 0)
        pictures = takePictures(scene, read, cameras, lights, limit, listener, files, done);
    files.write("transfer.html", pageOf(scene, pageKinds(gathered, reflected, options.kind),
                                        clusters ? &*clusters : nullptr, lights, cameras,
                                        pictures.references, done, listener));
    written("transfer.html");
    written("transfer.json");
    files.write("transfer.json", jsonText(transferJson(done, false), 2) + "\n");
    files.commit();
    if (kept) kept->remove();
    for (const auto& rows : pictures.kept) rows->remove();
    return done;
}

}  // namespace hshfit::jobs
