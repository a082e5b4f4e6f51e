#include "library_map.h"

#include <hshfit/each_in_parallel.h>
#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>
#include <hshfit/material_library/library_file.h>
#include <hshfit/material_library/similarity.h>
#include <hshfit/pictures/picture_error.h>
#include <hshfit/pictures/sphere_picture.h>

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <span>

namespace hshfit::jobs {
namespace {

namespace ml = material_library;
using Place = std::array<double, 2>;

/// The looks and the logarithms of all materials.
struct Seen {
    std::vector<ml::MaterialLook> looks;
    std::vector<ml::LogMaterial> logs;
};

Seen seenOf(const ml::Library& library, const ml::LogSpace& space, const Listener& listener) {
    const std::size_t count = library.materials.size();
    Seen seen{std::vector<ml::MaterialLook>(count), std::vector<ml::LogMaterial>(count)};
    const ProgressCall progress = listener.part("thumbnails");
    std::atomic<std::size_t> done = 0;
    eachInParallel(count, [&](std::size_t m) {
        const ml::Material& material = library.materials[m];
        const auto brdf = ml::open(library, material, material.name);
        seen.looks[m] = ml::lookOf(*brdf, thumbnailPixels);
        seen.logs[m] = ml::projectedMaterial(space, library, material);
        if (progress) progress(++done, count);
    });
    return seen;
}

/// Refuses numbers of a file that no picture shows and no map places.
void requireFinite(const std::string& path, const ml::Library& library, const Seen& seen,
                   const ml::Similarity& similarity) {
    const std::size_t count = library.materials.size();
    for (std::size_t m = 0; m < count; ++m) {
        const ml::MaterialLook& look = seen.looks[m];
        const auto distances = std::span(similarity.distances).subspan(m * count, count);
        const bool isFinite =
            look.picture.notFinite == 0 && std::isfinite(look.luminance) &&
            std::isfinite(look.chroma) && std::isfinite(look.gloss) &&
            std::isfinite(std::accumulate(distances.begin(), distances.end(), 0.0));
        if (!isFinite)
            throw InputError(fmt::format("{}: '{}' has values that are not finite", path,
                                         library.materials[m].name));
    }
}

/// Turns an axis around where it falls with the values.
void orient(std::vector<Place>& places, std::size_t axis, const std::vector<double>& values) {
    const double mean =
        std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
    double sum = 0;
    for (std::size_t m = 0; m < places.size(); ++m) sum += places[m][axis] * (values[m] - mean);
    if (sum >= 0) return;
    for (Place& place : places) place[axis] = -place[axis];
}

void placeAll(const ml::Similarity& similarity, LibraryMap& map) {
    std::vector<double> gloss, darkness;
    for (const MappedMaterial& one : map.materials) {
        gloss.push_back(one.look.gloss);
        darkness.push_back(-one.look.luminance);
    }
    std::vector<Place> places = similarity.coordinates;
    orient(places, 0, gloss);
    orient(places, 1, darkness);  // y points down
    places = ml::spreadPlaces(places);
    for (std::size_t m = 0; m < places.size(); ++m) {
        map.materials[m].x = places[m][0];
        map.materials[m].y = places[m][1];
        map.width = std::max(map.width, places[m][0] + 0.5);
        map.height = std::max(map.height, places[m][1] + 0.5);
    }
}

std::vector<Neighbour> neighboursOf(const LibraryMap& map, std::size_t material) {
    const std::size_t count = map.materials.size();
    std::vector<Neighbour> all;
    for (std::size_t m = 0; m < count; ++m)
        if (m != material)
            all.push_back({.material = m, .distance = map.distances[material * count + m]});
    std::ranges::stable_sort(all, {}, &Neighbour::distance);
    all.resize(std::min(all.size(), mapNeighbours));
    return all;
}

/// FLIP of all neighbours; a pair of two that are neighbours of each other is compared once.
void compareNeighbours(LibraryMap& map, const Listener& listener) {
    for (std::size_t m = 0; m < map.materials.size(); ++m)
        map.materials[m].neighbours = neighboursOf(map, m);
    std::vector<NearDuplicates> pairs;
    for (std::size_t m = 0; m < map.materials.size(); ++m)
        for (const Neighbour& one : map.materials[m].neighbours)
            pairs.push_back({.first = std::min(m, one.material),
                             .second = std::max(m, one.material),
                             .distance = one.distance});
    const auto key = [](const NearDuplicates& pair) { return std::pair(pair.first, pair.second); };
    std::ranges::sort(pairs, {}, key);
    const auto isSame = [&](const NearDuplicates& a, const NearDuplicates& b) {
        return key(a) == key(b);
    };
    pairs.erase(std::unique(pairs.begin(), pairs.end(), isSame), pairs.end());
    const ProgressCall progress = listener.part("pictures");
    std::atomic<std::size_t> done = 0;
    eachInParallel(pairs.size(), [&](std::size_t k) {
        pairs[k].flip = sphereFlip(map.materials[pairs[k].first].look.picture,
                                   map.materials[pairs[k].second].look.picture);
        if (progress) progress(++done, pairs.size());
    });
    for (std::size_t m = 0; m < map.materials.size(); ++m) {
        for (Neighbour& one : map.materials[m].neighbours) {
            const std::pair wanted(std::min(m, one.material), std::max(m, one.material));
            one.flip = std::ranges::lower_bound(pairs, wanted, {}, key)->flip;
        }
    }
    std::ranges::copy_if(pairs, std::back_inserter(map.duplicates),
                         [&](const NearDuplicates& pair) { return pair.flip <= map.near; });
    std::ranges::stable_sort(map.duplicates, {}, &NearDuplicates::flip);
}

}  // namespace

LibraryMap mapLibrary(const std::string& path, const std::string& output,
                      const LibraryMapOptions& options, const Listener& listener) {
    const ml::Library library = ml::readLibrary(path);
    if (library.materials.empty() || library.materials.size() > mostMapped)
        throw InputError(fmt::format("{}: has {} materials; a map shows 1 to {}", path,
                                     library.materials.size(), mostMapped));
    AtomicFile file(output);
    const ml::LogSpace space;
    Seen seen = seenOf(library, space, listener);
    ml::Similarity similarity = ml::similarityOf(space, seen.logs);
    requireFinite(path, library, seen, similarity);
    LibraryMap map{.library = path, .near = options.near, .kept = similarity.kept};
    map.distances = std::move(similarity.distances);
    std::vector<SpherePicture> pictures;
    for (std::size_t m = 0; m < library.materials.size(); ++m) {
        pictures.push_back(seen.looks[m].picture);
        map.materials.push_back(
            {.material = library.materials[m], .look = std::move(seen.looks[m]), .neighbours = {}});
    }
    map.stops = automaticExposure(pictures);
    placeAll(similarity, map);
    compareNeighbours(map, listener);
    file.write(libraryMapPage(map));
    file.commit();
    return map;
}

}  // namespace hshfit::jobs
