#pragma once

#include <jobs/common/listener.h>

#include <hshfit/material_library/library.h>
#include <hshfit/pictures/picture_error.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::jobs {

struct LearnLibraryOptions {
    material_library::LearnOptions learn = {};
    material_library::Limits limits = {};
    std::string addTo = {};  ///< a library whose materials come first; its options count
    bool final = false;      ///< without what adding and merging need
    /// After that time no further material is read; two always are.
    std::optional<double> seconds = {};
};

struct LearnedLibrary {
    material_library::Library library;  ///< without its materials, which are in the file
    material_library::LearnedBasis basis;
    std::size_t materials = 0, bytes = 0;     ///< and bytes of their numbers
    std::vector<std::string> fallbacks = {};  ///< materials with forms of their own
    std::vector<std::string> leftOut = {};    ///< specifications that the time was not enough for
};

/// Learns a library from specifications, files and folders of files, and writes it; names are
/// nameOf(spec) with '_' for what a name may not have. Materials that the terms of libraries do not
/// hold within the limits, and anisotropic ones, keep halfway forms. Nothing is written where one
/// of the materials that are read cannot be. Materials are on a disk meanwhile (scratchFolder()),
/// some 100 bytes of each in memory. Throws InputError, UsageError, NumericError and OutputError.
LearnedLibrary learnLibrary(const std::vector<std::string>& specs, const std::string& output,
                            const LearnLibraryOptions& options, const Listener& listener = {});

struct MergeLibraryOptions {
    /// None: the options of the libraries, which then have to be equal.
    std::optional<material_library::LearnOptions> learn = {};
    bool final = false;
};

/// The library of the materials of all: the same bytes as if it had been learned at once.
LearnedLibrary mergeLibraries(const std::vector<std::string>& paths, const std::string& output,
                              const MergeLibraryOptions& options);

struct EncodeOptions {
    std::size_t components = 0;                               ///< that are used; 0: all
    std::optional<double> log = {}, maximum = {}, flip = {};  ///< none: the library's limits
};

struct EncodedMaterial {
    material_library::Material material;
    PictureError picture;
};

/// Writes a library of the one material, which takes its basis from `library`.
EncodedMaterial encodeMaterial(const std::string& library, const std::string& spec,
                               const std::string& output, const EncodeOptions& options,
                               const Listener& listener = {});

/// Writes the material LIBRARY:NAME as a library of its own, without a basis.
material_library::Material decodeMaterial(const std::string& spec, const std::string& output);

struct MixedMaterial {
    std::string name;           ///< FIRST-SECOND-SHARE, the share of SECOND in percent
    std::string first, second;  ///< materials
    double share = 0;           ///< of the second, 0 to 1
};

/// `count` materials at equal steps along the path through LIBRARY:NAME after LIBRARY:NAME, written
/// as a library without a basis. Between two, ln(f + 0.001) and the bounds are linear, so that f is
/// neither negative nor above the greater bound. Throws UsageError for fewer than two of either and
/// for a material twice in turn, InputError for a material with a halfway form.
std::vector<MixedMaterial> mixMaterials(const std::vector<std::string>& specs,
                                        const std::string& output, std::size_t count);

struct FoundMaterial {
    std::string name;
    double distance = 0;  ///< root mean square of the difference of ln(f + 0.001), in the terms
    PictureError picture;
};

/// The `count` materials with the least mean FLIP as seen from `spec`, of the 3 `count` + 5 with
/// the least distance.
std::vector<FoundMaterial> searchLibrary(const std::string& library, const std::string& spec,
                                         std::size_t count, const Listener& listener = {});

/// The name of a material of this specification.
std::string materialName(const std::string& spec);

}  // namespace hshfit::jobs
