#pragma once

#include "svbrdf.h"

namespace hshfit::jobs {

/// A map of the form library in FOLDER: material.ktx2 with coordinates in the basis of a library,
/// which material.library has, material.json and errors.png. The library is learned from up to 24
/// texels of the map that are far from each other and one of each further level, or is
/// SvbrdfOptions::library. Texels are fitted one by one to f itself. Throws as `svbrdf` does.
Svbrdf librarySvbrdf(const std::string& description, const std::string& folder,
                     const SvbrdfOptions& options, const Listener& listener = {});

}  // namespace hshfit::jobs
