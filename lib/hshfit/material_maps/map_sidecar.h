#pragma once

#include <hshfit/coefficients/coefficients.h>
#include <hshfit/files/json_format.h>
#include <hshfit/gpu/texels.h>
#include <hshfit/material_maps/map_writer.h>
#include <hshfit/material_maps/texel_layout.h>

#include <string>
#include <string_view>
#include <vector>

namespace hshfit::inline files {
class JsonFields;
}

namespace hshfit::inline material_maps {

/// The word `format` in the file of a material map, and in an export of it.
inline constexpr std::string_view materialMapFormat = "hshfit-material-map",
                                  materialMapExportFormat = "hshfit-gpu-map";

/// A map of materials as its JSON file states it, "hshfit-material-map"
/// (docs/explanation/svbrdf.md).
struct MapSidecar {
    std::string form;  ///< "outgoing", "low-rank", "clusters" or "halfway"
    std::string texture = {}, basis = {};
    int order = 0;
    Quantity quantity = Quantity::brdf;
    Channels channels = {};
    TexelLayout layout = {};
    bool isotropic = false, bilateral = false;
    gpu::Number number = gpu::Number::float16;
    std::vector<LevelSize> levels = {};
    std::vector<double> shapes = {};  ///< [rank][layout.shape()]; none of the form outgoing
    std::vector<float> centres = {};  ///< [cluster][channel * rank + r]; of clusters and halfway
    /// Coefficient files of the materials, of the form halfway; empty where no texel has one.
    std::vector<std::string> files = {};
    std::string source = {}, generator = {};

    std::size_t layers() const;
    std::size_t rank() const { return shapes.size() / layout.shape(); }
    /// Whether texels are indices of shared materials, and how many there are.
    bool hasMaterials() const { return form == "clusters" || form == "halfway"; }
    std::size_t materials() const {
        return hasMaterials() ? centres.size() / (channels.count() * rank()) : 0;
    }
};

/// The file, on one line.
std::string toText(const MapSidecar& sidecar);
/// Throws InputError that starts with `file`.
MapSidecar readMapSidecar(const std::string& file);
/// The same for a text that is the content of `file`.
MapSidecar parseMapSidecar(std::string_view text, const std::string& file);
/// Whether a file is one: of a map, or of an export of a map, which has the same keys beside its
/// own.
inline bool isMapSidecar(const std::string& file) {
    const std::string found = jsonFormatOf(file);
    return found == materialMapFormat || found == materialMapExportFormat;
}
/// The KTX 2.0 file of a role that the sidecar `file` of an export lists. Throws InputError where
/// it lists none.
std::string exportedTexture(const JsonFields& sidecar, std::string_view role,
                            const std::string& file);

}  // namespace hshfit::inline material_maps
