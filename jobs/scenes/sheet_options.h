#pragma once

#include "render.h"
#include "spheres.h"

#include <jobs/common/option_row.h>

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace hshfit::jobs {

/// The options of sheets of pictures: spheres under point lights, or surfaces under any light.
struct SheetOptions {
    /// Specifications (light/catalog.h), and point lights about the line of sight,
    /// "THETA,PHI[,STRENGTH]" in degrees; empty: the lights of SphereRig.
    std::vector<std::string> light = {};
    std::optional<double> dome = {};  ///< none: as SphereRig with point lights alone, else 0
    std::optional<std::size_t> samples = {};  ///< N: N x N a pixel; none: as each kind has it
    RenderOptions surfaces = {};              ///< the others, of spheres too where they have them
};

/// Kinds of sheets (OptionRow::inputs), and details of surfaces, which do not ask for surfaces.
namespace sheets {
inline constexpr unsigned spheres = 1, surfaces = 2, details = 4;
}
/// Refuses a detail that is given for spheres, by its name: throws UsageError.
[[noreturn]] void refuseDetail(std::string_view option);

OptionRows<SheetOptions> sheetOptions();

/// The options of one kind: surfaces with `surface`, which says that an option of them alone was
/// given, or with a light that is no point; else spheres. Throws UsageError.
std::variant<SphereSheetOptions, RenderOptions> sheetOf(const SheetOptions& options, bool surface);

}  // namespace hshfit::jobs
