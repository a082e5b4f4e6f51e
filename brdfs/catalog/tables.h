#pragma once

#include <brdfs/rows/format.h>
#include <brdfs/rows/model.h>
#include <brdfs/rows/writer.h>

#include <memory>
#include <span>
#include <string_view>

namespace hshfit::brdfs {

/// The catalogs, in the order in which they are listed.
std::span<const Model> models();
std::span<const Format> formats();
std::span<const Writer> writers();

/// The model of that name; null if there is none.
const Model* findModel(std::string_view name);
/// Throws UsageError: no model of that name, with the nearest.
[[noreturn]] void refuseModel(std::string_view name);

/// Opens "model[:key=value,…]". Throws UsageError as `open` does.
std::unique_ptr<Brdf> openModel(std::string_view spec);

/// Opens a sum of them, "MODEL + WEIGHT * MODEL" (composed/sum.h). Throws likewise.
std::unique_ptr<Brdf> openModels(std::string_view spec);

}  // namespace hshfit::brdfs
