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

/// Whether a file with these first bytes is a library.
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

/// Take the materials of a library, in the order of their names each.
struct LibraryCalls {
    std::function<void(Material)> material;
    std::function<void(Measured)> measured;
};
/// The same for libraries that are larger than memory: the materials go to `calls`, some of them
/// before a mistake in the file is found, and the answer has none.
Library readLibrary(const std::string& path, const LibraryCalls& calls);

/// Reads the basis of another file.
using BasisOf = std::function<Basis(const std::string& file)>;

/// The library from memory.
Library parseLibrary(std::span<const unsigned char> bytes, const std::string& name,
                     const BasisOf& basisOf);

}  // namespace hshfit::material_library
