#include <hshfit/irradiance/direct_irradiance.h>

#include <hshfit/light/light_nodes.h>
#include <hshfit/light/picture_light.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline irradiance {
namespace {

constexpr int resolution = 8;  ///< bands that nodes resolve
constexpr std::size_t pixelsOfBlock = 4;

/// Integrals of L w d omega by channel.
struct Moments {
    std::array<Direction, 3> channel{Direction{0, 0, 0}, Direction{0, 0, 0}, Direction{0, 0, 0}};

    void add(const Moments& other) {
        for (std::size_t c = 0; c < 3; ++c) {
            channel[c].x += other.channel[c].x;
            channel[c].y += other.channel[c].y;
            channel[c].z += other.channel[c].z;
        }
    }
    void addTo(Rgb& irradiance, const Direction& normal) const {
        for (std::size_t c = 0; c < 3; ++c) irradiance[c] += std::max(0.0, dot(normal, channel[c]));
    }
};

}  // namespace

/// A tree of blocks of pixels, each level two by two of the one below.
class DirectIrradiance::Picture {
public:
    explicit Picture(const PictureLight& light) : light_(light), geometry_(geometryOf(light)) {
        const auto step = [](double angle, std::size_t count, std::vector<double>& cosine,
                             std::vector<double>& sine) {
            for (std::size_t k = 0; k <= count; ++k) {
                const double at = angle * static_cast<double>(k) / static_cast<double>(count);
                cosine.push_back(std::cos(at));
                sine.push_back(std::sin(at));
            }
        };
        if (light.layout == PictureLayout::latlong) {
            step(pi, light.height, rowCosine_, rowSine_);
            step(2 * pi, light.width, columnCosine_, columnSine_);
        }
        Level first{.width = blocks(light.width), .height = blocks(light.height), .nodes = {}};
        for (std::size_t row = 0; row < first.height; ++row)
            for (std::size_t column = 0; column < first.width; ++column)
                first.nodes.push_back(block(row, column));
        levels_.push_back(std::move(first));
        while (levels_.back().nodes.size() > 1) levels_.push_back(above(levels_.back()));
    }

    Rgb at(const Direction& normal) const {
        Rgb sum{};
        add(levels_.size() - 1, 0, 0, normal, sum);
        return sum;
    }

private:
    struct Node {
        Moments moments;
        Direction centre;
        double reach = pi;  ///< angle to the farthest corner
    };
    struct Level {
        std::size_t width, height;
        std::vector<Node> nodes;
    };
    static std::size_t blocks(std::size_t pixels) {
        return (pixels + pixelsOfBlock - 1) / pixelsOfBlock;
    }

    /// Integral of w d omega over a pixel.
    Direction vectorOf(std::size_t row, std::size_t column) const {
        if (light_.layout != PictureLayout::latlong) {
            const double omega = geometry_.solidAngle(column, row);
            const Direction d = directionOf(light_, static_cast<double>(column) + 0.5,
                                            static_cast<double>(row) + 0.5);
            return {omega * d.x, omega * d.y, omega * d.z};
        }
        // sin^2 theta d theta = d (theta - sin theta cos theta) / 2; phi = pi - psi.
        const double height = pi / static_cast<double>(light_.height);
        const double across =
            (height - rowSine_[row + 1] * rowCosine_[row + 1] + rowSine_[row] * rowCosine_[row]) /
            2;
        const double up =
            (rowSine_[row + 1] * rowSine_[row + 1] - rowSine_[row] * rowSine_[row]) / 2;
        const double x = -across * (columnSine_[column + 1] - columnSine_[column]);
        const double y = across * (columnCosine_[column] - columnCosine_[column + 1]);
        return toWorld(light_, {x, y, up * 2 * pi / static_cast<double>(light_.width)});
    }
    Moments pixel(std::size_t row, std::size_t column) const {
        const Direction d = vectorOf(row, column);
        const float* rgb = light_.rgb.data() + 3 * (row * light_.width + column);
        Moments moments;
        for (std::size_t c = 0; c < 3; ++c)
            moments.channel[c] = {rgb[c] * d.x, rgb[c] * d.y, rgb[c] * d.z};
        return moments;
    }
    template <class Take>
    void forEachPixel(std::size_t row, std::size_t column, Take take) const {
        const std::size_t lastRow = std::min((row + 1) * pixelsOfBlock, light_.height);
        const std::size_t lastColumn = std::min((column + 1) * pixelsOfBlock, light_.width);
        for (std::size_t r = row * pixelsOfBlock; r < lastRow; ++r)
            for (std::size_t c = column * pixelsOfBlock; c < lastColumn; ++c) take(r, c);
    }

    Node block(std::size_t row, std::size_t column) const {
        Node node;
        Direction sum{0, 0, 0};
        forEachPixel(row, column, [&](std::size_t r, std::size_t c) {
            node.moments.add(pixel(r, c));
            const Direction d = vectorOf(r, c);
            sum = {sum.x + d.x, sum.y + d.y, sum.z + d.z};
        });
        setPlace(node, sum);
        node.reach = 0;
        forEachPixel(row, column, [&](std::size_t r, std::size_t c) {
            for (const double down : {0.0, 1.0})
                for (const double right : {0.0, 1.0})
                    widen(node, directionOf(light_, static_cast<double>(c) + right,
                                            static_cast<double>(r) + down));
        });
        return node;
    }
    static void setPlace(Node& node, const Direction& sum) {
        const double length = std::sqrt(dot(sum, sum));
        node.centre = length > 0 ? Direction{sum.x / length, sum.y / length, sum.z / length}
                                 : Direction{0, 0, 1};
    }
    static double angle(const Direction& a, const Direction& b) {
        const Direction gap{a.x - b.x, a.y - b.y, a.z - b.z};
        return 2 * std::asin(std::min(1.0, std::sqrt(dot(gap, gap)) / 2));
    }
    static void widen(Node& node, const Direction& d) {
        node.reach = std::max(node.reach, angle(node.centre, d));
    }

    static Level above(const Level& below) {
        Level level{.width = (below.width + 1) / 2, .height = (below.height + 1) / 2, .nodes = {}};
        for (std::size_t row = 0; row < level.height; ++row) {
            for (std::size_t column = 0; column < level.width; ++column) {
                Node node;
                Direction sum{0, 0, 0};
                forEachChild(below, row, column, [&](const Node& child, std::size_t, std::size_t) {
                    node.moments.add(child.moments);
                    sum = {sum.x + child.centre.x, sum.y + child.centre.y, sum.z + child.centre.z};
                });
                setPlace(node, sum);
                node.reach = 0;
                forEachChild(below, row, column, [&](const Node& child, std::size_t, std::size_t) {
                    node.reach =
                        std::max(node.reach, angle(node.centre, child.centre) + child.reach);
                });
                level.nodes.push_back(node);
            }
        }
        return level;
    }
    template <class Take>
    static void forEachChild(const Level& level, std::size_t row, std::size_t column, Take take) {
        for (std::size_t r = 2 * row; r < std::min(2 * row + 2, level.height); ++r)
            for (std::size_t c = 2 * column; c < std::min(2 * column + 2, level.width); ++c)
                take(level.nodes[r * level.width + c], r, c);
    }

    void add(std::size_t level, std::size_t row, std::size_t column, const Direction& normal,
             Rgb& sum) const {
        const Node& node = levels_[level].nodes[row * levels_[level].width + column];
        if (node.reach < pi / 2) {
            const double height = dot(node.centre, normal), edge = std::sin(node.reach);
            if (height < -edge) return;
            if (height > edge) return node.moments.addTo(sum, normal);
        }
        if (level == 0) {
            forEachPixel(row, column,
                         [&](std::size_t r, std::size_t c) { pixel(r, c).addTo(sum, normal); });
            return;
        }
        forEachChild(
            levels_[level - 1], row, column,
            [&](const Node&, std::size_t r, std::size_t c) { add(level - 1, r, c, normal, sum); });
    }

    const PictureLight& light_;
    PictureGeometry geometry_;
    std::vector<double> rowCosine_, rowSine_, columnCosine_, columnSine_;
    std::vector<Level> levels_;
};

DirectIrradiance::DirectIrradiance(std::span<const Light> lights) {
    for (const Light& light : lights) {
        if (const auto* picture = std::get_if<PictureLight>(&light))
            pictures_.push_back(std::make_unique<Picture>(*picture));
        else
            others_.push_back(&light);
    }
}

DirectIrradiance::~DirectIrradiance() = default;

Rgb DirectIrradiance::at(const Direction& normal) const {
    Rgb sum{};
    for (const auto& picture : pictures_) {
        const Rgb one = picture->at(normal);
        for (std::size_t c = 0; c < 3; ++c) sum[c] += one[c];
    }
    const LightDomain domain{
        .normal = Orientation{.theta = polarAngle(normal), .phi = azimuth(normal), .turn = 0}};
    for (const Light* light : others_) {
        const LightNodes nodes = nodesOf(*light, domain, resolution, 1);
        for (std::size_t k = 0; k < nodes.count(); ++k)
            for (std::size_t c = 0; c < 3; ++c) sum[c] += nodes.z[k] * nodes.flux[c][k];
    }
    return sum;
}

}  // namespace hshfit::inline irradiance
