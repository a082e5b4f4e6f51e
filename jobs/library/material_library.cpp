#include "material_library.h"

#include <jobs/common/inputs.h>
#include <jobs/source/source.h>

#include <hshfit/each_in_parallel.h>
#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>
#include <hshfit/material_library/library_file.h>
#include <hshfit/material_library/library_writer.h>
#include <hshfit/material_library/material_store.h>
#include <hshfit/specification/parameters.h>
#include <hshfit/time_limit.h>
#include <hshfit/wording.h>

#include <brdfs/catalog.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <atomic>
#include <filesystem>

namespace hshfit::jobs {
namespace {

namespace fs = std::filesystem;
namespace ml = material_library;

/// Why a material keeps a form of its own; empty where logTerms() hold it.
std::string whyOwn(const Brdf& brdf, const ml::Measured& measured, const ml::Limits& limits) {
    if (!brdf.laws().isotropic) return "is anisotropic";
    const std::string reason = ml::beyond(measured.error, limits);
    return reason.empty() ? reason : reason + " in the functions of a library";
}

bool hasTerms(const Brdf& brdf) {
    return brdf.channels().kind == Channels::Kind::spectral || brdf.laws().isotropic;
}

std::string textOf(const ml::Limits& limits) {
    return fmt::format("{}, {}, {}", limits.log, limits.maximum, limits.flip);
}

/// Throws where a basis has too little to be learned from; `leftOut` has the other materials, each
/// with its reason.
void requireTwoChannels(std::size_t channels, const std::vector<std::string>& leftOut) {
    if (channels >= 2) return;
    throw UsageError(fmt::format(
        "a basis is learned from two channels or more of isotropic materials, and these have {}{}: "
        "give more of them, or one in colours",
        channels, leftOut.empty() ? "" : fmt::format(" (left out: {})", fmt::join(leftOut, "; "))));
}

/// Does so before materials are projected, as far as their laws tell.
void requireTwoChannelsOf(const std::vector<std::string>& specs) {
    std::size_t channels = 0;
    std::vector<std::string> leftOut;
    for (const std::string& spec : specs) {
        try {
            const auto brdf = openSource(spec);
            if (hasTerms(*brdf))
                channels += brdf->channels().count();
            else
                leftOut.push_back(materialName(spec) + " is anisotropic");
        } catch (const Error&) {
            return;  // addEntries reports all that fail
        }
        if (channels >= 2) return;
    }
    requireTwoChannels(channels, leftOut);
}

/// Projects a material into the store, or gives it a form of its own.
void addEntry(const ml::LogSpace& space, const std::string& spec, const ml::Limits& limits,
              ml::MaterialStore& store) {
    const std::string name = materialName(spec);
    const auto brdf = openSource(spec);
    ml::Measured measured;
    if (hasTerms(*brdf)) measured = space.project(*brdf, name, spec, limits.pictures());
    const std::string reason = whyOwn(*brdf, measured, limits);
    if (reason.empty()) {
        requireReadable(*brdf);
        return store.add(measured);
    }
    ml::Material own = ml::withHalfway(*brdf, name, spec, limits.pictures());
    own.fallback = reason;
    requireReadable(*brdf);
    store.add(own);
}

/// Adds the materials to the store; returns those for which the time was over.
std::vector<std::string> addEntries(const ml::LogSpace& space,
                                    const std::vector<std::string>& specs, const ml::Limits& limits,
                                    const TimeLimit& time, const Listener& listener,
                                    ml::MaterialStore& store) {
    constexpr std::size_t always = 2;  // a basis is learned from two
    ml::errorPairs();
    std::vector<char> taken(specs.size(), 0);
    const std::vector<InputFailure> failures =
        forEachInput(specs, listener, "learn", [&](std::size_t i, const ProgressCall& progress) {
            if (i >= always && time.isOver()) return;
            if (progress) progress(0, 1);
            addEntry(space, specs[i], limits, store);
            taken[i] = 1;
            if (progress) progress(1, 1);
        });
    if (!failures.empty()) {
        const InputFailure& first = failures.front();
        throw Error(first.code,
                    failures.size() == 1
                        ? first.reason
                        : fmt::format("{} of {} materials failed, so that nothing is learned; the "
                                      "first: {}",
                                      failures.size(), specs.size(), first.reason));
    }
    std::vector<std::string> leftOut;
    for (std::size_t i = 0; i < specs.size(); ++i)
        if (!taken[i]) leftOut.push_back(specs[i]);
    return leftOut;
}

void write(const ml::Library& library, const std::string& output) {
    AtomicFile file(output);
    ml::writeLibrary(library, file);
    file.commit();
}

/// Adds the materials that learning again needs of a library to the store; the library without its
/// materials.
ml::Library addLibrary(const std::string& path, ml::MaterialStore& store) {
    std::size_t learned = 0, kept = 0;
    ml::Library library = ml::readLibrary(path, {[&](const ml::Material& material) {
                                                     if (material.kind == ml::Kind::halfway)
                                                         store.add(material);
                                                     else
                                                         ++learned;
                                                 },
                                                 [&](const ml::Measured& measured) {
                                                     store.add(measured);
                                                     ++kept;
                                                 }});
    if (learned != kept)
        throw InputError(
            fmt::format("{}: is final: it does not hold the materials that a basis is "
                        "learned from; learn it without {}",
                        path, Setting{"LearnLibraryOptions::final"}));
    return library;
}

LearnedLibrary learnFrom(const ml::LogSpace& space, ml::MaterialStore& store,
                         const LearnLibraryOptions& options, const std::string& output) {
    store.sort();
    std::size_t channels = 0;
    std::vector<std::string> leftOut;
    for (std::size_t k = 0; k < store.size(); ++k) channels += store.channels(k);
    if (channels < 2)
        for (std::size_t k = 0; k < store.ownForms(); ++k)
            leftOut.push_back(fmt::format("{} {}", store.ownName(k), store.own(k).fallback));
    requireTwoChannels(channels, leftOut);
    LearnedLibrary learned;
    ml::LibraryWriter writer(store.folder());
    learned.library = ml::learn(
        space, store, options.learn, options.limits,
        [&](const ml::Material& material) {
            writer.add(material);
            ++learned.materials;
            learned.bytes += material.bytes;
            if (material.kind != ml::Kind::coded) learned.fallbacks.push_back(material.name);
        },
        &learned.basis);
    AtomicFile file(output);
    ml::MeasuredList measured;
    if (!options.final) measured = {store.size(), [&](std::size_t k) { return store.measured(k); }};
    writer.write(learned.library, measured, file);
    file.commit();
    return learned;
}

}  // namespace

std::string materialName(const std::string& spec) {
    std::string name = nameOf(spec);
    // A material of a library has its own name.
    const std::string path(pathIn(spec));
    if (!path.empty() && spec.size() > path.size() + 1 && spec.find('=', path.size()) == spec.npos)
        name = spec.substr(path.size() + 1);
    for (char& c : name)
        if (std::string_view(":,+*").find(c) != std::string_view::npos) c = '_';
    ml::requireName(name);
    return name;
}

LearnedLibrary learnLibrary(const std::vector<std::string>& specs, const std::string& output,
                            const LearnLibraryOptions& asked, const Listener& listener) {
    LearnLibraryOptions options = asked;
    const TimeLimit time(options.seconds);
    ml::MaterialStore store(scratchFolder(output));
    if (!options.addTo.empty()) {
        const ml::Library before = addLibrary(options.addTo, store);
        options.learn = before.asked;
        options.limits = before.limits;
    }
    const std::vector<std::string> inputs = expandInputs(specs);
    if (options.addTo.empty()) requireTwoChannelsOf(inputs);
    const ml::LogSpace space;
    std::vector<std::string> leftOut =
        addEntries(space, inputs, options.limits, time, listener, store);
    if (!leftOut.empty())
        listener.say(
            fmt::format("the time was over after {} of {} materials; {} is the first that "
                        "is left out",
                        inputs.size() - leftOut.size(), inputs.size(), leftOut.front()));
    LearnedLibrary learned = learnFrom(space, store, options, output);
    learned.leftOut = std::move(leftOut);
    return learned;
}

LearnedLibrary mergeLibraries(const std::vector<std::string>& paths, const std::string& output,
                              const MergeLibraryOptions& asked) {
    LearnLibraryOptions options{.final = asked.final};
    ml::MaterialStore store(scratchFolder(output));
    for (const std::string& path : paths) {
        const ml::Library library = addLibrary(path, store);
        if (&path == &paths.front()) {
            options.learn = asked.learn.value_or(library.asked);
            options.limits = library.limits;
        }
        if (library.limits != options.limits || (!asked.learn && library.asked != options.learn))
            throw InputError(fmt::format(
                "{}: was learned with other options than {}: components {} and {} (0: auto), "
                "bytes {} and {}, held out {} and {}, limits {} and {}",
                path, paths.front(), library.asked.components, options.learn.components,
                library.asked.bytes, options.learn.bytes, library.asked.heldOut,
                options.learn.heldOut, textOf(library.limits), textOf(options.limits)));
    }
    const ml::LogSpace space;
    return learnFrom(space, store, options, output);
}

EncodedMaterial encodeMaterial(const std::string& path, const std::string& spec,
                               const std::string& output, const EncodeOptions& options,
                               const Listener&) {
    ml::Library library = ml::readLibrary(path);
    if (!library.basisFile.empty())
        throw InputError(fmt::format("{}: has no basis of its own; give {}, which it takes it from",
                                     path,
                                     (fs::path(path).parent_path() / library.basisFile).string()));
    if (library.basis.mean.empty()) throw InputError(fmt::format("{}: has no basis", path));
    library.limits = {options.log.value_or(library.limits.log),
                      options.maximum.value_or(library.limits.maximum),
                      options.flip.value_or(library.limits.flip)};
    const auto brdf = openSource(spec);
    const std::string name = materialName(spec);
    const ml::LogSpace space;
    EncodedMaterial encoded;
    ml::Measured measured;
    if (hasTerms(*brdf)) measured = space.project(*brdf, name, spec, library.limits.pictures());
    const std::string reason = whyOwn(*brdf, measured, library.limits);
    if (reason.empty()) {
        const std::size_t most = library.basis.size();
        encoded.material =
            ml::encode(library, space, measured,
                       options.components == 0 ? most : std::min(options.components, most), &*brdf);
    } else {
        encoded.material = ml::withHalfway(*brdf, name, spec, library.limits.pictures());
        encoded.material.fallback = reason;
    }
    encoded.picture = pictureError(*brdf, *ml::open(library, encoded.material, name));
    requireReadable(*brdf);
    library.materials = {encoded.material};
    library.measured.clear();
    if (encoded.material.kind == ml::Kind::coded) {
        const fs::path folder = fs::absolute(output).parent_path();
        library.basisFile = fs::absolute(path)
                                .lexically_normal()
                                .lexically_proximate(folder.lexically_normal())
                                .generic_string();
        library.basisSum = ml::checksum(library.basis);
    } else {
        library.basis = {};
    }
    write(library, output);
    return encoded;
}

namespace {

/// LIBRARY:NAME as a sum of terms of its own, unless it has a halfway form.
ml::Material plainMaterial(const std::string& spec) {
    const std::string path(pathIn(spec));
    if (path.empty()) throw InputError(fmt::format("{}: no such library of materials", spec));
    const ml::Library library = ml::readLibrary(path);
    brdfs::open(spec);  // refuses a name that is none
    const ml::Material* found = spec.size() > path.size()
                                    ? ml::find(library, spec.substr(path.size() + 1))
                                    : &library.materials.front();
    ml::Material material = *found;
    if (material.kind == ml::Kind::coded) {
        material.polynomial = *ml::logMaterial(library, material);
        material.kind = ml::Kind::polynomial;
        material.codes.clear();
        material.bytes = material.polynomial.bytes();
    }
    return material;
}

/// (1 - share) a + share b in three channels if one of them has these.
ml::LogMaterial mixed(const ml::LogMaterial& a, const ml::LogMaterial& b, double share) {
    ml::LogMaterial sum;
    const std::size_t channels = std::max(a.channels(), b.channels());
    const std::size_t terms = a.exponents.size() / a.channels();
    const auto between = [&](double x, double y) { return (1 - share) * x + share * y; };
    for (std::size_t c = 0; c < channels; ++c) {
        const std::size_t ca = a.channels() == 1 ? 0 : c, cb = b.channels() == 1 ? 0 : c;
        for (std::size_t t = 0; t < terms; ++t)
            sum.exponents.push_back(
                between(a.exponents[ca * terms + t], b.exponents[cb * terms + t]));
        sum.tops.push_back(between(a.tops[ca], b.tops[cb]));
    }
    return sum;
}

}  // namespace

std::vector<MixedMaterial> mixMaterials(const std::vector<std::string>& specs,
                                        const std::string& output, std::size_t count) {
    if (specs.size() < 2 || count < 2)
        throw UsageError("a path leads through two materials or more, in two steps or more");
    std::vector<ml::Material> stops;
    for (const std::string& spec : specs) {
        stops.push_back(plainMaterial(spec));
        if (stops.back().kind == ml::Kind::halfway)
            throw InputError(
                fmt::format("{}: has a halfway form of its own, which is not linear "
                            "in its numbers; mix materials that are in the basis",
                            spec));
        if (stops.size() > 1 && stops.back().name == std::prev(stops.end(), 2)->name)
            throw UsageError(fmt::format("{}: is mixed with itself", spec));
    }
    std::vector<MixedMaterial> path;
    ml::Library library;
    for (std::size_t k = 0; k < count; ++k) {
        const double at =
            static_cast<double>(k * (stops.size() - 1)) / static_cast<double>(count - 1);
        const std::size_t from = std::min(static_cast<std::size_t>(at), stops.size() - 2);
        const double share = at - static_cast<double>(from);
        const ml::Material &a = stops[from], &b = stops[from + 1];
        path.push_back({.name = fmt::format("{}-{}-{:05.1f}", a.name, b.name, 100 * share),
                        .first = a.name,
                        .second = b.name,
                        .share = share});
        ml::Material material{.name = path.back().name,
                              .source = specs[from] + " " + specs[from + 1],
                              .kind = ml::Kind::polynomial,
                              .polynomial = mixed(a.polynomial, b.polynomial, share)};
        ml::requireName(material.name);
        material.channels = material.polynomial.channels();
        material.bytes = material.polynomial.bytes();
        library.materials.push_back(std::move(material));
    }
    std::ranges::sort(library.materials, {}, &ml::Material::name);
    write(library, output);
    return path;
}

ml::Material decodeMaterial(const std::string& spec, const std::string& output) {
    ml::Material material = plainMaterial(spec);
    ml::Library one;
    one.materials = {material};
    write(one, output);
    return material;
}

std::vector<FoundMaterial> searchLibrary(const std::string& path, const std::string& spec,
                                         std::size_t count, const Listener& listener) {
    const ml::Library library = ml::readLibrary(path);
    const auto brdf = openSource(spec);
    const ml::LogSpace space;
    const ml::LogMaterial target = space.project(*brdf, materialName(spec), spec).material();
    std::vector<FoundMaterial> found(library.materials.size());
    eachInParallel(found.size(), [&](std::size_t m) {
        const ml::Material& material = library.materials[m];
        found[m].name = material.name;
        found[m].distance =
            ml::distance(space, target, ml::projectedMaterial(space, library, material));
    });
    std::ranges::stable_sort(found, {}, &FoundMaterial::distance);
    found.resize(std::min(found.size(), 3 * count + 5));
    const PictureReference reference(*brdf);
    const ProgressCall progress = listener.part("search");
    std::atomic<std::size_t> done = 0;
    eachInParallel(found.size(), [&](std::size_t k) {
        found[k].picture =
            reference.errorOf(*ml::open(library, *ml::find(library, found[k].name), found[k].name));
        if (progress) progress(++done, found.size());
    });
    std::ranges::stable_sort(found, {},
                             [](const FoundMaterial& one) { return one.picture.flip.mean; });
    found.resize(std::min(found.size(), count));
    requireReadable(*brdf);
    return found;
}

}  // namespace hshfit::jobs
