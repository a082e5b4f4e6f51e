#pragma once

#include <jobs/common/listener.h>

#include <hshfit/material_library/library.h>
#include <hshfit/material_library/material_look.h>

#include <nlohmann/json_fwd.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace hshfit::jobs {

/// The most materials of a map: its page has a picture of each.
inline constexpr std::size_t mostMapped = 1000;
/// Neighbours of a material whose pictures are compared.
inline constexpr std::size_t mapNeighbours = 5;
/// Pixels along an edge of a thumbnail.
inline constexpr int thumbnailPixels = 72;

struct LibraryMapOptions {
    /// Mean FLIP of the thumbnails of two neighbours up to which they are near duplicates: the FLIP
    /// above which a picture is called poor (PoorBounds).
    double near = 0.1;
};

struct Neighbour {
    std::size_t material = 0;
    double distance = 0;  ///< root mean square of the difference of ln(f + 0.001)
    double flip = 0;      ///< sphereFlip of the thumbnails, the first by name as the reference
};

struct MappedMaterial {
    material_library::Material material;
    material_library::MaterialLook look;
    double x = 0, y = 0;  ///< the middle of the thumbnail, in its widths, from the upper left
    std::vector<Neighbour> neighbours = {};  ///< by rising distance
};

struct NearDuplicates {
    std::size_t first = 0, second = 0;
    double distance = 0, flip = 0;
};

struct LibraryMap {
    std::string library;
    double near = 0;
    std::vector<MappedMaterial> materials = {};   ///< by name
    std::vector<double> distances = {};           ///< [first][second]
    std::vector<NearDuplicates> duplicates = {};  ///< by rising FLIP
    double width = 0, height = 0;                 ///< of the map, in thumbnails
    double kept = 0;                              ///< Similarity::kept
    double stops = 0;                             ///< exposure of all thumbnails
};

/// Places all materials of a library on a map by their similarity, and writes a page of it with
/// thumbnails. The first principal coordinate grows to the right, and is turned so that glossy
/// materials lie there; the second so that bright ones lie above. Materials with halfway forms have
/// the distances of their projections onto the functions of libraries. Throws InputError for a file
/// that is no library and for more than mostMapped materials, OutputError.
LibraryMap mapLibrary(const std::string& path, const std::string& output,
                      const LibraryMapOptions& options, const Listener& listener = {});

/// The members of the answer, apart from its head.
nlohmann::ordered_json libraryMapJson(const LibraryMap& map);

/// One self-contained page: thumbnails, filters, near duplicates, and each material's facts.
std::string libraryMapPage(const LibraryMap& map);

}  // namespace hshfit::jobs
