#include "source.h"

#include <hshfit/accuracy/metrics.h>
#include <hshfit/brdf/colour.h>
#include <hshfit/brdf/transmission.h>
#include <hshfit/coefficient_files/coefficient_file.h>
#include <hshfit/coefficient_files/light_file.h>
#include <hshfit/coefficient_files/representation_file.h>
#include <hshfit/coefficients/reconstruction.h>
#include <hshfit/error.h>
#include <hshfit/filtered_maps/filtered_sidecar.h>
#include <hshfit/gpu/containers/containers.h>
#include <hshfit/gpu/forms/form_files.h>
#include <hshfit/library_maps/library_map.h>
#include <hshfit/material_maps/material_map.h>
#include <hshfit/representation/forms/represented_brdf.h>
#include <hshfit/specification/parameters.h>
#include <hshfit/wings.h>

#include "filtered_texel_brdf.h"
#include "map_facts.h"

#include <brdfs/catalog.h>
#include <brdfs/measured/measured_brdf.h>
#include <brdfs/measured/mueller.h>

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <initializer_list>
#include <system_error>
#include <utility>

namespace hshfit::jobs {
namespace {

std::unique_ptr<Brdf> seenAsRgb(std::unique_ptr<Brdf> brdf, bool rgb) {
    if (!rgb || brdf->channels().kind != Channels::Kind::spectral) return brdf;
    return asRgb(std::move(brdf));
}

/// Parameters that name a texel behind the path of a map.
struct TexelWords {
    std::size_t x = 0, y = 0, level = 0;
    bool given = false;  ///< x or y
};

TexelWords texelIn(const std::string& path, const std::string& rest) {
    constexpr double most = 1 << 20;
    const Parameter parameters[] = {
        {.name = "x", .help = "column", .fallback = 0, .max = most},
        {.name = "y", .help = "row, from the top", .fallback = 0, .max = most},
        {.name = "level", .help = "0 is the full size", .fallback = 0, .max = 30}};
    const Parameters texel =
        parseParameters(path, parameters, rest.empty() ? rest : rest.substr(1));
    const auto index = [&](std::string_view name) {
        const double value = texel.number(name);
        if (value != std::floor(value))
            throw UsageError(
                fmt::format("{}: {} is {}; it has to be a whole number", path, name, value));
        return static_cast<std::size_t>(value);
    };
    return {index("x"), index("y"), index("level"),
            rest.find("x=") != std::string::npos || rest.find("y=") != std::string::npos};
}

std::unique_ptr<Brdf> openTexelOf(const std::string& path, bool filtered, const std::string& rest) {
    const auto [x, y, level, given] = texelIn(path, rest);
    if (filtered) return openFilteredTexel(path, level, x, y);
    if (isLibrarySidecar(path)) {
        const LibraryMap map(path);
        auto texelBrdf = map.texel(level, x, y);
        map.checkIntact();
        return texelBrdf;
    }
    const MaterialMap map(path);
    if (map.sidecar().form == "halfway") {
        const std::size_t material = map.material(level, x, y);
        map.checkIntact();
        const std::string& file = map.sidecar().files[material];
        if (file.empty())
            throw InputError(fmt::format("{}: material {} has no file", path, material));
        return reconstruct(readRepresentation(file), {});
    }
    Coefficients coefficients = map.coefficients(level, x, y);
    map.checkIntact();
    return std::make_unique<Reconstruction>(std::move(coefficients));
}

/// Whether a file is the sidecar of a map or of an export of one.
bool isMap(const std::string& path) {
    return !path.empty() &&
           (isFilteredSidecar(path) || isMapSidecar(path) || isLibrarySidecar(path));
}

/// A texel of a material map, "FILE:x=3,y=5,level=0"; null where SPEC is none.
std::unique_ptr<Brdf> openTexel(const std::string& spec) {
    const std::string path(pathIn(spec));
    if (!isMap(path)) return nullptr;
    if constexpr (isBuilt(Wing::maps))
        return openTexelOf(path, isFilteredSidecar(path), spec.substr(path.size()));
    throw UsageError(notBuilt(path, Wing::maps));
}

/// The bytes of those of these files that are there.
std::size_t bytesOf(std::initializer_list<std::string> paths) {
    std::size_t bytes = 0;
    for (const std::string& path : paths) {
        std::error_code missing;
        const std::uintmax_t size = path.empty() ? 0 : std::filesystem::file_size(path, missing);
        if (!missing) bytes += size;
    }
    return bytes;
}

MapFacts factsOfMap(const std::string& path) {
    MapFacts facts;
    const auto take = [&](std::string form, const auto& levels) {
        facts.form = std::move(form);
        for (const auto& level : levels) facts.levels.push_back({level.width, level.height});
    };
    if (isFilteredSidecar(path)) {
        const FilteredSidecar map = readFilteredSidecar(path);
        take(map.form, map.levels);
        facts.bytes = bytesOf({map.texture, map.harmonics});
    } else if (isLibrarySidecar(path)) {
        const LibrarySidecar map = readLibrarySidecar(path);
        take("library", map.levels);
        facts.bytes = bytesOf({map.texture, map.library});
    } else {
        const MapSidecar map = readMapSidecar(path);
        take(map.form, map.levels);
        facts.bytes = bytesOf({map.texture});
    }
    return facts;
}

std::unique_ptr<Brdf> checked(std::unique_ptr<Brdf> brdf, Sides sides) {
    if (sides == Sides::reflection) requireReflection(*brdf, "this command");
    if (sides != Sides::eitherAndNamed) brdfs::requireReflectance(*brdf, "this command");
    return brdf;
}

/// Opens every source that `openSource` takes, reflections and transmissions.
std::unique_ptr<Brdf> openAnySource(const std::string& spec, bool rgb) {
    if (auto texel = openTexel(spec)) return texel;
    if (auto read = gpu::readIfForm(spec, sourceOpener()))
        return seenAsRgb(reconstruct(std::move(read->payload.form), sourceOpener()), rgb);
    if (gpu::looksLikePayload(spec)) {
        auto coefficients = gpu::unpack(gpu::readPayload(spec).payload);
        return seenAsRgb(std::make_unique<Reconstruction>(std::move(coefficients)), rgb);
    }
    if (!looksLikeCoefficients(spec)) return openBrdf(spec, rgb, Sides::eitherAndNamed);
    Representation representation = readRepresentation(spec);
    const bool plain = representation.steps.empty() && representation.added.empty() &&
                       representation.as<CoefficientArray>();
    if (plain) {
        return seenAsRgb(std::make_unique<Reconstruction>(decoded(representation)), rgb);
    }
    return seenAsRgb(reconstruct(std::move(representation), sourceOpener()), rgb);
}

}  // namespace

std::optional<MapFacts> mapOf(const std::string& spec) {
    const std::string path(pathIn(spec));
    if (!isMap(path)) return std::nullopt;
    if constexpr (isBuilt(Wing::maps)) {
        MapFacts facts = factsOfMap(path);
        const TexelWords texel = texelIn(path, spec.substr(path.size()));
        facts.x = texel.x, facts.y = texel.y, facts.level = texel.level;
        facts.texelIsGiven = texel.given;
        return facts;
    }
    throw UsageError(notBuilt(path, Wing::maps));
}

std::string texelRemark(const std::string& spec) {
    const std::optional<MapFacts> map = mapOf(spec);
    if (!map || map->texelIsGiven) return {};
    return fmt::format("texel 0,0 of level {}; :x=…,y=… names others", map->level);
}

std::unique_ptr<Brdf> openBrdf(const std::string& spec, bool rgb, Sides sides) {
    if (auto texel = openTexel(spec)) return texel;
    if (isLightFile(spec))
        throw InputError(fmt::format(
            "{}: has coefficients of light, where a BRDF or coefficients of one belong", spec));
    return checked(seenAsRgb(brdfs::open(spec), rgb), sides);
}

std::unique_ptr<Brdf> openSource(const std::string& spec, bool rgb, Sides sides) {
    return checked(openAnySource(spec, rgb), sides);
}

std::unique_ptr<Brdf> openBeside(const std::string& spec, const Brdf& source) {
    auto brdf = openBrdf(spec, true);
    if (brdf->channels().count() < source.channels().count())
        brdf = openBrdf(spec + " + 0 * lambert:kd=0/0.5/1", true);
    return brdf;
}

BrdfOpener sourceOpener() {
    return [](const std::string& spec) { return openAnySource(spec, false); };
}

void requireReadable(const Brdf& brdf) {
    if (const auto* measured = dynamic_cast<const brdfs::MeasuredBrdf*>(&brdf))
        measured->checkReadable();
    else
        brdf.checkIntact();
}

std::string whyZero(const Brdf& brdf) {
    const auto* measured = dynamic_cast<const brdfs::MeasuredBrdf*>(&brdf);
    if (!measured) return {};
    const brdfs::Census census = measured->census();
    if (census.negative == 0 || census.greatest > 0) return {};
    return fmt::format("{}: f is 0: of {} values none is above 0, and {} are below", brdf.name(),
                       census.values, census.negative);
}

OutgoingSet outgoingOrDefault(const std::string& text, const Brdf& brdf) {
    if (!text.empty()) return OutgoingSet::parse(text);
    return comparedOutgoing(brdf.laws().isotropic);
}

}  // namespace hshfit::jobs
