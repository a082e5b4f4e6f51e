#pragma once

#include <brdfs/rows/format.h>

#include <memory>
#include <string>
#include <string_view>

namespace hshfit::brdfs {

/// A material of a library (hshfit/material_library), LIBRARY:NAME; of a library of one material
/// the name may be left out. Throws InputError for a file that is invalid, UsageError for a name
/// that the library does not have.
std::unique_ptr<Brdf> openLibraryMaterial(const std::string& path, std::string_view name);

/// The row of the table of formats.
const Format& materialLibraryFormat();

}  // namespace hshfit::brdfs
