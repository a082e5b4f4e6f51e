#include <hshfit/meshes/internal/mesh_readers.h>

#include <hshfit/byte_cursor.h>
#include <hshfit/error.h>
#include <hshfit/meshes/internal/polygon.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>

// The polygon file format (Turk 1994). The importer of assimp, in the version of Debian 12, has a
// reported heap overflow (CVE-2024-40724).

namespace hshfit::inline meshes {
namespace {

enum class Encoding { ascii, little, big };

struct Type {
    std::string_view name, alias;
    std::size_t bytes;
    bool real = false, isSigned = false;
};
constexpr Type types[] = {
    {"char", "int8", 1, false, true},    {"uchar", "uint8", 1},
    {"short", "int16", 2, false, true},  {"ushort", "uint16", 2},
    {"int", "int32", 4, false, true},    {"uint", "uint32", 4},
    {"float", "float32", 4, true, true}, {"double", "float64", 8, true, true},
};

struct Property {
    std::string name;
    const Type* type = nullptr;
    const Type* count = nullptr;  ///< of a list
};

struct Element {
    std::string name;
    std::size_t count = 0;
    std::vector<Property> properties;
};

/// Most properties that elements of a file have, and most corners of a polygon.
constexpr std::size_t mostProperties = 256;
constexpr double mostCorners = 65536;
/// Most indices of one list of triangle strips, which holds whole meshes.
constexpr std::int32_t largestList = 1 << 30;

class PlyReader {
public:
    PlyReader(std::string_view bytes, const std::string& path) : cursor_(bytes), path_(path) {}

    Mesh read() {
        readHeader();
        for (const Element& element : elements_) {
            for (std::size_t k = 0; k < element.count; ++k) {
                where_ = fmt::format("element {} {}", element.name, k);
                readElement(element, k);
            }
        }
        cutPolygons();
        if (vertexNormals_.empty()) return std::move(mesh_);
        for (const auto& triangle : mesh_.triangles) {
            for (const std::uint32_t v : triangle) mesh_.normals.push_back(vertexNormals_[v]);
        }
        return std::move(mesh_);
    }

private:
    [[noreturn]] void fail(std::string_view reason) const {
        throw InputError(fmt::format("{}: {}: {}", path_, where_, reason));
    }

    // --- header -----------------------------------------------------------------------------

    /// A line without its end, as words.
    std::vector<std::string> headerLine() {
        std::string line;
        while (true) {
            const auto c = cursor_.take(1);
            if (!c) fail("the file ends in its header, before 'end_header'");
            if (*c == "\n") break;
            if (*c != "\r") line += *c;
            if (line.size() > 4096) fail("a line is longer than 4096 characters");
        }
        ++line_;
        where_ = fmt::format("line {} of the header", line_);
        std::vector<std::string> words;
        for (std::size_t at = line.find_first_not_of(" \t"); at != std::string::npos;) {
            const std::size_t end = std::min(line.find_first_of(" \t", at), line.size());
            words.push_back(line.substr(at, end - at));
            at = line.find_first_not_of(" \t", end);
        }
        return words;
    }

    const Type* typeOf(const std::string& word) const {
        for (const Type& type : types) {
            if (word == type.name || word == type.alias) return &type;
        }
        fail(fmt::format("'{}' is no type of PLY files", word.substr(0, 40)));
    }

    void readHeader() {
        where_ = "header";
        headerLine();
        bool format = false;
        for (auto words = headerLine(); words != std::vector<std::string>{"end_header"};
             words = headerLine()) {
            if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
            if (words[0] == "format" && words.size() >= 2) {
                format = true;
                setEncoding(words[1]);
            } else if (words[0] == "element" && words.size() == 3) {
                addElement(words);
            } else if (words[0] == "property" && !elements_.empty()) {
                addProperty(words);
            } else {
                fail(
                    fmt::format("'{}' is not understood; format, element, property, comment and "
                                "end_header are",
                                words[0].substr(0, 40)));
            }
        }
        if (!format) fail("there is no line 'format'");
        checkElements();
    }

    void setEncoding(const std::string& word) {
        if (word == "ascii")
            encoding_ = Encoding::ascii;
        else if (word == "binary_little_endian")
            encoding_ = Encoding::little;
        else if (word == "binary_big_endian")
            encoding_ = Encoding::big;
        else
            fail(fmt::format("format '{}'; known: ascii, binary_little_endian, binary_big_endian",
                             word.substr(0, 40)));
    }

    void addElement(const std::vector<std::string>& words) {
        Element element{.name = words[1], .properties = {}};
        const char* end = words[2].data() + words[2].size();
        const auto [next, error] = std::from_chars(words[2].data(), end, element.count);
        if (error != std::errc() || next != end) fail("the number of an element is no number");
        for (const Element& other : elements_) {
            if (other.name == element.name) fail("an element is there twice");
        }
        elements_.push_back(std::move(element));
    }

    void addProperty(const std::vector<std::string>& words) {
        auto& properties = elements_.back().properties;
        if (properties.size() == mostProperties) fail("an element has too many properties");
        if (words.size() == 5 && words[1] == "list") {
            properties.push_back({words[4], typeOf(words[3]), typeOf(words[2])});
            if (properties.back().count->real) fail("the length of a list has to be an integer");
            if (isPolygon(properties.back()) && properties.back().type->real)
                fail("the indices of vertices have to be integers");
        } else if (words.size() == 3) {
            properties.push_back({words[2], typeOf(words[1])});
        } else {
            fail("a property is 'property TYPE NAME' or 'property list TYPE TYPE NAME'");
        }
    }

    /// Counts that the rest of the file cannot hold are refused before anything is made of them:
    /// each property takes a byte at least.
    void checkElements() {
        where_ = "header";
        for (const Element& element : elements_) {
            if (element.properties.empty() && element.count > 0)
                fail(fmt::format("element {} has no property", element.name));
            if (element.count > cursor_.left()) {
                fail(fmt::format("{} of element {} are announced; {} bytes are left", element.count,
                                 element.name, cursor_.left()));
            }
        }
        const auto* vertex = find("vertex");
        if (!vertex || !hasAll(*vertex, {"x", "y", "z"}))
            fail("there is no element vertex with x, y and z");
        if (vertex->count > std::numeric_limits<std::uint32_t>::max())
            fail("there are more than 2^32 vertices");
        vertices_ = vertex->count;
        mesh_.positions.resize(vertices_);
        if (hasAll(*vertex, {"nx", "ny", "nz"})) vertexNormals_.resize(vertices_);
    }

    const Element* find(std::string_view name) const {
        const auto at = std::ranges::find(elements_, name, &Element::name);
        return at == elements_.end() ? nullptr : &*at;
    }
    static bool isPolygon(const Property& property) {
        return property.name == "vertex_indices" || property.name == "vertex_index";
    }
    static bool hasAll(const Element& element, std::initializer_list<std::string_view> names) {
        return std::ranges::all_of(names, [&](std::string_view name) {
            return std::ranges::any_of(element.properties, [&](const Property& property) {
                return property.name == name && !property.count;
            });
        });
    }

    // --- values -----------------------------------------------------------------------------

    double asciiNumber(const Type& type) {
        while (cursor_.startsWith(' ') || cursor_.startsWith('\n') || cursor_.startsWith('\t') ||
               cursor_.startsWith('\r')) {
            cursor_.take(1);
        }
        char word[64];
        std::size_t length = 0;
        for (auto c = cursor_.take(1); c; c = cursor_.take(1)) {
            if (*c == " " || *c == "\n" || *c == "\t" || *c == "\r") break;
            if (length == sizeof word) fail("a number is longer than 64 characters");
            word[length++] = c->front();
        }
        if (length == 0) fail("the file ends here");
        const char* begin = word[0] == '+' ? word + 1 : word;
        double value = 0;
        const auto [next, error] = std::from_chars(begin, word + length, value);
        if (error == std::errc::result_out_of_range) return value;
        if (error != std::errc() || next != word + length)
            fail(fmt::format("'{}' is no number", std::string_view(word, length)));
        if (!type.real && !holds(type, value))
            fail(fmt::format("'{}' is no {}", std::string_view(word, length), type.name));
        return value;
    }

    static bool holds(const Type& integer, double value) {
        const double codes = std::ldexp(1.0, 8 * static_cast<int>(integer.bytes));
        const double least = integer.isSigned ? -codes / 2 : 0;
        return value >= least && value < least + codes && value == std::floor(value);
    }

    double binaryNumber(const Type& type) {
        const auto raw = cursor_.take(type.bytes);
        if (!raw) fail("the file ends here");
        std::array<char, 8> bytes{};
        std::copy(raw->begin(), raw->end(), bytes.begin());
        const bool swapped =
            (encoding_ == Encoding::big) == (std::endian::native == std::endian::little);
        if (swapped) std::reverse(bytes.begin(), bytes.begin() + static_cast<int>(type.bytes));
        const auto as = [&]<class Number>(Number value) {
            std::memcpy(&value, bytes.data(), sizeof value);
            return static_cast<double>(value);
        };
        if (type.real) return type.bytes == 4 ? as(float{}) : as(double{});
        if (type.bytes == 1) return type.isSigned ? as(std::int8_t{}) : as(std::uint8_t{});
        if (type.bytes == 2) return type.isSigned ? as(std::int16_t{}) : as(std::uint16_t{});
        return type.isSigned ? as(std::int32_t{}) : as(std::uint32_t{});
    }

    double number(const Type& type) {
        return encoding_ == Encoding::ascii ? asciiNumber(type) : binaryNumber(type);
    }

    // --- elements ---------------------------------------------------------------------------

    void readElement(const Element& element, std::size_t k) {
        const bool vertex = element.name == "vertex", face = element.name == "face",
                   strip = element.name == "tristrips";
        for (const Property& property : element.properties) {
            if (!property.count) {
                const double value = number(*property.type);
                if (vertex) setVertex(property.name, k, static_cast<float>(value));
                continue;
            }
            const double count = number(*property.count);
            const double most = strip ? static_cast<double>(largestList) : mostCorners;
            if (!(count >= 0 && count <= most))
                fail(fmt::format("a list of {} values; at most {} are read", count, most));
            const bool indices = isPolygon(property);
            if (face && indices) {
                polygons_.push_back({k, corners_.size()});
                readIndices(property, count, [&](std::uint32_t v) { corners_.push_back(v); });
            } else if (strip && indices) {
                readStrips(property, count);
            } else {
                for (int corner = 0; corner < count; ++corner) number(*property.type);
            }
        }
    }

    /// Calls `take` with each index of a list, and `restart` where it is below 0.
    template <class Take, class Restart>
    void readIndices(const Property& property, double count, Take take, Restart restart) {
        for (int corner = 0; corner < count; ++corner) {
            const double value = number(*property.type);
            if (value < 0 && restart()) continue;
            if (!(value >= 0 && value < static_cast<double>(vertices_)))
                fail(fmt::format("vertex {}; there are {}, from 0 on", value, vertices_));
            take(static_cast<std::uint32_t>(value));
        }
    }
    template <class Take>
    void readIndices(const Property& property, double count, Take take) {
        readIndices(property, count, take, [] { return false; });
    }

    /// Triangles of neighbouring indices, of which every second one is turned; an index below 0
    /// begins a new strip.
    void readStrips(const Property& property, double count) {
        std::array<std::uint32_t, 2> last{};
        std::size_t length = 0;
        readIndices(
            property, count,
            [&](std::uint32_t v) {
                if (length >= 2) {
                    const bool turned = length % 2 == 1;
                    mesh_.triangles.push_back({last[turned ? 1 : 0], last[turned ? 0 : 1], v});
                }
                last = {last[1], v};
                ++length;
            },
            [&] {
                length = 0;
                return true;
            });
    }

    /// Faces may come before the vertices that they name, and are cut at the end.
    void cutPolygons() {
        std::vector<MeshVector> outline;
        std::vector<std::array<std::uint32_t, 3>> cut;
        for (std::size_t p = 0; p < polygons_.size(); ++p) {
            const std::size_t first = polygons_[p].firstCorner;
            const std::size_t last =
                p + 1 < polygons_.size() ? polygons_[p + 1].firstCorner : corners_.size();
            where_ = fmt::format("element face {}", polygons_[p].face);
            if (last - first < 3)
                fail(fmt::format("{} corners, expected three or more", last - first));
            outline.clear();
            cut.clear();
            for (std::size_t k = first; k < last; ++k)
                outline.push_back(mesh_.positions[corners_[k]]);
            if (!cutPolygon(outline, cut))
                fail(fmt::format("{} corners of a polygon that is not convex; at most {} are cut",
                                 last - first, mostEars));
            for (const auto& triangle : cut)
                mesh_.triangles.push_back({corners_[first + triangle[0]],
                                           corners_[first + triangle[1]],
                                           corners_[first + triangle[2]]});
        }
    }

    void setVertex(std::string_view name, std::size_t k, float value) {
        for (std::size_t i = 0; i < 3; ++i) {
            constexpr std::string_view positions[] = {"x", "y", "z"},
                                       normals[] = {"nx", "ny", "nz"};
            if (name == positions[i]) mesh_.positions[k][i] = value;
            if (name == normals[i] && !vertexNormals_.empty()) vertexNormals_[k][i] = value;
        }
    }

    ByteCursor cursor_;
    const std::string& path_;
    std::string where_;
    std::size_t line_ = 0, vertices_ = 0;
    Encoding encoding_ = Encoding::ascii;
    std::vector<Element> elements_;
    struct Polygon {
        std::size_t face, firstCorner;
    };
    std::vector<Polygon> polygons_;
    std::vector<std::uint32_t> corners_;
    std::vector<MeshVector> vertexNormals_;
    Mesh mesh_;
};

}  // namespace

Mesh readPly(std::string_view bytes, const std::string& path) {
    return PlyReader(bytes, path).read();
}

}  // namespace hshfit::inline meshes
