#include <hshfit/library_maps/library_sidecar.h>

#include <hshfit/error.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/files/mapped_file.h>
#include <hshfit/material_maps/level_json.h>
#include <hshfit/material_maps/map_sidecar.h>

#include <fmt/format.h>

#include <filesystem>

namespace hshfit::inline library_maps {
namespace {

constexpr std::size_t mostBytes = std::size_t{1} << 20;
constexpr int mostComponents = 512;

}  // namespace

std::string toText(const LibrarySidecar& s) {
    const nlohmann::ordered_json json = {
        {"format", libraryMapFormat},
        {"version", 1},
        {"channels", s.channels.names()},
        {"library", {{"file", s.library}, {"sha256", s.sum}, {"components", s.layout.components}}},
        {"texture",
         {{"file", s.texture},
          {"number", gpu::numberName(s.number)},
          {"layers", s.layout.layers()},
          {"levels", levelsJson(s.levels)}}},
        {"source", s.source},
        {"generator", s.generator}};
    return jsonText(json) + "\n";
}

LibrarySidecar readLibrarySidecar(const std::string& file) {
    const MappedFile mapped(file);
    if (mapped.size() > mostBytes) throw InputError(fmt::format("{}: is too large", file));
    return parseLibrarySidecar({reinterpret_cast<const char*>(mapped.data()), mapped.size()}, file);
}

LibrarySidecar parseLibrarySidecar(std::string_view text, const std::string& file) {
    const nlohmann::json json = parseJson(text, file, 8);
    const JsonFields root(json, "", file);
    const bool exported = root.word("format") == libraryMapExportFormat;
    if (!exported && root.word("format") != libraryMapFormat)
        root.fail("is not hshfit-library-map", "format");
    if (root.integer("version", 1, 1 << 20) != 1)
        root.fail("is newer than this program", "version");
    const auto folder = std::filesystem::path(file).parent_path();
    const JsonFields texture = root.object(exported ? "map" : "texture"),
                     library = root.object("library");
    LibrarySidecar s;
    s.channels = root.words("channels").size() == 1 ? Channels::grey() : Channels::rgb();
    if (root.words("channels") != s.channels.names())
        root.fail("has to be grey, or R, G, B", "channels");
    s.layout = {s.channels.count(),
                static_cast<std::size_t>(library.integer("components", 0, mostComponents))};
    s.library = (folder / library.fileName("file")).string();
    s.sum = library.word("sha256");
    s.texture = exported ? exportedTexture(root, "map", file)
                         : (folder / texture.fileName("file")).string();
    s.number = gpu::numberIn(texture, "number");
    if (isNormalised(s.number)) texture.fail("has to be float16 or float32", "number");
    s.levels = readLevels(texture);
    if (static_cast<std::size_t>(texture.integer("layers", 1, 1 << 24)) != s.layout.layers())
        texture.fail(fmt::format("has to be {}", s.layout.layers()), "layers");
    s.source = root.word("source");
    s.generator = root.word("generator");
    return s;
}

}  // namespace hshfit::inline library_maps
