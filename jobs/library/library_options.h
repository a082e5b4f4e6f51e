#pragma once

#include "library_export.h"
#include "library_map.h"
#include "material_library.h"
#include "material_samples.h"

#include <jobs/common/option_row.h>

#include <cstddef>
#include <string>

namespace hshfit::jobs {

/// Actions on libraries, as bits of OptionRow::inputs.
namespace libraries {
enum : unsigned {
    learn = 1,
    add = 2,  ///< learn with LearnLibraryOptions::addTo, a library that states the others
    merge = 4,
    encode = 8,
    search = 16,
    mix = 32,
    reconstruct = 64,
    next = 128,
    exported = 256,
    map = 512,
};
}  // namespace libraries

/// The options of all actions.
struct LibraryOptions {
    std::string components = "auto";  ///< or a number; componentCount reads it
    std::size_t count = 10;           ///< of materials, or of the next pairs
    LearnLibraryOptions learn = {};
    EncodeOptions encode = {};  ///< its limits hold for learn, too
    ReconstructOptions reconstruct = {};
    NextPairsOptions next = {};  ///< but for library, sigma and count, which are above
    LibraryExportOptions exporting = {};
    LibraryMapOptions map = {};

    /// 0 for auto. Throws UsageError for other than auto and 1 to 512.
    std::size_t componentCount() const;
};

OptionRows<LibraryOptions> libraryOptions();

}  // namespace hshfit::jobs
