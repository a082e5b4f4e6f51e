#include "illuminate_options.h"

#include <jobs/common/enum_words.h>
#include <jobs/common/option_words.h>

#include <hshfit/error.h>
#include <hshfit/wording.h>

#include <fmt/format.h>

#include <algorithm>

namespace hshfit::jobs {
namespace {

using options::at;
using options::spelled;

constexpr EnumWord illuminateMethods[] = {
    {"path", "path tracing"},
    {"radiance-cache", "records of incident light on surfaces, by coefficients"}};
constexpr EnumWord recordGrounds[] = {
    {"cost", "the way with less predicted CPU time at equal error"}, {"loss", "always records"}};
constexpr EnumWord directLights[] = {{"sampled", "direct light as with paths"},
                                     {"gathered", "by the rays of records"}};
constexpr EnumWord gradients[] = {
    {"none"}, {"hit-points", "the paper's"}, {"strata", "sees what comes into sight"}};
using Methods = EnumWords<illuminateMethods, IlluminateMethod>;
using RecordGrounds = EnumWords<recordGrounds, RecordsBy>;
using DirectLights = EnumWords<directLights, DirectLight>;
using Gradients = EnumWords<gradients, Gradient>;

/// A term of the distances between records that may be left out.
struct Term {
    const char* name;
    bool CacheOptions::*member;
};
constexpr Term terms[] = {
    {"gradient-limit", &CacheOptions::gradientLimit},
    {"neighbour-clamping", &CacheOptions::neighbourClamping},
    {"error-control", &CacheOptions::errorControl},
};

std::vector<Word> termWords() {
    std::vector<Word> words;
    for (const Term& term : terms) words.push_back({term.name});
    return words;
}

constexpr unsigned ofCache = illuminateBit(IlluminateMethod::radianceCache);

constexpr OptionRow illuminateRows[] = {
    OptionRow{"method", spelled<Methods::parse, Methods::name, &IlluminateOptions::method>,
              "path: path tracing; radiance-cache: records of incident light on surfaces, by "
              "coefficients"}
        .takes({.words = Methods::words, .complete = true}),
    OptionRow{"camera", at<&IlluminateOptions::camera>, "Take this one alone (default: all)"},
    OptionRow{"samples", at<&IlluminateOptions::samples>,
              "Paths, or lines of sight, through each pixel (default: 64; radiance-cache: 16)"}
        .within(bounds::pathSamples),
    OptionRow{"bounces", at<&IlluminateOptions::path, &PathOptions::mostBounces>,
              "Reflections after which paths end"}
        .within(bounds::mostBounces),
    OptionRow{"from-bounce", at<&IlluminateOptions::path, &PathOptions::fewestBounces>,
              "Leave out light of fewer reflections: 1 what is seen directly, 2 direct light too"}
        .within(bounds::fewestBounces)
        .byDefault("0"),
    OptionRow{"seed", at<&IlluminateOptions::path, &PathOptions::seed>,
              "Seed of the random numbers"},
    OptionRow{"reference", at<&IlluminateOptions::reference>,
              "OpenEXR picture that relative_mse is measured against; with one camera"}
        .takes({.files = Files::read, .dash = ""}),
    OptionRow{"exposure", at<&IlluminateOptions::exposure>,
              "Stops of the PNG files (default: automatic)"},
    OptionRow{"resume", at<&IlluminateOptions::resume>,
              "Keep finished rows in OUTPUT/.hshfit-CAMERA.partial until the picture is written, "
              "and go on from those of a run that was stopped"},
    OptionRow{"seconds", at<&IlluminateOptions::seconds>,
              "Take only as many paths through each pixel as fit into that time, two at least "
              "(default: no end)"}
        .within(bounds::seconds)
        .notWith("resume")
        .onlyFor(illuminateBit(IlluminateMethod::path)),
    OptionRow{"force", at<&IlluminateOptions::force>, "Replace existing files"},
    OptionRow{"records", at<&IlluminateOptions::records>,
              "File of records: read if it stands, and written with those that are added"}
        .takes({.files = Files::added})
        .onlyFor(ofCache),
};

constexpr OptionRow cacheRows[] = {
    OptionRow{"basis",
              at<&IlluminateOptions::cache, &CacheOptions::choice, &MaterialChoiceOptions::basis>,
              "Basis of incident light"}
        .takes({.words = basisWords})
        .onlyFor(ofCache),
    OptionRow{"order",
              at<&IlluminateOptions::cache, &CacheOptions::choice, &MaterialChoiceOptions::order>,
              "Its highest order"}
        .onlyFor(ofCache),
    OptionRow{"loss",
              at<&IlluminateOptions::cache, &CacheOptions::choice, &MaterialChoiceOptions::loss>,
              "Share of the energy of f cos(theta) that a material may lose; it gets the lowest "
              "order within, and is sampled if there is none"}
        .within(bounds::cacheLoss)
        .onlyFor(ofCache),
    OptionRow{"choose-by",
              spelled<RecordGrounds::parse, RecordGrounds::name, &IlluminateOptions::chooseBy>,
              "Records or sampling for a material that has coefficients. cost: the way with less "
              "predicted CPU time at equal error; loss: always records"}
        .takes({.words = RecordGrounds::words, .complete = true})
        .onlyFor(ofCache),
    OptionRow{"rays", at<&IlluminateOptions::cache, &CacheOptions::rays>,
              "Rays of a record, at most"}
        .within(bounds::cacheRays)
        .onlyFor(ofCache),
    OptionRow{"accuracy", at<&IlluminateOptions::cache, &CacheOptions::accuracy>,
              "Reach of records: a of Eq. 23"}
        .onlyFor(ofCache),
    OptionRow{"least-reach", at<&IlluminateOptions::cache, &CacheOptions::leastReach>,
              "Least reach of a record, as a share of the picture's height there"}
        .within(Bounds<double>{0, 1})
        .onlyFor(ofCache),
    OptionRow{"direct",
              spelled<DirectLights::parse, DirectLights::name, &IlluminateOptions::cache,
                      &CacheOptions::direct>,
              "sampled: direct light as with paths; gathered: by the rays of records"}
        .takes({.words = DirectLights::words, .complete = true})
        .onlyFor(ofCache),
    OptionRow{"gradient",
              spelled<Gradients::parse, Gradients::name, &IlluminateOptions::cache,
                      &CacheOptions::gradient>,
              "none, hit-points (the paper's), strata (sees what comes into sight)"}
        .takes({.words = Gradients::words, .complete = true})
        .onlyFor(ofCache),
    OptionRow{"without", at<&IlluminateOptions::without>,
              "Leave out gradient-limit, neighbour-clamping, error-control: names with commas"}
        .takes({.words = termWords, .syntax = Syntax::list, .complete = true})
        .onlyFor(ofCache),
    OptionRow{"published", at<&IlluminateOptions::published>,
              "Gradients and spacing of the paper of 2004"}
        .onlyFor(ofCache),
    OptionRow{"surface-points", at<&IlluminateOptions::cache, &CacheOptions::surfacePoints>,
              "Points that pass on further bounces between diffuse surfaces"}
        .within(Bounds<int>{0, 1 << 24})
        .onlyFor(ofCache),
    OptionRow{"surface-rays", at<&IlluminateOptions::cache, &CacheOptions::surfaceRays>,
              "Rays of each of them"}
        .within(Bounds<int>{4, 1 << 24})
        .onlyFor(ofCache),
    OptionRow{"memory", at<&IlluminateOptions::memory>, "Megabytes of records, at most"}
        .within(Bounds<double>{0, 1e6})
        .onlyFor(ofCache),
};

}  // namespace

OptionRows<IlluminateOptions> illuminateOptions() {
    return {illuminateRows};
}

OptionRows<IlluminateOptions> cacheOptions() {
    return {cacheRows};
}

std::string_view nameOf(IlluminateMethod method) {
    return Methods::name(method);
}

IlluminateOptions settled(IlluminateOptions options) {
    constexpr int samplesOfRecords = 16;
    if (options.caches()) options.path.samples = samplesOfRecords;
    if (options.samples) options.path.samples = static_cast<int>(*options.samples);
    if (!options.caches()) return options;
    if (options.resume)
        throw UsageError(fmt::format("{} is for {}; records are kept by {}",
                                     Setting{"IlluminateOptions::resume"},
                                     Setting{"IlluminateOptions::method", "path"},
                                     Setting{"IlluminateOptions::records", "FILE"}));
    CacheOptions& cache = options.cache;
    cache.fewestBounces = options.path.fewestBounces;
    cache.mostBounces = options.path.mostBounces;
    cache.seed = options.path.seed;
    cache.mostBytes = static_cast<std::size_t>(options.memory * 1e6);
    if (options.published) cache.asPublished();
    const auto leavesOut = [&](std::string_view name) {
        return std::ranges::find(options.without, name) != options.without.end();
    };
    if (leavesOut("gradient-limit") && cache.errorControl && !leavesOut("error-control"))
        throw UsageError(
            fmt::format("{} changes nothing beside error control; leave that out too: {}",
                        Setting{"IlluminateOptions::without", "gradient-limit"},
                        Setting{"IlluminateOptions::without", "gradient-limit,error-control"}));
    for (const Term& term : terms)
        if (leavesOut(term.name)) cache.*(term.member) = false;
    return options;
}

}  // namespace hshfit::jobs
