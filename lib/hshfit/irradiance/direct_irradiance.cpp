#include <hshfit/irradiance/direct_irradiance.h>

#include <hshfit/light/light_nodes.h>
#include <hshfit/light/picture_light.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline irradiance {
namespace {

constexpr int resolution = 8;  ///< bands that nodes resolve
constexpr std::size_t pixelsOfBlock = 4;

/// The scalar product in place: a call costs as much as the product.
inline double along(const Direction& a, const Direction& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

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
    void add(const float* rgb, const Direction& d) {
        for (std::size_t c = 0; c < 3; ++c) {
            channel[c].x += rgb[c] * d.x;
            channel[c].y += rgb[c] * d.y;
            channel[c].z += rgb[c] * d.z;
        }
    }
    void addTo(Rgb& irradiance, const Direction& normal) const {
        for (std::size_t c = 0; c < 3; ++c)
            irradiance[c] += std::max(0.0, along(normal, channel[c]));
    }
};

}  // namespace

/// A tree of blocks of pixels, each level two by two of the one below, in the picture's own frame.
class DirectIrradiance::Picture {
public:
    explicit Picture(const PictureLight& light) : light_(light), geometry_(geometryOf(light)) {
        if (light.layout == PictureLayout::latlong)
            setLatlong();
        else
            setVectors();
        Level first{.width = blocks(light.width), .height = blocks(light.height), .nodes = {}};
        first.nodes.reserve(first.width * first.height);
        for (std::size_t row = 0; row < first.height; ++row)
            for (std::size_t column = 0; column < first.width; ++column)
                first.nodes.push_back(block(row, column));
        levels_.push_back(std::move(first));
        while (levels_.back().nodes.size() > 1) levels_.push_back(above(levels_.back()));
    }

    Rgb at(const Direction& normal) const {
        Rgb sum{};
        add(levels_.size() - 1, 0, 0, toPicture(light_, normal), sum);
        return sum;
    }

private:
    struct Node {
        Moments moments;
        Direction centre;
        double reach = pi;  ///< angle to the farthest corner
        double edge = 2;    ///< its sine; above 1 where no plane leaves the node on one side
    };
    struct Level {
        std::size_t width, height;
        std::vector<Node> nodes;
    };
    static std::size_t blocks(std::size_t pixels) {
        return (pixels + pixelsOfBlock - 1) / pixelsOfBlock;
    }

    /// Cosines and sines at the edges of rows and columns, and integrals between them:
    /// sin^2 theta d theta = d (theta - sin theta cos theta) / 2; phi = pi - psi.
    void setLatlong() {
        const auto step = [](double angle, std::size_t count, std::vector<double>& cosine,
                             std::vector<double>& sine) {
            for (std::size_t k = 0; k <= count; ++k) {
                const double at = angle * static_cast<double>(k) / static_cast<double>(count);
                cosine.push_back(std::cos(at));
                sine.push_back(std::sin(at));
            }
        };
        step(pi, light_.height, rowCosine_, rowSine_);
        step(2 * pi, light_.width, columnCosine_, columnSine_);
        const double height = pi / static_cast<double>(light_.height);
        const double width = 2 * pi / static_cast<double>(light_.width);
        for (std::size_t r = 0; r < light_.height; ++r) {
            const double s = rowSine_[r], t = rowSine_[r + 1];
            across_.push_back((height - t * rowCosine_[r + 1] + s * rowCosine_[r]) / 2);
            up_.push_back((t * t - s * s) / 2 * width);
        }
        for (std::size_t c = 0; c < light_.width; ++c) {
            columnX_.push_back(columnSine_[c] - columnSine_[c + 1]);
            columnY_.push_back(columnCosine_[c] - columnCosine_[c + 1]);
        }
    }

    void setVectors() {
        vectors_.reserve(light_.width * light_.height);
        for (std::size_t r = 0; r < light_.height; ++r) {
            for (std::size_t c = 0; c < light_.width; ++c) {
                const double omega = geometry_.solidAngle(c, r);
                const Direction d =
                    geometry_.direction(static_cast<double>(c) + 0.5, static_cast<double>(r) + 0.5);
                vectors_.push_back({omega * d.x, omega * d.y, omega * d.z});
            }
        }
    }

    /// Integral of w d omega over a pixel.
    Direction vectorOf(std::size_t row, std::size_t column) const {
        if (light_.layout == PictureLayout::latlong)
            return {across_[row] * columnX_[column], across_[row] * columnY_[column], up_[row]};
        return vectors_[row * light_.width + column];
    }
    Direction corner(std::size_t row, std::size_t column) const {
        if (light_.layout == PictureLayout::latlong)
            return {-rowSine_[row] * columnCosine_[column], rowSine_[row] * columnSine_[column],
                    rowCosine_[row]};
        return geometry_.direction(static_cast<double>(column), static_cast<double>(row));
    }
    const float* pixel(std::size_t row, std::size_t column) const {
        return light_.rgb.data() + 3 * (row * light_.width + column);
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
            const Direction d = vectorOf(r, c);
            node.moments.add(pixel(r, c), d);
            sum = {sum.x + d.x, sum.y + d.y, sum.z + d.z};
        });
        setPlace(node, sum);
        double gap = 0;
        const std::size_t lastRow = std::min((row + 1) * pixelsOfBlock, light_.height);
        const std::size_t lastColumn = std::min((column + 1) * pixelsOfBlock, light_.width);
        for (std::size_t r = row * pixelsOfBlock; r <= lastRow; ++r)
            for (std::size_t c = column * pixelsOfBlock; c <= lastColumn; ++c)
                gap = std::max(gap, squaredGap(node.centre, corner(r, c)));
        setReach(node, angle(gap));
        return node;
    }
    static void setPlace(Node& node, const Direction& sum) {
        const double length = std::sqrt(along(sum, sum));
        node.centre = length > 0 ? Direction{sum.x / length, sum.y / length, sum.z / length}
                                 : Direction{0, 0, 1};
    }
    static double squaredGap(const Direction& a, const Direction& b) {
        const Direction gap{a.x - b.x, a.y - b.y, a.z - b.z};
        return along(gap, gap);
    }
    static double angle(double squaredGap) {
        return 2 * std::asin(std::min(1.0, std::sqrt(squaredGap) / 2));
    }
    static void setReach(Node& node, double reach) {
        node.reach = reach;
        if (reach < pi / 2) node.edge = std::sin(reach);
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
                double reach = 0;
                forEachChild(below, row, column, [&](const Node& child, std::size_t, std::size_t) {
                    reach =
                        std::max(reach, angle(squaredGap(node.centre, child.centre)) + child.reach);
                });
                setReach(node, reach);
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
        const double height = along(node.centre, normal);
        if (height < -node.edge) return;
        if (height > node.edge) return node.moments.addTo(sum, normal);
        if (level == 0) {
            forEachPixel(row, column, [&](std::size_t r, std::size_t c) {
                const double cosine = std::max(0.0, along(normal, vectorOf(r, c)));
                const float* rgb = pixel(r, c);
                for (std::size_t k = 0; k < 3; ++k) sum[k] += rgb[k] * cosine;
            });
            return;
        }
        forEachChild(
            levels_[level - 1], row, column,
            [&](const Node&, std::size_t r, std::size_t c) { add(level - 1, r, c, normal, sum); });
    }

    const PictureLight& light_;
    PictureGeometry geometry_;
    std::vector<double> rowCosine_, rowSine_, columnCosine_, columnSine_;
    std::vector<double> across_, up_, columnX_, columnY_;  ///< of rows, of columns
    std::vector<Direction> vectors_;  ///< of pixels, row by row, in other layouts
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
