#pragma once

#include <hshfit/brdf/channels.h>
#include <hshfit/files/json_format.h>
#include <hshfit/gpu/texels.h>
#include <hshfit/material_maps/texel_source.h>
#include <hshfit/normal_filtering/lobe_table.h>
#include <hshfit/normal_filtering/mip_layout.h>

#include <span>
#include <string>
#include <vector>

namespace hshfit::inline filtered_maps {

/// The word `format` in the file of a filtered map, and in an export of it.
inline constexpr const char *filteredMapFormat = "hshfit-filtered-map",
                            *filteredMapExportFormat = "hshfit-gpu-filtered-map";

/// A parameter of the lobe that varies from texel to texel: the values at whole numbers of
/// LobePlace, rising; linear between them.
struct LobeNodes {
    std::string name;
    std::vector<double> values;

    double placeOf(double value) const;
    double valueAt(double place) const;
};

/// The weight of a term of the lobe in one channel: scale times a weight of the texel.
struct LobeWeight {
    std::size_t weight = 0;
    double scale = 0;
};

/// D at a node of the parameters, for shaders.
struct StoredLobe {
    double widthX = 0, widthY = 0;
    GaussianSum gaussians = {};
};

/// A map of turned and filtered lobes as its JSON file states it, "hshfit-filtered-map"
/// (docs/explanation/filtered_maps.md).
struct FilteredSidecar {
    std::string form;        ///< "ellipse" or "harmonics"
    MipLayout layout = {};   ///< order 1 without harmonics
    std::string model = {};  ///< specification of the model without the parameters of `nodes`
    std::vector<LobeNodes> nodes = {};                ///< at most two
    std::vector<std::vector<LobeWeight>> terms = {};  ///< [term of the lobe][channel]
    Channels channels = {};
    gpu::Number number = gpu::Number::float16;
    std::string texture = {};    ///< of all levels: the first numbers of MipLayout
    std::string harmonics = {};  ///< from level 1 on: the other numbers
    std::vector<LevelSize> levels = {};
    std::vector<StoredLobe> lobes = {};  ///< [row][column] of nodes
    std::string source = {}, generator = {};

    /// The levels of the texture of harmonics.
    std::span<const LevelSize> harmonicLevels() const {
        return harmonics.empty() ? std::span<const LevelSize>() : std::span(levels).subspan(1);
    }
    std::size_t layers() const { return (layout.ellipseSize() + 3) / 4; }
    std::size_t harmonicLayers() const { return (layout.size() - layout.ellipseSize() + 3) / 4; }
};

/// The file, on one line.
std::string toText(const FilteredSidecar& sidecar);
/// Throws InputError that starts with `file`.
FilteredSidecar readFilteredSidecar(const std::string& file);
/// Whether a file is one: of a map, or of an export of a map, which has the same keys beside its
/// own.
inline bool isFilteredSidecar(const std::string& file) {
    const std::string found = jsonFormatOf(file);
    return found == filteredMapFormat || found == filteredMapExportFormat;
}

}  // namespace hshfit::inline filtered_maps
