#include <hshfit/meshes/internal/gltf_document.h>
#include <hshfit/meshes/internal/mesh_readers.h>

#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace hshfit::inline meshes {
namespace {

/// Most triangles, and most vertices: a few bytes of nodes can repeat a mesh as often as they like.
constexpr std::size_t mostOfAMesh = std::size_t{1} << 26;

/// Rows of the upper three of a 4 x 4 matrix.
using Matrix = std::array<std::array<double, 4>, 3>;
constexpr Matrix identity{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

Matrix product(const Matrix& a, const Matrix& b) {
    Matrix c{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 4; ++j) {
            c[i][j] = j == 3 ? a[i][3] : 0;
            for (std::size_t k = 0; k < 3; ++k) c[i][j] += a[i][k] * b[k][j];
        }
    }
    return c;
}

/// The cofactors of the linear part: the inverse transposed, times the determinant.
Matrix cofactors(const Matrix& m) {
    Matrix c{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            const std::size_t i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3,
                              j2 = (j + 2) % 3;
            c[i][j] = m[i1][j1] * m[i2][j2] - m[i1][j2] * m[i2][j1];
        }
    }
    return c;
}

/// The size of a component, 0 for types that vertices and indices do not have.
std::size_t bytesOf(int componentType) {
    switch (componentType) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return 1;
        case TINYGLTF_COMPONENT_TYPE_SHORT:
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return 2;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        case TINYGLTF_COMPONENT_TYPE_FLOAT:
            return 4;
        default:
            return 0;
    }
}

template <class Number>
Number numberAt(const unsigned char* bytes) {
    Number value;
    std::memcpy(&value, bytes, sizeof value);
    return value;
}

/// A component by its type (3.6.2.2), normalised to [-1, 1] or [0, 1] where asked.
double component(const unsigned char* bytes, int type, bool normalised) {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE: {
            const double c = numberAt<std::int8_t>(bytes);
            return normalised ? std::max(c / 127, -1.0) : c;
        }
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return *bytes / (normalised ? 255.0 : 1.0);
        case TINYGLTF_COMPONENT_TYPE_SHORT: {
            const double c = numberAt<std::int16_t>(bytes);
            return normalised ? std::max(c / 32767, -1.0) : c;
        }
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return numberAt<std::uint16_t>(bytes) / (normalised ? 65535.0 : 1.0);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
            return numberAt<std::uint32_t>(bytes);
        default:
            return double{numberAt<float>(bytes)};
    }
}

class GltfReader {
public:
    GltfReader(const tinygltf::Model& model, const std::string& path)
        : model_(model), path_(path), visited_(model.nodes.size()) {
        for (const tinygltf::Buffer& buffer : model.buffers) bytes_ += buffer.data.size();
    }

    Mesh read() {
        if (model_.scenes.empty()) {
            readWithoutScene();
            return std::move(mesh_);
        }
        const int scene = std::max(model_.defaultScene, 0);
        for (const int node : at(model_.scenes, scene, "scene").nodes) visit(node);
        return std::move(mesh_);
    }

private:
    [[noreturn]] void fail(std::string_view reason) const {
        throw InputError(fmt::format("{}: {}{}", path_, where_, reason));
    }
    template <class Item>
    const Item& at(const std::vector<Item>& items, int index, std::string_view noun) const {
        if (index < 0 || static_cast<std::size_t>(index) >= items.size())
            fail(fmt::format("names {} {}; there are {}", noun, index, items.size()));
        return items[static_cast<std::size_t>(index)];
    }

    // --- accessors --------------------------------------------------------------------------

    struct Range {
        const unsigned char* first = nullptr;
        std::size_t bytes = 0;
    };
    /// The bytes of a view, after an offset.
    Range viewed(int view, std::size_t offset) const {
        const tinygltf::BufferView& found = at(model_.bufferViews, view, "bufferView");
        const auto& data = at(model_.buffers, found.buffer, "buffer").data;
        if (found.byteOffset > data.size() || found.byteLength > data.size() - found.byteOffset)
            fail(
                fmt::format("bufferView {} ends beyond its buffer of {} bytes", view, data.size()));
        if (offset > found.byteLength)
            fail(fmt::format("starts beyond bufferView {} of {} bytes", view, found.byteLength));
        return {data.data() + found.byteOffset + offset, found.byteLength - offset};
    }
    void requireRoom(const Range& range, std::size_t count, std::size_t stride,
                     std::size_t size) const {
        if (count == 0) return;
        if (range.bytes < size || (count - 1) > (range.bytes - size) / stride) {
            fail(fmt::format("has {} values of {} bytes; {} bytes are left of its bufferView",
                             count, size, range.bytes));
        }
    }

    /// All numbers of an accessor of `type`, with sparse values in their place (3.6.2.3).
    std::vector<double> numbers(int index, int type, std::string_view noun) {
        const tinygltf::Accessor& accessor = at(model_.accessors, index, "accessor");
        const std::string outer = where_;
        where_ += fmt::format("accessor {}, {}: ", index, noun);
        const auto width = static_cast<std::size_t>(type == TINYGLTF_TYPE_VEC3 ? 3 : 1);
        const std::size_t size = width * bytesOf(accessor.componentType);
        if (accessor.type != type || size == 0)
            fail("has a type that does not fit; VEC3 and SCALAR of the standard types do");
        // Each has bytes of its own but for values of 0 that are left out.
        if (accessor.count > std::min(bytes_, 3 * mostOfAMesh)) {
            fail(fmt::format("has {} values; its buffers have {} bytes, and {} values are read",
                             accessor.count, bytes_, 3 * mostOfAMesh));
        }
        std::vector<double> result(width * accessor.count);
        const auto decode = [&](const unsigned char* from, std::size_t to) {
            for (std::size_t k = 0; k < width; ++k)
                result[width * to + k] = component(from + k * (size / width),
                                                   accessor.componentType, accessor.normalized);
        };
        if (accessor.bufferView >= 0) {
            const Range range = viewed(accessor.bufferView, accessor.byteOffset);
            const std::size_t given = at(model_.bufferViews, accessor.bufferView, "").byteStride;
            const std::size_t stride = given == 0 ? size : given;
            requireRoom(range, accessor.count, stride, size);
            for (std::size_t k = 0; k < accessor.count; ++k) decode(range.first + k * stride, k);
        }
        if (accessor.sparse.isSparse) {
            const auto& sparse = accessor.sparse;
            const std::size_t width1 = bytesOf(sparse.indices.componentType);
            if (sparse.count < 0 || sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0 ||
                width1 == 0)
                fail("has sparse values that cannot be read");
            const auto count = static_cast<std::size_t>(sparse.count);
            const Range places = viewed(sparse.indices.bufferView,
                                        static_cast<std::size_t>(sparse.indices.byteOffset));
            const Range values = viewed(sparse.values.bufferView,
                                        static_cast<std::size_t>(sparse.values.byteOffset));
            requireRoom(places, count, width1, width1);
            requireRoom(values, count, size, size);
            for (std::size_t k = 0; k < count; ++k) {
                const double place =
                    component(places.first + k * width1, sparse.indices.componentType, false);
                if (!(place >= 0 && place < static_cast<double>(accessor.count)))
                    fail(fmt::format("has a sparse value {} of {}", place, accessor.count));
                decode(values.first + k * size, static_cast<std::size_t>(place));
            }
        }
        where_ = outer;
        return result;
    }

    // --- nodes ------------------------------------------------------------------------------

    /// All nodes that are nobody's child; without nodes, all meshes.
    void readWithoutScene() {
        std::vector<bool> isChild(model_.nodes.size());
        for (const tinygltf::Node& node : model_.nodes) {
            for (const int child : node.children) {
                at(model_.nodes, child, "node");
                isChild[static_cast<std::size_t>(child)] = true;
            }
        }
        for (std::size_t k = 0; k < isChild.size(); ++k)
            if (!isChild[k]) visit(static_cast<int>(k));
        if (model_.nodes.empty())
            for (std::size_t k = 0; k < model_.meshes.size(); ++k)
                add(static_cast<int>(k), identity);
    }

    /// A node and the nodes below it, without recursion: a chain may be long.
    void visit(int root) {
        std::vector<std::pair<int, Matrix>> waiting{{root, identity}};
        while (!waiting.empty()) {
            const auto [index, above] = waiting.back();
            waiting.pop_back();
            where_ = {};
            const tinygltf::Node& node = at(model_.nodes, index, "node");
            where_ = fmt::format("node {}: ", index);
            if (visited_[static_cast<std::size_t>(index)]) fail("is in the tree of nodes twice");
            visited_[static_cast<std::size_t>(index)] = true;
            const Matrix here = product(above, localOf(node));
            if (node.mesh >= 0) add(node.mesh, here);
            for (auto child = node.children.rbegin(); child != node.children.rend(); ++child)
                waiting.emplace_back(*child, here);
        }
    }

    Matrix localOf(const tinygltf::Node& node) const {
        const auto has = [&](const std::vector<double>& numbers, std::size_t count,
                             std::string_view key) {
            if (!numbers.empty() && numbers.size() != count)
                fail(fmt::format("'{}' has {} numbers; it takes {}", key, numbers.size(), count));
            return !numbers.empty();
        };
        Matrix m = identity;
        if (has(node.matrix, 16, "matrix")) {
            for (std::size_t i = 0; i < 3; ++i)
                for (std::size_t j = 0; j < 4; ++j) m[i][j] = node.matrix[4 * j + i];
            return m;
        }
        if (has(node.rotation, 4, "rotation")) {
            const double length = std::hypot(std::hypot(node.rotation[0], node.rotation[1]),
                                             node.rotation[2], node.rotation[3]);
            if (!(length > 0)) fail("'rotation' is 0; it has to be a unit quaternion");
            const double x = node.rotation[0] / length, y = node.rotation[1] / length,
                         z = node.rotation[2] / length, w = node.rotation[3] / length;
            m = {{{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), 0},
                  {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), 0},
                  {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), 0}}};
        }
        if (has(node.scale, 3, "scale"))
            for (auto& row : m)
                for (std::size_t j = 0; j < 3; ++j) row[j] *= node.scale[j];
        if (has(node.translation, 3, "translation"))
            for (std::size_t i = 0; i < 3; ++i) m[i][3] = node.translation[i];
        return m;
    }

    // --- meshes -----------------------------------------------------------------------------

    void add(int index, const Matrix& matrix) {
        const std::string outer = where_;
        const tinygltf::Mesh& mesh = at(model_.meshes, index, "mesh");
        for (std::size_t k = 0; k < mesh.primitives.size(); ++k) {
            where_ = fmt::format("{}mesh {}, primitive {}: ", outer, index, k);
            addPrimitive(mesh.primitives[k], matrix);
        }
        where_ = outer;
    }

    void addPrimitive(const tinygltf::Primitive& primitive, const Matrix& matrix) {
        const int mode = primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
        if (mode > TINYGLTF_MODE_TRIANGLE_FAN) fail(fmt::format("has the mode {}", mode));
        const auto position = primitive.attributes.find("POSITION");
        // Points and lines have no area.
        if (mode < TINYGLTF_MODE_TRIANGLES || position == primitive.attributes.end()) return;
        const auto positions = numbers(position->second, TINYGLTF_TYPE_VEC3, "POSITION");
        const std::size_t vertices = positions.size() / 3;
        std::vector<double> normals;
        if (const auto found = primitive.attributes.find("NORMAL");
            found != primitive.attributes.end()) {
            normals = numbers(found->second, TINYGLTF_TYPE_VEC3, "NORMAL");
            if (normals.size() != positions.size())
                fail(fmt::format("has {} normals of {} vertices", normals.size() / 3, vertices));
        }
        const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
        if (vertices > mostOfAMesh - mesh_.positions.size())
            fail(fmt::format("there are more than {} vertices", mostOfAMesh));
        for (std::size_t v = 0; v < vertices; ++v)
            mesh_.positions.push_back(placed(matrix, positions.data() + 3 * v, 1));

        const Matrix turned = cofactors(matrix);
        const double determinant =
            matrix[0][0] * turned[0][0] + matrix[0][1] * turned[0][1] + matrix[0][2] * turned[0][2];
        const bool mirrored = determinant < 0;
        const auto normalAt = [&](std::size_t v) -> MeshVector {
            if (normals.empty()) return {};
            std::array<double, 3> sum{};
            for (std::size_t i = 0; i < 3; ++i)
                for (std::size_t j = 0; j < 3; ++j)
                    sum[i] += (mirrored ? -1 : 1) * turned[i][j] * normals[3 * v + j];
            const double length = std::hypot(sum[0], sum[1], sum[2]);
            if (length == 0) return {};
            return {static_cast<float>(sum[0] / length), static_cast<float>(sum[1] / length),
                    static_cast<float>(sum[2] / length)};
        };
        const std::vector<std::uint32_t> corners = cornersOf(primitive, mode, vertices);
        if (corners.size() / 3 > mostOfAMesh - mesh_.triangles.size())
            fail(fmt::format("there are more than {} triangles", mostOfAMesh));
        for (std::size_t k = 0; k + 2 < corners.size(); k += 3) {
            std::array<std::uint32_t, 3> t{corners[k], corners[k + 1], corners[k + 2]};
            if (mirrored) std::swap(t[1], t[2]);
            for (std::uint32_t& v : t) {
                mesh_.normals.push_back(normalAt(v));
                v += first;
            }
            mesh_.triangles.push_back(t);
        }
    }

    static MeshVector placed(const Matrix& m, const double* v, double w) {
        MeshVector result{};
        for (std::size_t i = 0; i < 3; ++i)
            result[i] =
                static_cast<float>(m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2] + w * m[i][3]);
        return result;
    }

    /// Three vertices of each triangle (3.7.2.1).
    std::vector<std::uint32_t> cornersOf(const tinygltf::Primitive& primitive, int mode,
                                         std::size_t vertices) {
        std::vector<std::uint32_t> order;
        if (primitive.indices < 0) {
            for (std::size_t v = 0; v < vertices; ++v)
                order.push_back(static_cast<std::uint32_t>(v));
        } else {
            for (const double v : numbers(primitive.indices, TINYGLTF_TYPE_SCALAR, "indices")) {
                if (!(v >= 0 && v < static_cast<double>(vertices)))
                    fail(fmt::format("names vertex {}; there are {}, from 0 on", v, vertices));
                order.push_back(static_cast<std::uint32_t>(v));
            }
        }
        if (mode == TINYGLTF_MODE_TRIANGLES) return order;
        std::vector<std::uint32_t> corners;
        for (std::size_t k = 0; k + 2 < order.size(); ++k) {
            const bool fan = mode == TINYGLTF_MODE_TRIANGLE_FAN;
            // Every other triangle of a strip runs the other way.
            const std::size_t a = fan ? k + 1 : k + k % 2, b = fan ? k + 2 : k + 1 - k % 2;
            if (fan)
                corners.insert(corners.end(), {order[a], order[b], order[0]});
            else
                corners.insert(corners.end(), {order[a], order[b], order[k + 2]});
        }
        return corners;
    }

    const tinygltf::Model& model_;
    const std::string& path_;
    std::string where_;
    std::vector<bool> visited_;
    std::size_t bytes_ = 0;  ///< of all buffers
    Mesh mesh_;
};

}  // namespace

Mesh readGltf(std::string_view bytes, const std::string& path) {
    const tinygltf::Model model = readGltfDocument(bytes, path);
    return GltfReader(model, path).read();
}

}  // namespace hshfit::inline meshes
