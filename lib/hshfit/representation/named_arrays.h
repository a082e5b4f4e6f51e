#pragma once

#include <hshfit/representation/representation.h>

#include <string>
#include <vector>

namespace hshfit::inline representation {

/// An array of a representation under the name that files give it:
///     outgoing  "coefficients", or "left" and "right"
///     basis     "matrix", or for each block "block NAME", or "left NAME" (symmetric: "core NAME")
///               and "right NAME"
///     halfway   "halfway"
template <class Array>
struct Named {
    std::string name;
    Array array;
};

/// All arrays, in the order of files.
std::vector<Named<StoredArray*>> namedArrays(Representation& representation);
std::vector<Named<const StoredArray*>> namedArrays(const Representation& representation);

/// The inverse, in any order. Throws InputError for a name that the kind does not have, for one
/// given twice, and where arrays of one name need others that are absent.
Content contentOf(Representation::Kind kind, std::vector<Named<StoredArray>> arrays);

}  // namespace hshfit::inline representation
