#include "library_svbrdf.h"

#include <jobs/common/clock.h>
#include "map_files.h"
#include "map_processes.h"
#include "map_texture.h"
#include "map_work.h"
#include "pair_texels.h"

#include <hshfit/each_in_parallel.h>
#include <hshfit/error.h>
#include <hshfit/files/file_set.h>
#include <hshfit/library_maps/library_encoder.h>
#include <hshfit/library_maps/library_map.h>
#include <hshfit/material_library/library_file.h>
#include <hshfit/material_library/pair_fit.h>
#include <hshfit/pictures/poor.h>
#include <hshfit/version.h>

#include <brdfs/catalog.h>

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <filesystem>

namespace hshfit::jobs {
namespace {

namespace fs = std::filesystem;
namespace ml = material_library;

/// Texels of level 0 that a library is learned from, and texels that they are chosen among.
constexpr std::size_t mostLearned = 24, mostCandidates = 1024;
/// Texels of level 0 whose BRDFs the texels of other levels are the mean of, while learning.
constexpr std::size_t partsWhileLearning = 16;
constexpr std::size_t mostPictures = 4, mostUpperPairs = 4;
constexpr ml::Limits noLimits{ml::greatestLimit, ml::greatestLimit, ml::greatestLimit};

/// Texels of level 0 that are far from each other.
std::vector<TexelPlace> farApart(PairTexels& texels, const std::vector<LevelSize>& levels) {
    const std::vector<TexelPlace> places = spreadPlaces(levels, 0, mostCandidates);
    const std::size_t floats = texels.layout().floats();
    std::vector<float> values(places.size() * floats);
    std::unique_ptr<TexelBand> band;
    for (std::size_t t = 0; t < places.size(); ++t) {
        if (t == 0 || places[t].row != places[t - 1].row)
            band = texels.band(places[t].row, places[t].row + 1);
        band->texels(places[t].row, places[t].column, 1, values.data() + t * floats);
    }
    std::vector<TexelPlace> chosen;
    for (const std::size_t t : ml::farthest(values, places.size(), mostLearned))
        chosen.push_back(places[t]);
    return chosen;
}

/// A library of texels of the map.
ml::Library learned(ParameterMaps& maps, PairTexels& texels, const std::vector<LevelSize>& levels,
                    const SvbrdfOptions& options, const Listener& listener) {
    std::vector<TexelPlace> places = farApart(texels, levels);
    for (std::size_t level = 1; level < levels.size(); ++level)
        places.push_back(spreadPlaces(levels, level, 1).front());
    const std::vector<SpecShares> specs = brdfsOfTexels(maps, levels, places, partsWhileLearning);
    const ml::LogSpace space;
    ml::errorPairs();
    std::vector<ml::Measured> measured(places.size());
    const ProgressCall progress = listener.part("library");
    std::atomic<std::size_t> done = 0;
    eachInParallel(places.size(), [&](std::size_t k) {
        const TexelPlace& at = places[k];
        measured[k] = space.project(
            *openShares(specs[k]), fmt::format("x{}-y{}-level{}", at.column, at.row, at.level),
            specs[k].size() == 1 ? specs[k].begin()->first : "mean of texels");
        if (progress) progress(++done, places.size());
    });
    const std::size_t components = options.components > 0 ? options.components : usualComponents;
    // 16 bits for each component: texels are not packed.
    ml::Library library =
        ml::learn(space, std::move(measured), {},
                  {.components = components, .bytes = 3 + 6 * components}, noLimits);
    library.measured.clear();
    return library;
}

/// The first components of the basis of a library.
ml::Library given(const SvbrdfOptions& options) {
    ml::Library library = ml::readLibrary(options.library);
    if (library.basis.mean.empty())
        throw InputError(fmt::format("{}: has no basis", options.library));
    ml::Basis& basis = library.basis;
    if (options.components > basis.size())
        throw InputError(fmt::format("{}: has {} components, fewer than {}", options.library,
                                     basis.size(), options.components));
    const std::size_t components = options.components > 0 ? options.components : basis.size();
    basis.widths.resize(components);
    basis.components.resize(components * basis.mean.size());
    return {.asked = library.asked, .limits = library.limits, .basis = std::move(basis)};
}

void requirePossible(const MaterialDescription& described, const SvbrdfOptions& options) {
    if (!described.texels.empty())
        throw UsageError(
            "the form library is fitted to the BRDFs of a model, and measured texels have samples "
            "alone; the forms outgoing, low-rank and clusters take them");
    requireOneFrame(described);
    if (isNormalised(gpu::parseNumber(options.precision)))
        throw UsageError("coefficients of maps are stored as float16 or float32");
}

/// Errors of texels of a level against the BRDFs that they stand for.
TexelPairErrors pairErrors(ParameterMaps& maps, const LibraryMap& map, std::size_t level,
                           std::size_t most) {
    const PairChecks checks(maps, map.sidecar().levels,
                            spreadPlaces(map.sidecar().levels, level, most), processesOfMaps());
    return checks.errorsOf([&](std::size_t k) {
        const TexelPlace& at = checks.places()[k];
        return map.texel(at.level, at.column, at.row);
    });
}

/// The picture errors of a few texels of level 0.
void addPictures(ParameterMaps& maps, const LibraryMap& map, MapLibrary& facts) {
    const auto& levels = map.sidecar().levels;
    const std::vector<TexelPlace> places = spreadPlaces(levels, 0, mostPictures);
    const std::vector<SpecShares> specs = brdfsOfTexels(maps, levels, places, 1);
    std::vector<PictureError> errors(places.size());
    eachInParallel(places.size(), [&](std::size_t k) {
        errors[k] =
            pictureError(*openShares(specs[k]), *map.texel(0, places[k].column, places[k].row));
    });
    facts.pictures = places.size();
    for (std::size_t k = 0; k < places.size(); ++k) {
        const double flip = errors[k].flip.mean;
        facts.flip += flip / static_cast<double>(places.size());
        if (k > 0 && flip <= facts.worstFlip) continue;
        facts.worstFlip = flip;
        facts.worstAt = places[k];
        facts.poor = poorReason({}, errors[k]).value_or("");
    }
}

/// Level 0, then pictures, then the other levels while there is time.
void measureInLibrary(ParameterMaps& maps, const LibraryMap& map, const SvbrdfOptions& options,
                      const TimeLimit& time, Svbrdf& result) {
    if (options.checks == 0) return;
    for (std::size_t level = 0; level < result.levels.size(); ++level) {
        if ((result.timeIsOver = isOver(time, processesOfMaps()))) return;
        result.levelPairs.push_back(
            pairErrors(maps, map, level,
                       std::min(options.checks, level == 0 ? mostPairTexels : mostUpperPairs)));
        if (level > 0) continue;
        result.choices.back().pairs = result.levelPairs.front();
        if ((result.timeIsOver = isOver(time, processesOfMaps()))) return;
        addPictures(maps, map, *result.library);
    }
}

Svbrdf madeInLibrary(const std::string& description, const std::string& folder,
                     const SvbrdfOptions& options, const Listener& listener) {
    const auto start = Clock::now();
    const TimeLimit time(options.seconds);
    const std::vector<std::string> names{textureName, sidecarName, pictureName, libraryName};
    if (processesOfMaps().isFirst()) {
        FileSet files(folder, options.force);  // the folder, which goes again if it stays empty
        for (const std::string& name : names) files.requireFree(name);
    }
    const MaterialDescription described = readMaterialDescription(description);
    requirePossible(described, options);
    ParameterMaps maps(described, processesOfMaps(), listener);
    const auto first = brdfs::openModel(specificationOf(maps, maps.row(0), 0));
    const Channels channels = first->channels();
    PairTexels texels(maps, channels.count());
    Svbrdf result{.description = description,
                  .model = described.model,
                  .folder = folder,
                  .width = maps.width(),
                  .height = maps.height(),
                  .isotropic = true,
                  .form = options.form,
                  .levels = levelSizes(maps.width(), maps.height(), options.mips),
                  .processes = processesOfMaps().count()};
    ml::Library library = options.library.empty()
                              ? learned(maps, texels, result.levels, options, listener)
                              : given(options);
    LibraryEncoder encoder(library.basis, channels.count(), gpu::parseNumber(options.precision));
    result.count = library.basis.size();
    result.library = MapLibrary{.given = options.library, .materials = library.materials.size()};
    result.choices.push_back(
        {.form = "library",
         .count = result.count,
         .bytesOfTexel = 4.0 * static_cast<double>(gpu::numberBytes(encoder.number())) *
                         static_cast<double>(encoder.layers()),
         .sharedBytes = library.basis.bytes()});
    result.tableSeconds = secondsSince(start);

    MapFiles files(folder, options.force, processesOfMaps());
    files.requireFree(names);
    LibrarySidecar sidecar{
        .layout = encoder.layout(),
        .channels = channels,
        .library =
            files.file(libraryName, [&](AtomicFile& file) { ml::writeLibrary(library, file); }),
        .sum = ml::checksum(library.basis),
        .texture = files.texture(textureName),
        .number = encoder.number(),
        .levels = result.levels,
        .source = described.file,
        .generator = std::string("hshfit ") + version};
    const MapWritten written =
        writeTexture(texels, encoder, options, sidecar.texture, result, listener);
    maps.checkIntact();
    processesOfMaps().meet();
    const LibraryMap map(sidecar, (fs::path(folder) / sidecarName).string());
    sidecar.texture = textureName;
    sidecar.library = libraryName;
    files.write(sidecarName, toText(sidecar));
    files.write(pictureName, processesOfMaps().isFirst() ? errorPicture(written) : "");
    measureInLibrary(maps, map, options, time, result);
    map.checkIntact();
    for (const std::string& name : files.commit())
        result.files.push_back((fs::path(folder) / name).string());
    sayTimeIsOver(result, listener);
    return result;
}

}  // namespace

Svbrdf librarySvbrdf(const std::string& description, const std::string& folder,
                     const SvbrdfOptions& options, const Listener& listener) {
    return together([&] { return madeInLibrary(description, folder, options, listener); });
}

}  // namespace hshfit::jobs
