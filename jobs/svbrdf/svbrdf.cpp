#include "svbrdf.h"

#include "level_checks.h"
#include "measured_texels.h"
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
#include <functional>
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

Quantity quantityOf(const SvbrdfOptions& options) {
    return options.cosine ? Quantity::brdfCosine : Quantity::brdf;
}

/// Texels of a model with parameter maps.
struct ModelTexels {
    ModelTexels(const MaterialDescription& described, const Basis& basis,
                const SvbrdfOptions& options, const Listener& listener)
        : maps(inOneFrame(described), listener),
          lobes(maps, described.file),
          layout(layoutFor(options, lobes, basis)),
          table(lobes.function(layout, basis, {.quantity = quantityOf(options)}, least),
                {.tolerance = options.tolerance, .progress = listener.part("lobes")}),
          rows(maps, lobes),
          texels(rows, table, layout, lobes.axesByChannel()),
          kernel(table, layout, lobes.axesByChannel()) {}

    ParameterMaps maps;
    ModelLobes lobes;
    TexelLayout layout;
    LeastCaptured least = {};
    LobeGrid table;
    ModelRows rows;
    LobeTexels texels;
    TexelKernel kernel;
};

/// Everything that texels come from: a model, or measured ones.
struct Work {
    Work(const std::string& description, const SvbrdfOptions& options, const Listener& listener)
        : described(readMaterialDescription(description)),
          basis(bases::make(options.basis, options.order)),
          model(described.texels.empty()
                    ? std::make_unique<ModelTexels>(described, *basis, options, listener)
                    : nullptr),
          measured(model ? nullptr
                         : std::make_unique<MeasuredTexels>(
                               described.texels, *basis,
                               MeasuredTexels::Options{.outgoing = options.outgoing,
                                                       .quantity = quantityOf(options),
                                                       .isotropic = described.isotropic},
                               listener)),
          texels(model ? static_cast<TexelSource&>(model->texels) : *measured),
          layout(texels.layout()),
          laws(model ? model->lobes.laws() : measured->laws()) {}

    void checkIntact() const { model ? model->maps.checkIntact() : measured->checkIntact(); }

    MaterialDescription described;
    std::unique_ptr<Basis> basis;
    std::unique_ptr<ModelTexels> model;
    std::unique_ptr<MeasuredTexels> measured;
    TexelSource& texels;
    const TexelLayout& layout;
    Laws laws;
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

/// Texels of a row, taken again and again.
std::function<void(float*)> kernelOf(Work& work, std::size_t texels,
                                     std::unique_ptr<TexelBand>& band, TexelBlock& block) {
    const std::size_t row = work.texels.height() / 2;
    if (work.measured) {
        band = work.texels.band(row, row + 1);
        return [&work, &band, texels, row](float* out) {
            for (std::size_t t = 0; t < texels; ++t)
                band->texels(row, t % work.texels.width(), 1, out + t * work.layout.floats());
        };
    }
    const TexelBlock parameters = work.model->rows.read(row, row + 1).front();
    block.count = texels;
    const auto fill = [&](const std::vector<float>& from, std::vector<float>& to) {
        for (std::size_t at = 0; at < from.size(); at += parameters.count)
            for (std::size_t t = 0; t < texels; ++t) to.push_back(from[at + t % parameters.count]);
    };
    fill(parameters.weights, block.weights);
    fill(parameters.places, block.places);
    return [&work, &block](float* out) { work.model->kernel.run(block, 0, block.count, out); };
}

/// Texels per second of the kernel alone, on all threads, parameters in memory.
void measureKernel(Work& work, Svbrdf& result) {
    constexpr std::size_t chunk = 256;
    const std::size_t texels = std::size_t{1} << (work.measured ? 12 : 16);
    std::unique_ptr<TexelBand> band;
    TexelBlock block;
    const auto kernel = kernelOf(work, chunk, band, block);
    const auto start = Clock::now();
    eachInParallel(texels / chunk, [&](std::size_t) {
        std::vector<float> out(chunk * work.layout.floats());
        kernel(out.data());
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
                       .isotropic = work.laws.isotropic,
                       .bilateral = work.laws.mirrorSymmetric,
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
    const BandPlan plan = planBands(levelSizes(work.texels.width(), work.texels.height()),
                                    texelBytes, options.memory / 3);
    const auto start = Clock::now();
    const MapWritten written = writeMap(work.texels, encoder, texture, plan, processes(),
                                        {.progress = listener.part("texels")});
    work.checkIntact();
    processes().meet();
    result.seconds = secondsSince(start);
    result.rate = static_cast<double>(work.texels.width() * work.texels.height()) / result.seconds;
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
    if (processes().isFirst()) {
        FileSet files(folder, options.force);  // the folder, which goes again if it stays empty
        for (const char* name : {textureName, sidecarName, pictureName}) files.requireFree(name);
    }
    Work work(description, options, listener);
    Svbrdf result{.description = description,
                  .model = work.described.model,
                  .folder = folder,
                  .width = work.texels.width(),
                  .height = work.texels.height(),
                  .isotropic = work.laws.isotropic,
                  .outgoing = work.layout.outgoing.spec(),
                  .levels = levelSizes(work.texels.width(), work.texels.height(), options.mips),
                  .processes = processes().count()};
    if (work.measured) {
        result.fit = work.measured->fitErrors();
    } else {
        result.lobes = work.model->lobes.names();
        result.tableNodes = work.model->table.nodes();
        result.tableError = work.model->table.error();
        result.captured = work.model->least.share;
        result.leastCaptured = work.model->least.brdf;
        for (const LobeAxis& axis : work.model->lobes.axes()) result.axes.push_back(axis.name);
    }
    const auto encoder = encoderFor(work, options, result, listener);
    result.tableSeconds = secondsSince(start);
    result.form = encoder->form();
    measureKernel(work, result);
    write(work, *encoder, options, result, listener);
    if (work.model && options.checks > 0 && result.levels.size() > 1) {
        const MaterialMap map((std::filesystem::path(folder) / sidecarName).string());
        result.checks = checkLevels(map, work.model->maps, work.model->lobes, work.model->kernel,
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
