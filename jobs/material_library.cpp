#include "material_library.h"

#include "batch.h"
#include "source.h"

#include <hshfit/each_in_parallel.h>
#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>
#include <hshfit/material_library/library_file.h>
#include <hshfit/specification/parameters.h>
#include <hshfit/wording.h>

#include <brdfs/catalog.h>

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <filesystem>

namespace hshfit::jobs {
namespace {

namespace fs = std::filesystem;
namespace ml = material_library;

/// Why a material keeps a form of its own; empty where logTerms() hold it.
std::string whyOwn(const Brdf& brdf, const ml::Measured& measured, double limit) {
    if (!brdf.laws().isotropic) return "is anisotropic";
    if (measured.error.logError <= limit) return {};
    return fmt::format("is {:.3g} from the functions of a library, limit {:.3g}",
                       measured.error.logError, limit);
}

/// A material as the learning takes it: one of the two.
struct Entry {
    std::optional<ml::Measured> measured = {};
    std::optional<ml::Material> own = {};
};

Entry entryOf(const ml::LogSpace& space, const std::string& spec, double limit) {
    const std::string name = materialName(spec);
    const auto brdf = openSource(spec);
    Entry entry;
    if (brdf->channels().kind == Channels::Kind::spectral || brdf->laws().isotropic)
        entry.measured = space.project(*brdf, name, spec);
    if (whyOwn(*brdf, entry.measured.value_or(ml::Measured{}), limit).empty()) {
        requireReadable(*brdf);
        return entry;
    }
    entry.measured.reset();
    entry.own = ml::withHalfway(*brdf, name, spec);
    requireReadable(*brdf);
    return entry;
}

std::vector<Entry> entriesOf(const ml::LogSpace& space, const std::vector<std::string>& specs,
                             double limit, const Listener& listener) {
    ml::errorPairs();
    std::vector<Entry> entries(specs.size());
    const std::vector<InputFailure> failures =
        forEachInput(specs, listener, "learn", [&](std::size_t i, const ProgressCall& progress) {
            if (progress) progress(0, 1);
            entries[i] = entryOf(space, specs[i], limit);
            if (progress) progress(1, 1);
        });
    if (failures.empty()) return entries;
    const InputFailure& first = failures.front();
    throw Error(first.code,
                failures.size() == 1
                    ? first.reason
                    : fmt::format("{} of {} materials failed, so that nothing is learned; the "
                                  "first: {}",
                                  failures.size(), specs.size(), first.reason));
}

void write(ml::Library& library, const std::string& output, bool final) {
    if (final) library.measured.clear();
    AtomicFile file(output);
    ml::writeLibrary(library, file);
    file.commit();
}

/// Takes the materials that learning again needs out of a library.
void take(ml::Library library, const std::string& path, std::vector<ml::Measured>& measured,
          std::vector<ml::Material>& own) {
    const auto learned = std::ranges::count_if(
        library.materials, [](const ml::Material& m) { return m.kind != ml::Kind::halfway; });
    if (static_cast<std::size_t>(learned) != library.measured.size())
        throw InputError(
            fmt::format("{}: is final: it does not hold the materials that a basis is "
                        "learned from; learn it without {}",
                        path, Setting{"LearnLibraryOptions::final"}));
    std::ranges::move(library.measured, std::back_inserter(measured));
    for (ml::Material& material : library.materials)
        if (material.kind == ml::Kind::halfway) own.push_back(std::move(material));
}

LearnedLibrary learnFrom(const ml::LogSpace& space, std::vector<ml::Measured> measured,
                         std::vector<ml::Material> own, const LearnLibraryOptions& options,
                         const std::string& output) {
    LearnedLibrary learned;
    learned.library = ml::learn(space, std::move(measured), std::move(own), options.learn,
                                options.limit, &learned.basis);
    write(learned.library, output, options.final);
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
    std::vector<ml::Measured> measured;
    std::vector<ml::Material> own;
    if (!options.addTo.empty()) {
        ml::Library before = ml::readLibrary(options.addTo);
        options.learn = before.asked;
        options.limit = before.limit;
        take(std::move(before), options.addTo, measured, own);
    }
    const ml::LogSpace space;
    for (Entry& entry : entriesOf(space, expandInputs(specs), options.limit, listener)) {
        if (entry.measured) measured.push_back(std::move(*entry.measured));
        if (entry.own) own.push_back(std::move(*entry.own));
    }
    return learnFrom(space, std::move(measured), std::move(own), options, output);
}

LearnedLibrary mergeLibraries(const std::vector<std::string>& paths, const std::string& output,
                              const MergeLibraryOptions& asked) {
    LearnLibraryOptions options{.final = asked.final};
    std::vector<ml::Measured> measured;
    std::vector<ml::Material> own;
    for (const std::string& path : paths) {
        ml::Library library = ml::readLibrary(path);
        if (&path == &paths.front()) {
            options.learn = asked.learn.value_or(library.asked);
            options.limit = library.limit;
        }
        if (library.limit != options.limit || (!asked.learn && library.asked != options.learn))
            throw InputError(fmt::format(
                "{}: was learned with other options than {}: components {} and {} (0: auto), "
                "bytes {} and {}, held out {} and {}, limit {} and {}",
                path, paths.front(), library.asked.components, options.learn.components,
                library.asked.bytes, options.learn.bytes, library.asked.heldOut,
                options.learn.heldOut, library.limit, options.limit));
        take(std::move(library), path, measured, own);
    }
    const ml::LogSpace space;
    return learnFrom(space, std::move(measured), std::move(own), options, output);
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
    if (options.limit) library.limit = *options.limit;
    const auto brdf = openSource(spec);
    const std::string name = materialName(spec);
    const ml::LogSpace space;
    EncodedMaterial encoded;
    ml::Measured measured;
    if (brdf->channels().kind == Channels::Kind::spectral || brdf->laws().isotropic)
        measured = space.project(*brdf, name, spec);
    encoded.fallback = whyOwn(*brdf, measured, library.limit);
    if (encoded.fallback.empty()) {
        const std::size_t most = library.basis.size();
        encoded.material =
            ml::encode(library, space, measured,
                       options.components == 0 ? most : std::min(options.components, most), &*brdf);
        if (encoded.material.kind != ml::Kind::coded)
            encoded.fallback = fmt::format(
                "is more than {:.3g} from every material that the basis "
                "holds",
                library.limit);
    }
    if (!encoded.fallback.empty()) encoded.material = ml::withHalfway(*brdf, name, spec);
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
    write(library, output, true);
    return encoded;
}

ml::Material decodeMaterial(const std::string& spec, const std::string& output) {
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
        material.bytes =
            2 * material.polynomial.exponents.size() + 4 * material.polynomial.tops.size();
    }
    ml::Library one{.asked = library.asked, .limit = library.limit};
    one.materials = {material};
    write(one, output, true);
    return material;
}

std::vector<FoundMaterial> searchLibrary(const std::string& path, const std::string& spec,
                                         std::size_t count, const Listener& listener) {
    const ml::Library library = ml::readLibrary(path);
    const auto brdf = openSource(spec);
    std::vector<FoundMaterial> found;
    const ml::LogSpace space;
    std::optional<ml::LogMaterial> target;
    if (brdf->channels().kind == Channels::Kind::spectral || brdf->laws().isotropic)
        target = space.project(*brdf, materialName(spec), spec).material();
    for (const ml::Material& material : library.materials) {
        const std::optional<ml::LogMaterial> logs = ml::logMaterial(library, material);
        // Without both, pictures alone decide.
        found.push_back({.name = material.name,
                         .distance = target && logs ? ml::distance(space, *target, *logs) : 0,
                         .picture = {}});
    }
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
