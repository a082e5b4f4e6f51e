#pragma once

#include <hshfit/files/atomic_file.h>
#include <hshfit/files/tensor_file.h>
#include <hshfit/material_library/library.h>

#include <functional>
#include <span>
#include <string>
#include <string_view>

namespace hshfit::material_library {

/// The first field of the tensor file (tensor_file.h) that a library is: JSON with the materials.
/// docs/explanation/library_of_materials.md has the others.
inline constexpr const char* headField = "hshfit_library";

/// Whether the first bytes of a file are those of a library.
inline bool looksLikeLibrary(std::span<const unsigned char> head) {
    const std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
    return text.starts_with(TensorFile::magic) &&
           text.substr(0, 64).find(headField) != std::string_view::npos;
}

/// Without `measured` if that is empty. Not committed.
void writeLibrary(const Library& library, AtomicFile& file);

/// Throws InputError that names the file and the field: nothing is taken from a file that its
/// sizes and ranges do not allow. The basis of another file is read from there, by a path from the
/// folder of this one, and has to have the checksum that this one states.
Library readLibrary(const std::string& path);

/// The same from memory; `basisOf` reads the basis of another file.
Library parseLibrary(std::span<const unsigned char> bytes, const std::string& name,
                     const std::function<Basis(const std::string& file)>& basisOf);

}  // namespace hshfit::material_library
