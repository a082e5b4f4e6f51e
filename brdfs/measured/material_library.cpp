#include <brdfs/measured/material_library.h>

#include <brdfs/presets/preset_collection.h>
#include <hshfit/error.h>
#include <hshfit/material_library/library_file.h>
#include <hshfit/wings.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

namespace hshfit::brdfs {
namespace {

/// The names that a message shows.
constexpr std::size_t shownNames = 8;

[[noreturn]] void refuseName(const std::string& path, std::string_view name,
                             const material_library::Library& library) {
    std::vector<std::string> names;
    for (const material_library::Material& material : library.materials)
        names.push_back(material.name);
    if (name.empty() && !names.empty()) {
        const std::size_t count = names.size();
        names.resize(std::min(count, shownNames));
        throw UsageError(fmt::format("{}: has {} materials; name one of them, {}:NAME ({}{})", path,
                                     count, path, fmt::join(names, ", "),
                                     count > names.size() ? ", …" : ""));
    }
    const std::vector<std::string> near = nearestNames(name, names, shownNames);
    throw UsageError(fmt::format(
        "{}: has no material '{}'{}", path, name,
        near.empty() ? std::string() : fmt::format(" (did you mean {}?)", fmt::join(near, ", "))));
}

std::unique_ptr<Brdf> openMaterialOf(const std::string& path, std::string_view name) {
    const material_library::Library library = material_library::readLibrary(path);
    const material_library::Material* material = nullptr;
    if (name.empty() && library.materials.size() == 1)
        material = &library.materials.front();
    else if (!name.empty())
        material = material_library::find(library, name);
    if (!material) refuseName(path, name, library);
    return material_library::open(library, *material,
                                  name.empty() ? path : fmt::format("{}:{}", path, name));
}

}  // namespace

std::unique_ptr<Brdf> openLibraryMaterial(const std::string& path, std::string_view name) {
    if constexpr (isBuilt(Wing::library)) return openMaterialOf(path, name);
    throw UsageError(notBuilt(path, Wing::library));
}

const Format& materialLibraryFormat() {
    static const Format format{
        .name = "library",
        .help = "a library of materials (hshfit library learn): LIBRARY:NAME",
        .extension = ".library",
        .recognises = [](std::span<const unsigned char> head,
                         std::uint64_t) { return material_library::looksLikeLibrary(head); },
        .parameters = {},
        .open = [](const std::string& path, const Parameters&) -> std::unique_ptr<Brdf> {
            return openLibraryMaterial(path, {});
        },
    };
    return format;
}

}  // namespace hshfit::brdfs
