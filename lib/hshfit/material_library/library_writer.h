#pragma once

#include <hshfit/files/atomic_file.h>
#include <hshfit/files/scratch_file.h>
#include <hshfit/material_library/library.h>

#include <cstddef>
#include <functional>
#include <string>

namespace hshfit::material_library {

/// Measured materials that a file is to keep, by number; an empty list writes none.
struct MeasuredList {
    std::size_t count = 0;
    std::function<Measured(std::size_t)> at = {};
};

/// Writes a library material after material: what a file has of each is on a disk meanwhile
/// (scratch_file.h). Members throw OutputError.
class LibraryWriter {
public:
    /// `folder` as of ScratchFile.
    explicit LibraryWriter(const std::string& folder);

    /// The next material by name.
    void add(const Material& material);

    /// `head` is the library without its materials. `measured` by name. Not committed.
    void write(const Library& head, const MeasuredList& measured, AtomicFile& file) const;

private:
    ScratchFile rows_, codes_, halfway_, polynomials_, polynomialTops_;
    std::string folder_;
};

}  // namespace hshfit::material_library
