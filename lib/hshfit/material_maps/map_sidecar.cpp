#include <hshfit/material_maps/map_sidecar.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/files/json_format.h>
#include <hshfit/files/mapped_file.h>
#include <hshfit/material_maps/level_json.h>

#include <fmt/format.h>

#include <filesystem>

namespace hshfit::inline material_maps {
namespace {

constexpr std::size_t mostBytes = std::size_t{1} << 30;

template <class T>
nlohmann::ordered_json tableOf(const std::vector<T>& values, std::size_t columns) {
    auto rows = nlohmann::ordered_json::array();
    for (std::size_t at = 0; at < values.size(); at += columns) {
        rows.push_back(std::vector<T>(values.begin() + static_cast<std::ptrdiff_t>(at),
                                      values.begin() + static_cast<std::ptrdiff_t>(at + columns)));
    }
    return rows;
}

std::vector<double> flat(const JsonFields& root, const char* key, std::size_t columns) {
    const nlohmann::json& rows = root.at(key);
    if (!rows.is_array() || rows.empty()) root.fail("has to be an array of rows", key);
    std::vector<double> values;
    for (const auto& row : root.table(key, rows.size(), columns))
        values.insert(values.end(), row.begin(), row.end());
    return values;
}

}  // namespace

std::size_t MapSidecar::layers() const {
    if (form == "outgoing") return layout.layers();
    return hasMaterials() ? 1 : (channels.count() * rank() + 3) / 4;
}

std::string toText(const MapSidecar& s) {
    nlohmann::ordered_json json = {
        {"format", materialMapFormat},
        {"version", 1},
        {"form", s.form},
        {"basis", {{"name", s.basis}, {"order", s.order}, {"index", "l*(l+1)+m"}}},
        {"quantity", quantityName(s.quantity)},
        {"channels", s.channels.names()},
        {"outgoing", s.layout.outgoing.spec()},
        {"slots", s.layout.slots},
        {"symmetry", {{"isotropic", s.isotropic}, {"bilateral", s.bilateral}}},
        {"texture",
         {{"file", s.texture},
          {"number", gpu::numberName(s.number)},
          {"layers", s.layers()},
          {"levels", levelsJson(s.levels)}}},
        {"source", s.source},
        {"generator", s.generator}};
    if (!s.shapes.empty()) json["shapes"] = tableOf(s.shapes, s.layout.shape());
    if (!s.centres.empty()) json["materials"] = tableOf(s.centres, s.channels.count() * s.rank());
    if (!s.files.empty()) json["files"] = s.files;
    return jsonText(json) + "\n";
}

MapSidecar readMapSidecar(const std::string& file) {
    const MappedFile mapped(file);
    if (mapped.size() > mostBytes) throw InputError(fmt::format("{}: is too large", file));
    return parseMapSidecar({reinterpret_cast<const char*>(mapped.data()), mapped.size()}, file);
}

MapSidecar parseMapSidecar(std::string_view text, const std::string& file) {
    const nlohmann::json json = parseJson(text, file, 8);
    const JsonFields root(json, "", file);
    const bool exported = root.word("format") == materialMapExportFormat;
    if (!exported && root.word("format") != materialMapFormat)
        root.fail("is not hshfit-material-map", "format");
    if (root.integer("version", 1, 1 << 20) != 1)
        root.fail("is newer than this program", "version");
    const JsonFields basis = root.object("basis"), symmetry = root.object("symmetry");
    const JsonFields texture = root.object(exported ? "map" : "texture");
    MapSidecar s{
        .form = root.word("form"),
        .texture =
            exported ? exportedTexture(root, "map", file)
                     : (std::filesystem::path(file).parent_path() / texture.word("file")).string(),
        .basis = basis.word("name"),
        .order = basis.integer("order", 1, 1000)};
    if (s.form != "outgoing" && s.form != "low-rank" && !s.hasMaterials())
        root.fail("has to be outgoing, low-rank, clusters or halfway", "form");
    const std::string quantity = root.word("quantity");
    if (quantity != quantityName(Quantity::brdf) && quantity != quantityName(Quantity::brdfCosine))
        root.fail("has to be brdf or brdf_cosine", "quantity");
    s.quantity = quantity == quantityName(Quantity::brdf) ? Quantity::brdf : Quantity::brdfCosine;
    s.channels = root.words("channels").size() == 1 ? Channels::grey() : Channels::rgb();
    if (root.words("channels") != s.channels.names())
        root.fail("has to be grey, or R, G, B", "channels");
    s.layout = {.outgoing = OutgoingSet::parse(root.word("outgoing")),
                .channels = s.channels.count()};
    for (const double slot : root.numbers("slots")) {
        if (slot < 0 || slot >= s.order * s.order)
            root.fail("has a slot beyond the order", "slots");
        s.layout.slots.push_back(static_cast<int>(slot));
    }
    if (s.layout.slots.empty()) root.fail("is empty", "slots");
    s.isotropic = symmetry.flag("isotropic");
    s.bilateral = symmetry.flag("bilateral");
    s.number = gpu::numberIn(texture, "number");
    s.levels = readLevels(texture);
    if (s.form != "outgoing") s.shapes = flat(root, "shapes", s.layout.shape());
    if (s.hasMaterials()) {
        for (const double value : flat(root, "materials", s.channels.count() * s.rank()))
            s.centres.push_back(static_cast<float>(value));
    }
    if (s.form == "halfway") {
        const std::filesystem::path folder = std::filesystem::path(file).parent_path();
        for (const std::string& name : root.words("files")) {
            if (std::filesystem::path(name).has_parent_path())
                root.fail("has to have names of files beside this one", "files");
            s.files.push_back(name.empty() ? name : (folder / name).string());
        }
        if (s.files.size() != s.materials())
            root.fail(fmt::format("has to have {} names", s.materials()), "files");
    }
    if (static_cast<std::size_t>(texture.integer("layers", 1, 1 << 24)) != s.layers())
        texture.fail(fmt::format("has to be {}", s.layers()), "layers");
    s.source = root.word("source");
    s.generator = root.word("generator");
    return s;
}

std::string exportedTexture(const JsonFields& sidecar, std::string_view role,
                            const std::string& file) {
    for (const JsonFields& listed : sidecar.objects("files")) {
        if (listed.word("role") != role || listed.word("container") != "ktx2") continue;
        return (std::filesystem::path(file).parent_path() / listed.fileName("path")).string();
    }
    sidecar.fail(fmt::format("has no ktx2 texture of the {}; an export to ktx2 has", role),
                 "files");
}

}  // namespace hshfit::inline material_maps
