#include "svbrdf.h"

#include "level_checks.h"
#include "model_lobes.h"
#include "parameter_maps.h"

#include <hshfit/bases/catalog.h>
#include <hshfit/each_in_parallel.h>
#include <hshfit/error.h>
#include <hshfit/files/file_set.h>
#include <hshfit/material_maps/cluster_encoder.h>
#include <hshfit/material_maps/lobe_texels.h>
#include <hshfit/material_maps/map_sidecar.h>
#include <hshfit/material_maps/texel_encoder.h>
#include <hshfit/pictures/rgb_picture.h>
#include <hshfit/version.h>

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <optional>

namespace hshfit::jobs {
namespace {

using Clock = std::chrono::steady_clock;
constexpr const char* textureName = "material.ktx2";
constexpr const char* sidecarName = "material.json";
constexpr const char* pictureName = "errors.png";

Processes* sharing = nullptr;

Processes& processes() {
    static Processes alone;
    return sharing ? *sharing : alone;
}

double secondsSince(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

TexelLayout layoutFor(const SvbrdfOptions& options, const ModelLobes& lobes, const Basis& basis) {
    const Laws& laws = lobes.laws();
    OutgoingSet outgoing = !options.outgoing.empty() ? OutgoingSet::parse(options.outgoing)
                           : laws.isotropic          ? OutgoingSet::elevations(8)
                                                     : OutgoingSet::parabolic(8, 8);
    if (outgoing.map == OutgoingSet::Map::elevations && !laws.isotropic) {
        throw UsageError(
            "the texels are anisotropic; their outgoing directions need a map, such as 8x8");
    }
    return texelLayout(basis, outgoing, lobes.channels(), laws.mirrorSymmetric);
}

/// Throws UsageError for a description whose texels turn: coefficients of a common frame do not.
const MaterialDescription& inOneFrame(const MaterialDescription& described) {
    if (!described.normal && !described.direction) return described;
    throw UsageError(
        fmt::format("{}: turns its texels by \"{}\"; the form has to be filtered, "
                    "ellipse or harmonics",
                    described.file, described.normal ? "normal" : "direction"));
}

/// Everything that texels come from.
struct Work {
    Work(const std::string& description, const SvbrdfOptions& options, const Listener& listener)
        : described(readMaterialDescription(description)),
          maps(inOneFrame(described), listener),
          lobes(maps, description),
          basis(bases::make(options.basis, options.order)),
          layout(layoutFor(options, lobes, *basis)),
          table(lobes.function(layout, *basis,
                               {.quantity = options.cosine ? Quantity::brdfCosine : Quantity::brdf},
                               least),
                {.tolerance = options.tolerance, .progress = listener.part("lobes")}),
          rows(maps, lobes),
          texels(rows, table, layout, lobes.axesByChannel()),
          kernel(table, layout, lobes.axesByChannel()) {}

    MaterialDescription described;
    ParameterMaps maps;
    ModelLobes lobes;
    std::unique_ptr<Basis> basis;
    TexelLayout layout;
    LeastCaptured least = {};
    LobeGrid table;
    ModelRows rows;
    LobeTexels texels;
    TexelKernel kernel;
};

gpu::Number numberOf(const SvbrdfOptions& options) {
    const gpu::Number number = gpu::parseNumber(options.precision);
    if (gpu::isNormalised(number))
        throw UsageError("coefficients of maps are stored as float16 or float32");
    return number;
}

/// Of level 0.
TexelErrors errorsOfEncoder(const TexelEncoder& encoder, const std::vector<float>& linear) {
    const std::size_t n = encoder.linear(), count = linear.size() / n;
    std::vector<float> errors(count);
    eachInParallel(count, [&](std::size_t t) {
        std::vector<std::byte> bytes(encoder.layers() * 16);
        encoder.encode(0, {linear.data() + t * n, n}, {bytes.data(), 16, &errors[t]});
    });
    return errorsOf(errors);
}

std::size_t rankFor(const std::vector<TexelErrors>& errors, double error) {
    const auto good =
        std::ranges::find_if(errors, [&](const auto& e) { return e.maximum <= error; });
    return std::min<std::size_t>(static_cast<std::size_t>(good - errors.begin()) + 1,
                                 errors.size());
}

/// The encoder of clusters; lists other numbers of them.
std::unique_ptr<TexelEncoder> clustersFor(Work& work, const SvbrdfOptions& options,
                                          const LowRank& lowRank, const std::vector<float>& samples,
                                          Svbrdf& result, const Listener& listener) {
    constexpr std::size_t blocks = 512;
    const std::size_t floats = work.layout.floats();
    const LevelSamples levels =
        sampleLevels(work.texels, lowRank, samples, result.levels, blocks, processes());
    std::vector<std::size_t> counts{16, 64, 256, 1024};
    if (std::ranges::find(counts, options.clusters) == counts.end())
        counts.push_back(options.clusters);
    std::unique_ptr<TexelEncoder> chosen;
    for (const std::size_t clusters : counts) {
        if (clusters > std::max<std::size_t>(1024, options.clusters)) continue;
        const bool isAsked = clusters == options.clusters;
        const ClusterEncoder::Options asked{.clusters = clusters,
                                            .levels = isAsked ? result.levels.size() : 1,
                                            .progress = listener.part("clusters")};
        auto encoder = std::make_unique<ClusterEncoder>(
            lowRank, isAsked ? levels : LevelSamples{levels.front()}, asked, processes());
        const std::size_t count = encoder->count(0);
        result.choices.push_back({.form = "clusters",
                                  .count = count,
                                  .bytesOfTexel = 4,
                                  .sharedBytes = count * floats * sizeof(float),
                                  .errors = errorsOfEncoder(*encoder, levels.front())});
        if (!isAsked) continue;
        result.count = count;
        chosen = std::move(encoder);
    }
    return chosen;
}

/// The encoder that the options ask for; forms with shared shapes list their choices.
std::unique_ptr<TexelEncoder> encoderFor(Work& work, const SvbrdfOptions& options, Svbrdf& result,
                                         const Listener& listener) {
    const gpu::Number number = numberOf(options);
    const TexelLayout& layout = work.layout;
    const double numberBytes = static_cast<double>(gpu::numberBytes(number));
    result.choices.push_back({.form = "outgoing",
                              .count = layout.shape(),
                              .bytesOfTexel = numberBytes * static_cast<double>(layout.floats())});
    if (options.form == "outgoing") return std::make_unique<PlainEncoder>(layout, number);
    if (options.form != "low-rank" && options.form != "clusters")
        throw UsageError(
            fmt::format("unknown form '{}'; known: outgoing, low-rank, clusters", options.form));
    const std::vector<float> samples = sampleTexels(work.texels, options.samples, processes());
    const PrincipalShapes principal(layout, samples, processes());
    const std::vector<TexelErrors> errors = principal.errors(samples, processes());
    for (std::size_t rank = 1; rank <= principal.most(); rank *= 2) {
        const LowRankEncoder encoder(principal.lowRank(rank), number);
        result.choices.push_back(
            {.form = "low-rank",
             .count = rank,
             .bytesOfTexel = 4 * numberBytes * static_cast<double>(encoder.layers()),
             .sharedBytes = rank * layout.shape() * sizeof(float),
             .errors = errors[rank - 1]});
    }
    const std::size_t rank = options.rank > 0 ? std::min(options.rank, principal.most())
                                              : rankFor(errors, options.error);
    const LowRank lowRank = principal.lowRank(rank);
    if (options.form == "clusters")
        return clustersFor(work, options, lowRank, samples, result, listener);
    result.count = rank;
    return std::make_unique<LowRankEncoder>(lowRank, number);
}

/// Texels per second of the kernel alone, on all threads, parameters in memory.
void measureKernel(Work& work, Svbrdf& result) {
    constexpr std::size_t texels = std::size_t{1} << 16, chunk = 256;
    const auto row = work.rows.read(work.maps.height() / 2, work.maps.height() / 2 + 1).front();
    TexelBlock block{.count = chunk};
    const auto fill = [&](const std::vector<float>& from, std::vector<float>& to) {
        for (std::size_t at = 0; at < from.size(); at += row.count)
            for (std::size_t t = 0; t < chunk; ++t) to.push_back(from[at + t % row.count]);
    };
    fill(row.weights, block.weights);
    fill(row.places, block.places);
    const auto start = Clock::now();
    eachInParallel(texels / chunk, [&](std::size_t) {
        std::vector<float> out(chunk * work.layout.floats());
        work.kernel.run(block, 0, chunk, out.data());
    });
    result.kernelSeconds = secondsSince(start);
    result.kernelRate = static_cast<double>(texels) / result.kernelSeconds;
}

MapSidecar sidecarOf(const Work& work, const SvbrdfOptions& options, const TexelEncoder& encoder,
                     const std::vector<LevelSize>& levels) {
    MapSidecar sidecar{.form = encoder.form(),
                       .texture = textureName,
                       .basis = options.basis,
                       .order = options.order,
                       .quantity = options.cosine ? Quantity::brdfCosine : Quantity::brdf,
                       .channels = work.layout.channels == 1 ? Channels::grey() : Channels::rgb(),
                       .layout = work.layout,
                       .isotropic = work.lobes.laws().isotropic,
                       .bilateral = work.lobes.laws().mirrorSymmetric,
                       .number = encoder.number(),
                       .levels = levels,
                       .source = work.described.file,
                       .generator = std::string("hshfit ") + version};
    if (const auto* lowRank = dynamic_cast<const LowRankEncoder*>(&encoder))
        sidecar.shapes = lowRank->lowRank().shapes();
    if (const auto* clusters = dynamic_cast<const ClusterEncoder*>(&encoder)) {
        sidecar.shapes = clusters->lowRank().shapes();
        sidecar.centres = clusters->centres();
    }
    return sidecar;
}

/// Errors as grey, white at the largest; on a logarithmic scale over three decades.
std::string errorPicture(const MapWritten& written) {
    float largest = 0;
    for (const float error : written.pictureErrors) largest = std::max(largest, error);
    RgbPicture picture{static_cast<int>(written.picture.width),
                       static_cast<int>(written.picture.height)};
    for (const float error : written.pictureErrors) {
        const float shade =
            largest > 0 ? std::max(0.0F, 1 + std::log10(std::max(error / largest, 1e-3F)) / 3) : 0;
        picture.values.insert(picture.values.end(), 3, shade);
    }
    return rgbPng(picture, 0);
}

/// Writes the files; the first process has them under temporary names until all are complete.
void write(Work& work, TexelEncoder& encoder, const SvbrdfOptions& options, Svbrdf& result,
           const Listener& listener) {
    std::optional<FileSet> files;
    std::string texturePath;
    if (processes().isFirst()) {
        files.emplace(result.folder, options.force);
        for (const char* name : {textureName, sidecarName, pictureName}) files->requireFree(name);
        texturePath = std::filesystem::absolute(files->add(textureName).temporaryPath()).string();
    }
    processes().broadcast(texturePath);
    LevelFile texture(
        texturePath, encoder.number(), encoder.layers(), result.levels,
        {.pairs = {{"hshfit:form", encoder.form()}}, .pastPageCache = options.pastPageCache});
    const std::size_t texelBytes = texture.bytesOfTexel() + encoder.linear() + sizeof(float);
    const BandPlan plan = planBands(levelSizes(work.maps.width(), work.maps.height()), texelBytes,
                                    options.memory / 3);
    const auto start = Clock::now();
    const MapWritten written = writeMap(work.texels, encoder, texture, plan, processes(),
                                        {.progress = listener.part("texels")});
    work.maps.checkIntact();
    processes().meet();
    result.seconds = secondsSince(start);
    result.rate = static_cast<double>(work.maps.width() * work.maps.height()) / result.seconds;
    result.errors = written.levels;
    result.errors.resize(result.levels.size());  // the others have none
    result.bytes = texture.bytes();
    result.pastPageCache = texture.isPastPageCache();
    if (files) {
        files->write(sidecarName, toText(sidecarOf(work, options, encoder, result.levels)));
        files->write(pictureName, errorPicture(written));
        files->commit();
    }
    processes().meet();
    for (const char* name : {textureName, sidecarName, pictureName})
        result.files.push_back((std::filesystem::path(result.folder) / name).string());
}

Svbrdf made(const std::string& description, const std::string& folder, const SvbrdfOptions& options,
            const Listener& listener) {
    const auto start = Clock::now();
    Work work(description, options, listener);
    Svbrdf result{.description = description,
                  .model = work.described.model,
                  .folder = folder,
                  .width = work.maps.width(),
                  .height = work.maps.height(),
                  .lobes = work.lobes.names(),
                  .isotropic = work.lobes.laws().isotropic,
                  .outgoing = work.layout.outgoing.spec(),
                  .tableNodes = work.table.nodes(),
                  .tableError = work.table.error(),
                  .captured = work.least.share,
                  .leastCaptured = work.least.brdf,
                  .levels = levelSizes(work.maps.width(), work.maps.height(), options.mips),
                  .processes = processes().count()};
    for (const LobeAxis& axis : work.lobes.axes()) result.axes.push_back(axis.name);
    const auto encoder = encoderFor(work, options, result, listener);
    result.tableSeconds = secondsSince(start);
    result.form = encoder->form();
    measureKernel(work, result);
    write(work, *encoder, options, result, listener);
    if (options.checks > 0 && result.levels.size() > 1) {
        const MaterialMap map((std::filesystem::path(folder) / sidecarName).string());
        result.checks = checkLevels(map, work.maps, work.lobes, work.kernel,
                                    {options.checks, processes()}, listener);
    }
    return result;
}

}  // namespace

void shareMapsWith(Processes& processes) {
    sharing = &processes;
}

const Processes& processesOfMaps() {
    return processes();
}

Svbrdf svbrdf(const std::string& description, const std::string& folder,
              const SvbrdfOptions& options, const Listener& listener) {
    try {
        Svbrdf result = made(description, folder, options, listener);
        processes().meet();
        return result;
    } catch (...) {
        processes().fail();
        throw;
    }
}

}  // namespace hshfit::jobs
