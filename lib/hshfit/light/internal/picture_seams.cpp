#include <hshfit/light/internal/picture_seams.h>

#include <hshfit/light/picture_layout.h>
#include <hshfit/light/picture_light.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <vector>

namespace hshfit::inline light {
namespace {

constexpr double mostOfInside = 4, mostOfMean = 0.02;
constexpr std::size_t mostAlongEdge = 64;  ///< places that are looked at

constexpr std::array<std::string_view, 6> facesInOrder = {"right",  "left",  "top",
                                                          "bottom", "front", "back"};

/// Two pixels over an edge, and the one beside the first within its face.
struct Pair {
    std::array<std::size_t, 2> pixel, across, inside;  ///< column, row
};

std::vector<Pair> edgePairs(const PictureGeometry& g) {
    constexpr std::pair<int, int> steps[] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    std::vector<Pair> pairs;
    const std::size_t n = g.faceSize(), step = std::max<std::size_t>(1, n / mostAlongEdge);
    for (std::size_t top = 0; top < g.height; top += n) {
        for (std::size_t left = 0; left < g.width; left += n) {
            for (std::size_t along = 0; along < n; along += step) {
                for (const auto& [right, down] : steps) {
                    const auto place = [&](int towards, std::size_t first) {
                        return first + (towards == 0 ? along : towards > 0 ? n - 1 : 0);
                    };
                    const std::size_t column = place(right, left), row = place(down, top);
                    const auto across = g.neighbour(column, row, right, down);
                    const auto inside = g.neighbour(column, row, -right, -down);
                    if (across && inside) pairs.push_back({{column, row}, *across, *inside});
                }
            }
        }
    }
    return pairs;
}

/// The place of the file from which a place of the picture is taken, in another arrangement.
using Source = std::function<std::array<std::size_t, 2>(std::array<std::size_t, 2>)>;

class Seams {
public:
    explicit Seams(const PictureLight& light)
        : light_(light), geometry_(geometryOf(light)), pairs_(edgePairs(geometry_)) {
        for (const Pair& pair : pairs_) {
            inside_ += difference(pair.pixel, pair.inside);
            mean_ += sum(pair.pixel);
        }
        inside_ /= count();
        mean_ /= count();
    }

    double across(const Source& source) const {
        double total = 0;
        for (const Pair& pair : pairs_)
            total += difference(source(pair.pixel), source(pair.across));
        return total / count();
    }
    bool meet(double across) const {
        return across <= std::max(mostOfInside * inside_, mostOfMean * mean_);
    }
    double share(double difference) const { return mean_ > 0 ? 100 * difference / mean_ : 0; }
    double inside() const { return inside_; }
    const PictureGeometry& geometry() const { return geometry_; }

private:
    double count() const { return static_cast<double>(std::max<std::size_t>(pairs_.size(), 1)); }
    const float* at(const std::array<std::size_t, 2>& place) const {
        return light_.rgb.data() + 3 * (place[1] * light_.width + place[0]);
    }
    double sum(const std::array<std::size_t, 2>& place) const {
        const float* rgb = at(place);
        return double{rgb[0]} + rgb[1] + rgb[2];
    }
    double difference(const std::array<std::size_t, 2>& a,
                      const std::array<std::size_t, 2>& b) const {
        double total = 0;
        for (std::size_t c = 0; c < 3; ++c) total += std::abs(double{at(a)[c]} - at(b)[c]);
        return total;
    }

    const PictureLight& light_;
    PictureGeometry geometry_;
    std::vector<Pair> pairs_;
    double inside_ = 0, mean_ = 0;
};

/// The order of a strip in which the faces meet; empty where there is none.
std::string orderThatMeets(const Seams& seams) {
    const PictureGeometry& g = seams.geometry();
    const std::size_t n = g.faceSize();
    const bool row = g.width > g.height;
    std::array<std::size_t, 6> cell{};  // of the file, by face
    std::iota(cell.begin(), cell.end(), std::size_t{0});
    double least = INFINITY;
    std::array<std::size_t, 6> best = cell;
    do {
        const double across = seams.across([&](std::array<std::size_t, 2> place) {
            std::size_t& along = place[row ? 0 : 1];
            along = cell[along / n] * n + along % n;
            return place;
        });
        if (across < least) least = across, best = cell;
    } while (std::ranges::next_permutation(cell).found);
    if (!seams.meet(least)) return {};
    std::array<std::string_view, 6> order;
    for (std::size_t face = 0; face < 6; ++face) order[best[face]] = facesInOrder[face];
    std::string text = "they do if the order is";
    for (const std::string_view name : order) text += fmt::format(" {}", name);
    return text + "; expected: right left top bottom front back";
}

/// A remark that the faces of a cross meet with the back turned by 180 degrees; empty if they do
/// not. The back of an upright cross is its lowest face, the back of a lying cross its rightmost
/// face.
std::string backThatMeets(const Seams& seams) {
    const PictureGeometry& g = seams.geometry();
    const std::size_t n = g.faceSize();
    const bool lying = g.width > g.height;
    const std::size_t left = lying ? 3 * n : n, top = lying ? n : 3 * n;
    const double across = seams.across([&](std::array<std::size_t, 2> place) {
        if (place[0] / n == left / n && place[1] / n == top / n) {
            place[0] = 2 * left + n - 1 - place[0];
            place[1] = 2 * top + n - 1 - place[1];
        }
        return place;
    });
    if (!seams.meet(across)) return {};
    return lying ? "they do with the back turned by 180 degrees"
                 : "they do if the back is upright; expected: turned by 180 degrees";
}

}  // namespace

std::string seamRemark(const PictureLight& light) {
    const PictureGeometry g = geometryOf(light);
    constexpr std::size_t leastFace = 4;
    if (g.faceSize() < leastFace) return {};
    const Seams seams(light);
    const double across = seams.across([](const auto& place) { return place; });
    if (seams.meet(across)) return {};
    const std::string cure =
        g.layout == PictureLayout::faces ? orderThatMeets(seams) : backThatMeets(seams);
    return fmt::format(
        "{}: the edges of the cube's faces do not meet: pixels differ by {:.3g} % over the edges "
        "and by {:.3g} % beside them{}{}",
        light.file, seams.share(across), seams.share(seams.inside()), cure.empty() ? "" : "; ",
        cure);
}

}  // namespace hshfit::inline light
