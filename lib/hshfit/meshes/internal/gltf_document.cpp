#include <hshfit/meshes/internal/gltf_document.h>

#include <hshfit/byte_cursor.h>
#include <hshfit/error.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/files/mapped_file.h>
#include <hshfit/files/printable.h>
#include <hshfit/meshes/mesh_file.h>

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <exception>
#include <filesystem>
#include <optional>

namespace hshfit::inline meshes {
namespace {

using Json = nlohmann::json;

/// Numbers of the specification (4.4).
constexpr std::uint32_t magic = 0x46546C67, jsonChunk = 0x4E4F534A;
constexpr std::size_t headBytes = 20;  // of the file and of its first chunk

constexpr int deepest = 64;

/// The text of a file, and the chunks after it in one of the binary form.
struct Parts {
    std::string_view json;
    std::optional<std::string_view> chunks = {};
};

Parts partsOf(std::string_view bytes, const std::string& path) {
    if (!bytes.starts_with("glTF")) return {bytes};
    ByteCursor cursor(bytes);
    std::uint32_t head[5] = {};
    for (std::uint32_t& word : head) {
        const auto read = cursor.number<std::uint32_t>();
        if (!read) throw InputError(fmt::format("{}: ends in its header of 20 bytes", path));
        word = *read;
    }
    const auto [name, version, length, jsonLength, chunk] = head;
    if (version != 2)
        throw InputError(fmt::format("{}: is glTF of version {}; 2 is read", path, version));
    if (length > bytes.size() || length < headBytes || jsonLength > length - headBytes) {
        throw InputError(fmt::format("{}: announces {} bytes with {} of JSON; it has {}", path,
                                     length, jsonLength, bytes.size()));
    }
    if (chunk != jsonChunk) throw InputError(fmt::format("{}: starts without JSON", path));
    return {bytes.substr(headBytes, jsonLength),
            bytes.substr(headBytes + jsonLength, length - headBytes - jsonLength)};
}

/// Extensions that a file may require: the ones that leave the places of vertices as they are, and
/// integers for vertices, which accessors tell by themselves.
bool isReadWith(std::string_view extension) {
    return extension == "KHR_mesh_quantization" || extension.starts_with("KHR_materials_") ||
           extension.starts_with("KHR_texture_") || extension.starts_with("EXT_texture_") ||
           extension == "KHR_lights_punctual";
}

/// Members that describe meshes. tinygltf takes some of another type for absent ones.
enum class MemberKind { number, numbers, word, flag };
struct Member {
    std::string_view of;
    const char* key;
    MemberKind kind = MemberKind::number;
};
constexpr Member members[] = {
    {"scenes", "nodes", MemberKind::numbers},
    {"nodes", "mesh"},
    {"nodes", "children", MemberKind::numbers},
    {"nodes", "matrix", MemberKind::numbers},
    {"nodes", "rotation", MemberKind::numbers},
    {"nodes", "scale", MemberKind::numbers},
    {"nodes", "translation", MemberKind::numbers},
    {"primitives", "indices"},
    {"primitives", "mode"},
    {"accessors", "bufferView"},
    {"accessors", "byteOffset"},
    {"accessors", "componentType"},
    {"accessors", "count"},
    {"accessors", "type", MemberKind::word},
    {"accessors", "normalized", MemberKind::flag},
    {"sparse", "count"},
    {"indices", "bufferView"},
    {"indices", "byteOffset"},
    {"indices", "componentType"},
    {"values", "bufferView"},
    {"values", "byteOffset"},
    {"bufferViews", "buffer"},
    {"bufferViews", "byteOffset"},
    {"bufferViews", "byteLength"},
    {"bufferViews", "byteStride"},
    {"buffers", "byteLength"},
    {"buffers", "uri", MemberKind::word},
};

void checkMembers(const JsonFields& object, std::string_view of) {
    for (const Member& member : members) {
        if (member.of != of || !object.has(member.key)) continue;
        if (member.kind == MemberKind::number) object.number(member.key);
        if (member.kind == MemberKind::numbers) object.numbers(member.key);
        if (member.kind == MemberKind::word) object.word(member.key);
        if (member.kind == MemberKind::flag) object.flag(member.key);
    }
}

void checkTypes(const JsonFields& root) {
    if (root.has("scene")) root.number("scene");
    const auto each = [&](const char* key) {
        std::vector<JsonFields> objects;
        if (root.has(key)) objects = root.objects(key);
        for (const JsonFields& object : objects) checkMembers(object, key);
        return objects;
    };
    for (const char* key : {"scenes", "nodes", "bufferViews", "buffers"}) each(key);
    for (const JsonFields& mesh : each("meshes")) {
        for (const JsonFields& primitive : mesh.objects("primitives")) {
            checkMembers(primitive, "primitives");
            const JsonFields attributes = primitive.object("attributes");
            for (const auto& [name, index] : attributes.json().items())
                attributes.number(name.c_str());
        }
    }
    for (const JsonFields& accessor : each("accessors")) {
        if (!accessor.has("sparse")) continue;
        const JsonFields sparse = accessor.object("sparse");
        checkMembers(sparse, "sparse");
        for (const char* key : {"indices", "values"}) checkMembers(sparse.object(key), key);
    }
}

/// The members that describe meshes, as text.
std::string meshesOf(const Parts& parts, const std::string& path) {
    Json json = parseJson(parts.json, path, deepest);
    const JsonFields root(json, "", path);
    const std::string version = root.object("asset").word("version");
    if (!version.starts_with("2."))
        root.fail(fmt::format("is '{}'; glTF 2.0 is read", version.substr(0, 20)), "asset.version");
    if (root.has("extensionsRequired")) {
        for (const std::string& extension : root.words("extensionsRequired")) {
            if (!isReadWith(extension)) {
                root.fail(fmt::format("has '{}', which is not read; save the mesh without it",
                                      printable(extension.substr(0, 60))),
                          "extensionsRequired");
            }
        }
    }
    checkTypes(root);
    Json kept = Json::object();
    for (const char* key :
         {"asset", "scene", "scenes", "nodes", "meshes", "accessors", "bufferViews", "buffers"})
        if (root.has(key)) kept[key] = std::move(json[key]);
    if (!kept.contains("buffers")) return jsonText(kept);
    // Each of them would hold a copy of the whole binary chunk.
    for (std::size_t k = parts.chunks ? 1 : 0; k < kept["buffers"].size(); ++k) {
        if (!kept["buffers"][k].contains("uri"))
            root.fail("has no 'uri'", fmt::format("buffers[{}]", k));
    }
    return jsonText(kept);
}

/// The binary form again, with other JSON.
std::string joined(std::string json, std::string_view chunks) {
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const std::uint32_t head[] = {
        magic, 2, static_cast<std::uint32_t>(headBytes + json.size() + chunks.size()),
        static_cast<std::uint32_t>(json.size()), jsonChunk};
    std::string bytes(sizeof head, '\0');
    std::memcpy(bytes.data(), head, sizeof head);
    return bytes + json + std::string(chunks);
}

/// Files of buffers, in one folder, and their bytes together at most largestMeshFile.
struct Beside {
    std::string folder;
    std::size_t left = largestMeshFile;
    std::string problem = {};
};

bool standsBeside(const std::string& name, void* beside) {
    // tinygltf looks in the current folder too. It has decoded the percent signs of the name.
    auto& [folder, left, problem] = *static_cast<Beside*>(beside);
    if (!name.starts_with(folder + "/")) return false;
    const std::filesystem::path inside = name.substr(folder.size() + 1);
    if (inside.string().find('\\') != std::string::npos ||
        std::find(inside.begin(), inside.end(), "..") != inside.end()) {
        problem = fmt::format("the file '{}' of a buffer has to lie in the folder of the glTF file",
                              printable(inside.string().substr(0, 200)));
        return false;
    }
    std::error_code error;
    return std::filesystem::is_regular_file(name, error);
}

bool readBeside(std::vector<unsigned char>* bytes, std::string*, const std::string& name,
                void* context) {
    auto& beside = *static_cast<Beside*>(context);
    try {
        const MappedFile file(name);
        if (file.size() > beside.left) {
            throw InputError(
                fmt::format("{}: its buffers have more than {} bytes", name, largestMeshFile));
        }
        beside.left -= file.size();
        bytes->assign(file.bytes().begin(), file.bytes().end());
        file.checkIntact();
        return true;
    } catch (const InputError& error) {
        beside.problem = error.what();
        return false;
    }
}

std::string unchanged(const std::string& name, void*) {
    return name;
}

}  // namespace

tinygltf::Model readGltfDocument(std::string_view bytes, const std::string& path) {
    const Parts parts = partsOf(bytes, path);
    std::string text = meshesOf(parts, path);
    const std::filesystem::path folder = std::filesystem::path(path).parent_path();
    Beside beside{.folder = folder.empty() ? "." : folder.string()};
    tinygltf::TinyGLTF reader;
    reader.SetFsCallbacks({.FileExists = standsBeside,
                           .ExpandFilePath = unchanged,
                           .ReadWholeFile = readBeside,
                           .WriteWholeFile = nullptr,
                           .user_data = &beside});
    tinygltf::Model model;
    std::string problem, remarks;
    bool good = false;
    try {
        if (parts.chunks) {
            text = joined(std::move(text), *parts.chunks);
            good = reader.LoadBinaryFromMemory(&model, &problem, &remarks,
                                               reinterpret_cast<const unsigned char*>(text.data()),
                                               static_cast<unsigned>(text.size()), beside.folder);
        } else {
            good = reader.LoadASCIIFromString(&model, &problem, &remarks, text.data(),
                                              static_cast<unsigned>(text.size()), beside.folder);
        }
    } catch (const std::exception& error) {
        problem = error.what();
        good = false;
    }
    if (good && problem.empty()) return model;
    if (!beside.problem.empty()) throw InputError(fmt::format("{}: {}", path, beside.problem));
    std::ranges::replace(problem, '\n', ' ');
    throw InputError(
        fmt::format("{}: is no valid glTF: {}", path, printable(problem.substr(0, 200))));
}

}  // namespace hshfit::inline meshes
