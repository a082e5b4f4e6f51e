#include "svbrdf.h"

#include <jobs/common/clock.h>
#include <jobs/source/quality.h>
#include "halfway_materials.h"
#include "level_checks.h"
#include "map_files.h"
#include "map_forms.h"
#include "map_processes.h"
#include "map_texture.h"
#include "map_work.h"

#include <hshfit/each_in_parallel.h>
#include <hshfit/files/file_set.h>
#include <hshfit/material_maps/material_map.h>
#include <hshfit/pictures/poor.h>
#include <hshfit/pictures/rgb_picture.h>
#include <hshfit/representation/forms/represented_brdf.h>

#include <brdfs/catalog.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <optional>

namespace hshfit::jobs {
namespace {

Processes& processes() {
    return processesOfMaps();
}

/// Texels of a row, taken again and again.
std::function<void(float*)> kernelOf(MapWork& work, std::size_t texels,
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
void measureKernel(MapWork& work, Svbrdf& result) {
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

/// The file of a shared material of the form halfway.
std::string materialName(std::size_t k) {
    return fmt::format("material_{:04}.json", k);
}

MapSidecar sidecarOf(const MapWork& work, const SvbrdfOptions& options, const TexelEncoder& encoder,
                     const std::vector<LevelSize>& levels) {
    MapSidecar sidecar = work.head(options, levels);
    sidecar.form = options.form;
    sidecar.number = encoder.number();
    const auto shapes = encoder.shapes();
    sidecar.shapes.assign(shapes.begin(), shapes.end());
    const auto centres = encoder.centres();
    sidecar.centres.assign(centres.begin(), centres.end());
    if (options.form == "halfway") {
        for (std::size_t k = 0; k < sidecar.materials(); ++k)
            sidecar.files.push_back(materialName(k));
    }
    return sidecar;
}

/// The materials of the form halfway, with their errors at texels of every level.
void addHalfway(MapWork& work, const MapForm& form, const SvbrdfOptions& options,
                const MaterialMap& map, MapFiles& files, MapSidecar& sidecar, Svbrdf& result,
                const Listener& listener) {
    const HalfwayMaterials halfway =
        halfwayMaterials(map, work.model->maps, options.halfway, processes(), listener);
    for (std::size_t k = 0; k < halfway.texts.size(); ++k) {
        if (halfway.texts[k].empty())
            sidecar.files[k].clear();
        else
            files.writePart(sidecar.files[k], halfway.texts[k]);
    }
    const auto opened = [&](const TexelPlace& place) -> std::unique_ptr<Brdf> {
        return reconstruct(halfway.forms[map.material(place.level, place.column, place.row)], {});
    };
    result.choices.push_back({.form = "halfway",
                              .count = result.count,
                              .bytesOfTexel = 4,
                              .sharedBytes = halfway.bytes(0, result.count)});
    if (!form.checks) return;
    result.choices.back().pairs = form.checks->of(opened);
    result.levelPairs.push_back(*result.choices.back().pairs);
    for (std::size_t level = 1; level < result.levels.size(); ++level) {
        constexpr std::size_t most = 4;  // each is a mean of many
        if ((result.timeIsOver = isOver(work.time, processes()))) break;
        const PairChecks checks(work.model->maps, result.levels,
                                spreadPlaces(result.levels, level, std::min(options.checks, most)),
                                processes());
        result.levelPairs.push_back(
            checks.errorsOf([&](std::size_t k) { return opened(checks.places()[k]); }));
    }
}

/// Measures what was written, and puts the files in place.
void write(MapWork& work, const MapForm& form, const SvbrdfOptions& options, Svbrdf& result,
           const Listener& listener) {
    MapFiles files(result.folder, options.force, processes());
    files.requireFree({textureName, sidecarName, pictureName});
    const std::string texture = files.texture(textureName);
    const MapWritten written =
        writeTexture(work.texels, *form.encoder, options, texture, result, listener);
    work.checkIntact();
    processes().meet();
    // Materials of the last levels are known to the first process alone.
    std::string text;
    if (processes().isFirst())
        text = toText(sidecarOf(work, options, *form.encoder, result.levels));
    processes().broadcast(text);
    MapSidecar sidecar = parseMapSidecar(text, sidecarName);
    sidecar.texture = texture;
    const MaterialMap map(sidecar, (std::filesystem::path(result.folder) / sidecarName).string());
    if (options.form == "halfway") {
        addHalfway(work, form, options, map, files, sidecar, result, listener);
        sidecar.texture = textureName;
        text = toText(sidecar);
    }
    files.write(sidecarName, text);
    files.write(pictureName, processes().isFirst() ? errorPicture(written) : "");
    result.timeIsOver = result.timeIsOver || isOver(work.time, processes());
    if (work.model && options.checks > 0 && result.levels.size() > 1 && !result.timeIsOver) {
        result.checks = checkLevels(map, work.model->maps, work.model->lobes, work.model->kernel,
                                    {options.checks, processes()}, listener);
    }
    map.checkIntact();
    for (const std::string& name : files.commit())
        result.files.push_back((std::filesystem::path(result.folder) / name).string());
}

/// The share that the basis captures, and the order or form that captures more where it is poor.
void judgeBasis(const MapWork& work, const SvbrdfOptions& options, Svbrdf& result) {
    const ModelTexels& model = *work.model;
    result.captured = model.least.share;
    result.leastCaptured = model.least.brdf;
    if (result.captured >= PoorBounds{}.captured || options.form == "halfway" ||
        !processes().isFirst())
        return;
    const auto brdf = brdfs::openModel(model.least.brdf);
    CoefficientHead head;
    head.basis = options.basis;
    head.order = options.order;
    head.quantity = options.cosine ? Quantity::brdfCosine : Quantity::brdf;
    head.outgoing = work.layout.outgoing;
    head.isotropic = work.laws.isotropic;
    const auto order = sufficientOrder(*brdf, head);
    if (order && *order > options.order)
        result.betterOrder = *order;
    else
        result.halfwayIsBetter = !options.cosine && isAboutTheMirror(*brdf);
}

Svbrdf made(const std::string& description, const std::string& folder, const SvbrdfOptions& options,
            const Listener& listener) {
    const auto start = Clock::now();
    if (processes().isFirst()) {
        FileSet files(folder, options.force);  // the folder, which goes again if it stays empty
        for (const char* name : {textureName, sidecarName, pictureName}) files.requireFree(name);
    }
    MapWork work(description, options, processes(), listener);
    Svbrdf result{.description = description,
                  .model = work.described.model,
                  .folder = folder,
                  .width = work.texels.width(),
                  .height = work.texels.height(),
                  .isotropic = work.laws.isotropic,
                  .outgoing = work.layout.outgoing.spec(),
                  .form = options.form,
                  .levels = levelSizes(work.texels.width(), work.texels.height(), options.mips),
                  .processes = processes().count()};
    if (work.measured) {
        result.fit = work.measured->fitErrors();
    } else {
        result.lobes = work.model->lobes.names();
        result.tableNodes = work.model->table.nodes();
        result.tableError = work.model->table.error();
        judgeBasis(work, options, result);
        for (const LobeAxis& axis : work.model->lobes.axes()) result.axes.push_back(axis.name);
    }
    const MapForm form = formFor(work, options, result, processes(), listener);
    result.tableSeconds = secondsSince(start);
    measureKernel(work, result);
    write(work, form, options, result, listener);
    sayTimeIsOver(result, listener);
    return result;
}

}  // namespace

Svbrdf svbrdf(const std::string& description, const std::string& folder,
              const SvbrdfOptions& options, const Listener& listener) {
    return together([&] { return made(description, folder, options, listener); });
}

}  // namespace hshfit::jobs
