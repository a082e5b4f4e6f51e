#pragma once

#include <brdfs/catalog/tables.h>

namespace hshfit::brdfs {

/// Opens a BRDF specification:
///     model[:key=value,…] | path of a measured file[:key=value,…] | path of a preset .json |
///     preset:NAME | a sum of these, "SPEC + WEIGHT * SPEC" (sum.h) |
///     rgb:SPEC, a spectral one as linear Rec. 709 (hshfit/colour.h)
/// Throws UsageError for an unknown model, key or value (naming the valid ones) and InputError for
/// a file that is absent, of no known format, or invalid.
std::unique_ptr<Brdf> open(std::string_view spec);

}  // namespace hshfit::brdfs
