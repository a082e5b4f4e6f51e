#pragma once

// Options that several jobs have, each in a struct of its own.

#include <jobs/common/option_row.h>

namespace hshfit::jobs {

constexpr OptionRow rgbRow(Member value) {
    return {"rgb", value, "Turn wavelengths into linear Rec. 709 (CIE 1931 2 degrees, D65)"};
}

/// The tolerance of quadrature; 0: as the BRDF asks for.
constexpr OptionRow toleranceRow(Member value) {
    const OptionRow row{
        "tolerance", value,
        "Relative error of the quadrature to refine to (default: 1e-6, tables 3e-3)"};
    return row.within(bounds::tolerance);
}

/// A whole number that is given as 1e6, too.
constexpr OptionRow evaluationsRow(Member value) {
    const OptionRow row{"max-evaluations", value,
                        "BRDF evaluations per outgoing direction before giving up"};
    return row.within(bounds::evaluations);
}

}  // namespace hshfit::jobs
