#pragma once

#include <hshfit/brdf/brdf.h>

#include <filesystem>
#include <string>
#include <string_view>

namespace hshfit::jobs {

/// Path and checksum of each file that a part of a specification names, as it stands or in a
/// folder.
std::string filesKey(std::string_view specification, const std::filesystem::path& folder = {});

/// The checksum of 1,024 values of a BRDF, over both hemispheres.
std::string valuesKey(const Brdf& brdf);

}  // namespace hshfit::jobs
