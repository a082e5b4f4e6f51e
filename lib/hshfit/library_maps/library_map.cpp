#include <hshfit/library_maps/library_map.h>

#include <hshfit/error.h>
#include <hshfit/material_library/library_file.h>
#include <hshfit/material_library/pair_fit.h>

#include <fmt/format.h>

namespace hshfit::inline library_maps {
namespace {

namespace ml = material_library;

/// The basis that a map was written with.
ml::Basis basisOf(const LibrarySidecar& sidecar, const std::string& file) {
    ml::Basis basis = ml::readLibrary(sidecar.library).basis;
    if (basis.size() != sidecar.layout.components || ml::checksum(basis) != sidecar.sum)
        throw InputError(fmt::format("{}: was written with another basis than {} has now", file,
                                     sidecar.library));
    return basis;
}

}  // namespace

LibraryMap::LibraryMap(LibrarySidecar sidecar, std::string file)
    : file_(std::move(file)),
      sidecar_(std::move(sidecar)),
      basis_(basisOf(sidecar_, file_)),
      texture_(sidecar_.texture, sidecar_.levels, sidecar_.layout.layers(), sidecar_.number,
               file_) {}

std::unique_ptr<Brdf> LibraryMap::texel(std::size_t level, std::size_t column,
                                        std::size_t row) const {
    return brdfOf(basis_, sidecar_.layout, numbers(level, column, row),
                  fmt::format("{}:x={},y={},level={}", file_, column, row, level));
}

std::unique_ptr<Brdf> brdfOf(const ml::Basis& basis, const LibraryLayout& layout,
                             const std::vector<double>& numbers, const std::string& name) {
    std::vector<double> channels;
    for (std::size_t c = 0; c < layout.channels; ++c) {
        for (std::size_t k = 1; k <= layout.components; ++k)
            channels.push_back(numbers[layout.factor(c, k)]);
        channels.push_back(numbers[layout.bound(c)]);
    }
    return std::make_unique<ml::LogBrdf>(fromNumbers(basis, channels.data(), layout.channels),
                                         name);
}

}  // namespace hshfit::inline library_maps
