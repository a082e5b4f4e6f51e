#include <hshfit/meshes/internal/mesh_readers.h>

#include <hshfit/error.h>

#include <fmt/format.h>
#include <tiny_obj_loader.h>

#include <algorithm>
#include <charconv>

namespace hshfit::inline meshes {
namespace {

constexpr std::string_view blanks = " \t\r";

bool isNumber(std::string_view word) {
    if (word.find_first_not_of("0123456789+-.eE") != std::string_view::npos) return false;
    word.remove_prefix(word.starts_with('+') ? 1 : 0);
    double value = 0;
    return std::from_chars(word.data(), word.data() + word.size(), value).ptr ==
               word.data() + word.size() &&
           !word.empty();
}

/// Whether a word is VERTEX, VERTEX/TEXTURE, VERTEX//NORMAL or VERTEX/TEXTURE/NORMAL.
bool isCorner(std::string_view word) {
    for (int part = 0; part < 3; ++part) {
        int index = 0;
        const char* end = word.data() + word.size();
        const auto [next, error] = std::from_chars(word.data(), end, index);
        const bool left = part == 1 && word.starts_with('/');
        if (error != std::errc() && !left) return false;
        word.remove_prefix(left ? 0 : static_cast<std::size_t>(next - word.data()));
        if (word.empty()) return true;
        if (!word.starts_with('/')) return false;
        word.remove_prefix(1);
    }
    return false;
}

struct Statement {
    std::string_view keyword;
    bool (*holds)(std::string_view word);
    std::string_view takes;
};
constexpr Statement statements[] = {{"v", isNumber, "numbers, x y z"},
                                    {"vn", isNumber, "numbers, x y z"},
                                    {"f", isCorner, "corners, as 1, 1/2, 1//3 or 1/2/3"}};

/// tinyobjloader cuts triangles off a polygon in a time that grows with the square of its corners,
/// 1 s for 8,000 of them: squares of polygons beyond `manyCorners` are summed and bounded.
constexpr std::size_t manyCorners = 256, mostSquared = std::size_t{1} << 26;

/// tinyobjloader reads a word that is no number as 0 and 1.9 as the index 1, so that words are
/// checked before it.
void checkNumbers(std::string_view text, const std::string& path) {
    std::size_t squared = 0;
    for (std::size_t number = 1; !text.empty(); ++number) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        const std::string_view line = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        std::size_t at = std::min(line.find_first_not_of(blanks), line.size());
        const std::size_t wordEnd = std::min(line.find_first_of(blanks, at), line.size());
        const std::string_view keyword = line.substr(at, wordEnd - at);
        const auto* statement = std::ranges::find(statements, keyword, &Statement::keyword);
        if (statement == std::end(statements)) continue;
        std::size_t count = 0;
        for (at = wordEnd; at < line.size(); ++count) {
            at = line.find_first_not_of(blanks, at);
            if (at == std::string_view::npos) break;
            const std::size_t last = std::min(line.find_first_of(blanks, at), line.size());
            const std::string_view word = line.substr(at, last - at);
            if (word.front() == '#') break;
            if (!statement->holds(word)) {
                throw InputError(fmt::format("{}: line {}: '{}' is read; '{}' takes three {}", path,
                                             number, word.substr(0, 40), keyword,
                                             statement->takes));
            }
            at = last;
        }
        if (count < 3) {
            throw InputError(fmt::format("{}: line {}: '{}' has {} words; it takes three {}", path,
                                         number, keyword, count, statement->takes));
        }
        if (keyword != "f" || count <= manyCorners) continue;
        squared += count * count;
        if (squared > mostSquared) {
            throw InputError(
                fmt::format("{}: line {}: faces of {} corners take too long to cut into "
                            "triangles; cut them before, one of 8192 is read",
                            path, number, count));
        }
    }
}

template <class Number>
MeshVector vectorAt(const std::vector<Number>& numbers, int index) {
    const auto at = 3 * static_cast<std::size_t>(index);
    return {static_cast<float>(numbers[at]), static_cast<float>(numbers[at + 1]),
            static_cast<float>(numbers[at + 2])};
}

}  // namespace

Mesh readObj(std::string_view text, const std::string& path) {
    if (text.find('\0') != std::string_view::npos) {
        throw InputError(
            fmt::format("{}: is neither a PLY file nor text, as a Wavefront OBJ file", path));
    }
    checkNumbers(text, path);
    tinyobj::ObjReaderConfig config;
    config.triangulate = true;
    config.vertex_color = false;
    tinyobj::ObjReader reader;
    if (!reader.ParseFromString(std::string(text), "", config)) {
        std::string reason = reader.Error();
        std::ranges::replace(reason, '\n', ' ');
        throw InputError(fmt::format("{}: is no Wavefront OBJ file: {}", path,
                                     reason.empty() ? "it cannot be read" : reason));
    }
    const tinyobj::attrib_t& attributes = reader.GetAttrib();
    Mesh mesh;
    const auto vertices = static_cast<int>(attributes.vertices.size() / 3);
    const auto normals = static_cast<int>(attributes.normals.size() / 3);
    for (int v = 0; v < vertices; ++v) mesh.positions.push_back(vectorAt(attributes.vertices, v));
    for (const tinyobj::shape_t& shape : reader.GetShapes()) {
        const auto& indices = shape.mesh.indices;
        for (std::size_t k = 0; k + 2 < indices.size(); k += 3) {
            std::array<std::uint32_t, 3> triangle{};
            for (std::size_t corner = 0; corner < 3; ++corner) {
                const tinyobj::index_t& index = indices[k + corner];
                if (index.vertex_index < 0 || index.vertex_index >= vertices ||
                    index.normal_index >= normals) {
                    throw InputError(fmt::format(
                        "{}: face {} names vertex {} and normal {}; there are {} and {}", path,
                        mesh.triangles.size(), index.vertex_index + 1, index.normal_index + 1,
                        vertices, normals));
                }
                triangle[corner] = static_cast<std::uint32_t>(index.vertex_index);
                mesh.normals.push_back(index.normal_index < 0
                                           ? MeshVector{}
                                           : vectorAt(attributes.normals, index.normal_index));
            }
            mesh.triangles.push_back(triangle);
        }
    }
    return mesh;
}

}  // namespace hshfit::inline meshes
