#include <hshfit/meshes/internal/mesh_readers.h>

#include <hshfit/error.h>
#include <hshfit/meshes/internal/polygon.h>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <span>

// Wavefront's text format, of which v, vn and f count (and fo, the older word for f).

namespace hshfit::inline meshes {
namespace {

constexpr std::string_view blanks = " \t\r\v\f";

/// Ears are cut in a time that grows with the square of the corners: squares of polygons beyond
/// `manyCorners` are summed and bounded.
constexpr std::size_t manyCorners = 256, mostSquared = std::size_t{1} << 26;

/// Corners as the file has them, from 1 or, below 0, from the last one before the face.
struct ObjCorner {
    std::int64_t vertex = 0, normal = 0;  ///< 0: no normal
};

class ObjReader {
public:
    ObjReader(std::string_view text, const std::string& path) : text_(text), path_(path) {}

    Mesh read() {
        while (nextLine()) {
            if (words_.empty()) continue;
            const std::string_view keyword = words_.front();
            if (keyword == "v") {
                mesh_.positions.push_back(vector(keyword));
            } else if (keyword == "vn") {
                normals_.push_back(vector(keyword));
            } else if (keyword == "f" || keyword == "fo") {
                readFace();
            }
        }
        // Vertices may come after the faces that name them.
        for (const Face& face : faces_) addFace(face);
        return std::move(mesh_);
    }

private:
    struct Face {
        std::size_t line = 0, first = 0, count = 0;  ///< among corners_
    };

    [[noreturn]] void fail(const std::string& reason) const {
        throw InputError(fmt::format("{}: line {}: {}", path_, line_, reason));
    }

    /// The words of the next statement. A backslash at the end of a line, with blanks behind it or
    /// not, continues the statement in the next line, in a word of its own.
    bool nextLine() {
        if (text_.empty()) return false;
        words_.clear();
        line_ = nextNumber_;
        bool remark = false;
        for (bool more = true; more;) {
            const std::size_t end = std::min(text_.find_first_of("\n\r"), text_.size());
            std::string_view line = text_.substr(0, end);
            const bool both = text_.substr(end).starts_with("\r\n");
            text_.remove_prefix(std::min(end + (both ? 2 : 1), text_.size()));
            ++nextNumber_;
            const std::size_t last = line.find_last_not_of(blanks);
            more = last != std::string_view::npos && line[last] == '\\' && !text_.empty();
            if (more) line = line.substr(0, last);
            for (std::size_t at = line.find_first_not_of(blanks);
                 at != std::string_view::npos && !remark;) {
                const std::size_t stop = std::min(line.find_first_of(blanks, at), line.size());
                const std::string_view word = line.substr(at, stop - at);
                remark = word.front() == '#';
                if (!remark) words_.push_back(word);
                at = line.find_first_not_of(blanks, stop);
            }
        }
        return true;
    }

    void requireThree(std::string_view keyword, std::string_view takes) const {
        if (words_.size() > 3) return;
        fail(
            fmt::format("'{}' has {} words; it takes three {}", keyword, words_.size() - 1, takes));
    }
    [[noreturn]] void failWord(std::string_view word, std::string_view keyword,
                               std::string_view takes) const {
        fail(fmt::format("'{}' is read; '{}' takes three {}", word.substr(0, 40), keyword, takes));
    }

    /// Three numbers; others behind them are weights or colours, and have to be numbers as well.
    MeshVector vector(std::string_view keyword) const {
        constexpr std::string_view takes = "numbers, x y z";
        MeshVector result{};
        for (std::size_t k = 1; k < words_.size(); ++k) {
            std::string_view word = words_[k];
            if (word.starts_with('+')) word.remove_prefix(1);
            double value = 0;
            const char* end = word.data() + word.size();
            const auto [next, error] = std::from_chars(word.data(), end, value);
            const bool letters =
                word.find_first_not_of("0123456789+-.eE") != std::string_view::npos;
            if (letters || word.empty() || next != end || error == std::errc::invalid_argument)
                failWord(words_[k], keyword, takes);
            if (error == std::errc::result_out_of_range) {
                const bool small = word.find("e-") != word.npos || word.find("E-") != word.npos;
                value = small ? 0 : std::numeric_limits<double>::infinity();
            }
            if (k <= 3) result[k - 1] = static_cast<float>(value);
        }
        requireThree(keyword, takes);
        return result;
    }

    void readFace() {
        constexpr std::string_view takes = "corners, as 1, 1/2, 1//3 or 1/2/3";
        Face face{.line = line_, .first = corners_.size()};
        for (std::size_t k = 1; k < words_.size(); ++k) {
            ObjCorner corner;
            if (!parseCorner(words_[k], corner)) failWord(words_[k], words_.front(), takes);
            if (corner.vertex < 0)
                corner.vertex += static_cast<std::int64_t>(mesh_.positions.size()) + 1;
            if (corner.normal < 0) corner.normal += static_cast<std::int64_t>(normals_.size()) + 1;
            corners_.push_back(corner);
        }
        requireThree(words_.front(), takes);
        face.count = corners_.size() - face.first;
        if (face.count > manyCorners) squared_ += face.count * face.count;
        if (squared_ > mostSquared)
            fail(
                fmt::format("faces of {} corners take too long to cut into triangles; cut them "
                            "before, one of 8192 is read",
                            face.count));
        faces_.push_back(face);
    }

    /// VERTEX, VERTEX/TEXTURE, VERTEX//NORMAL or VERTEX/TEXTURE/NORMAL.
    static bool parseCorner(std::string_view word, ObjCorner& corner) {
        for (int part = 0; part < 3; ++part) {
            std::int64_t index = 0;
            const char* end = word.data() + word.size();
            const auto [next, error] = std::from_chars(word.data(), end, index);
            const bool left = part == 1 && word.starts_with('/');
            if (error != std::errc() && !left) return false;
            word.remove_prefix(left ? 0 : static_cast<std::size_t>(next - word.data()));
            if (part == 0) corner.vertex = index;
            if (part == 2) corner.normal = index;
            if (word.empty()) return true;
            if (!word.starts_with('/')) return false;
            word.remove_prefix(1);
        }
        return false;
    }

    void addFace(const Face& face) {
        const auto vertices = static_cast<std::int64_t>(mesh_.positions.size());
        const auto normals = static_cast<std::int64_t>(normals_.size());
        const auto corners = std::span(corners_).subspan(face.first, face.count);
        outline_.clear();
        for (const ObjCorner& corner : corners) {
            if (corner.vertex < 1 || corner.vertex > vertices || corner.normal < 0 ||
                corner.normal > normals) {
                line_ = face.line;
                fail(fmt::format("a face names vertex {} and normal {}; there are {} and {}",
                                 corner.vertex, corner.normal, vertices, normals));
            }
            outline_.push_back(mesh_.positions[static_cast<std::size_t>(corner.vertex - 1)]);
        }
        cut_.clear();
        cutPolygon(outline_, cut_);  // `mostSquared` allows for no more than it cuts
        for (const auto& triangle : cut_) {
            std::array<std::uint32_t, 3> indices{};
            for (std::size_t k = 0; k < 3; ++k) {
                const ObjCorner& corner = corners[triangle[k]];
                indices[k] = static_cast<std::uint32_t>(corner.vertex - 1);
                mesh_.normals.push_back(
                    corner.normal == 0 ? MeshVector{}
                                       : normals_[static_cast<std::size_t>(corner.normal - 1)]);
            }
            mesh_.triangles.push_back(indices);
        }
    }

    std::string_view text_;
    const std::string& path_;
    std::size_t line_ = 1, nextNumber_ = 1, squared_ = 0;
    std::vector<std::string_view> words_;
    std::vector<MeshVector> normals_;
    std::vector<ObjCorner> corners_;
    std::vector<Face> faces_;
    Mesh mesh_;
    std::vector<MeshVector> outline_;
    std::vector<std::array<std::uint32_t, 3>> cut_;
};

}  // namespace

Mesh readObj(std::string_view text, const std::string& path) {
    if (text.find('\0') != std::string_view::npos) {
        throw InputError(
            fmt::format("{}: is neither a PLY file nor text, as a Wavefront OBJ file", path));
    }
    return ObjReader(text, path).read();
}

}  // namespace hshfit::inline meshes
