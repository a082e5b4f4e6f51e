#pragma once

#include <hshfit/brdf/channels.h>
#include <hshfit/files/json_format.h>
#include <hshfit/gpu/texels.h>
#include <hshfit/material_library/basis.h>
#include <hshfit/material_maps/texel_source.h>

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::inline library_maps {

/// The word `format` in the file of a library map, and in an export of it.
inline constexpr const char *libraryMapFormat = "hshfit-library-map",
                            *libraryMapExportFormat = "hshfit-gpu-library-map";

/// The numbers of a texel, [layer * 4 + lane], of C channels and K components. Layer 0 has the
/// bounds of the channels, in steps of a twelfth of ln(f + 0.001), and in lane 3 the error of the
/// texel; layer 1 + C g + c has, of channel c, the factors of the functions 4 g to 4 g + 3, of
/// which the first is the mean, with a factor of 1, and the others the components, with q_k.
struct LibraryLayout {
    std::size_t channels = 3, components = 0;

    std::size_t groups() const { return components / 4 + 1; }
    std::size_t layers() const { return 1 + channels * groups(); }
    std::size_t error() const { return 3; }
    std::size_t bound(std::size_t channel) const { return channel; }
    /// Factor of a function of a channel; function 0 is the mean.
    std::size_t factor(std::size_t channel, std::size_t function) const {
        return 4 * (1 + channels * (function / 4) + channel) + function % 4;
    }
};

/// A map of coefficients in a library as its JSON file states it, "hshfit-library-map"
/// (docs/explanation/svbrdf.md).
struct LibrarySidecar {
    LibraryLayout layout = {};
    Channels channels = {};
    std::string library = {}, sum = {};  ///< a library that has the basis, and its checksum
    std::string texture = {};
    gpu::Number number = gpu::Number::float16;
    std::vector<LevelSize> levels = {};
    std::string source = {}, generator = {};
};

/// The file, on one line.
std::string toText(const LibrarySidecar& sidecar);
/// Throws InputError that starts with `file`.
LibrarySidecar readLibrarySidecar(const std::string& file);
/// The same for a text that is the content of `file`.
LibrarySidecar parseLibrarySidecar(std::string_view text, const std::string& file);
/// Whether a file is one: of a map, or of an export of a map, which has the same keys beside its
/// own.
inline bool isLibrarySidecar(const std::string& file) {
    const std::string found = jsonFormatOf(file);
    return found == libraryMapFormat || found == libraryMapExportFormat;
}

}  // namespace hshfit::inline library_maps
