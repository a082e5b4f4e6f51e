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

/// Pixels along a picture, at least: on the horizon their error is 1e-5.
constexpr std::size_t finePixels = 1024;

/// The picture with each pixel as several of the same radiance, `finePixels` or more in a row.
std::unique_ptr<PictureLight> refined(const PictureLight& light) {
    const std::size_t times = (finePixels + light.width - 1) / light.width;
    auto fine = std::make_unique<PictureLight>(light);
    fine->width *= times;
    fine->height *= times;
    fine->rgb.clear();
    fine->rgb.reserve(3 * fine->width * fine->height);
    for (std::size_t row = 0; row < fine->height; ++row)
        for (std::size_t column = 0; column < fine->width; ++column) {
            const auto pixel =
                light.rgb.begin() +
                static_cast<std::ptrdiff_t>(3 * (row / times * light.width + column / times));
            fine->rgb.insert(fine->rgb.end(), pixel, pixel + 3);
        }
    return fine;
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

/// A picture in its own frame.
class DirectIrradiance::Picture {
public:
    virtual ~Picture() = default;
    virtual Rgb at(const Direction& normal) const = 0;
};

/// The columns of a latitude-longitude picture. The integral of w d omega over a pixel is
/// (across x, across y, up) with x and y of its column, across and up of its row; up / across falls
/// from the zenith to the nadir, so that a plane leaves the upper part of a column on one side.
class DirectIrradiance::Columns final : public Picture {
public:
    explicit Columns(const PictureLight& light) : light_(light) {
        setPixels();
        sums_.resize((light.height / rowsOfSum + 1) * light.width);
        for (std::size_t column = 0; column < light.width; ++column) {
            Sums sum{};
            for (std::size_t row = 0; row < light.height; ++row) {
                if (row % rowsOfSum == 0) sums_[row / rowsOfSum * light.width + column] = sum;
                sum.add(pixel(row, column), rows_[row], 1);
            }
            if (light.height % rowsOfSum == 0)
                sums_[light.height / rowsOfSum * light.width + column] = sum;
            whole_.push_back(sum);
        }
    }

    Rgb at(const Direction& normal) const override {
        const Direction n = toPicture(light_, normal);
        Rgb result{};
        std::size_t end = 0;  // of the rows on the zenith's side; neighbours differ by little
        for (std::size_t column = 0; column < light_.width; ++column) {
            const double along = n.x * columns_[column].x + n.y * columns_[column].y;
            const auto isUpper = [&](std::size_t row) {
                const double cosine = along * rows_[row].across + n.z * rows_[row].up;
                return n.z >= 0 ? cosine > 0 : cosine <= 0;
            };
            while (end < light_.height && isUpper(end)) ++end;
            while (end > 0 && !isUpper(end - 1)) --end;
            const Sums upper = above(end, column);
            for (std::size_t c = 0; c < 3; ++c) {
                const double share = along * upper.across[c] + n.z * upper.up[c];
                const Sums& all = whole_[column];
                result[c] += n.z >= 0 ? share : along * all.across[c] + n.z * all.up[c] - share;
            }
        }
        return result;
    }

private:
    static constexpr std::size_t rowsOfSum = 8;
    struct Row {
        double across, up;
    };
    struct Column {
        double x, y;
    };
    /// Sums of R, G, B times `across` and `up` over rows of a column.
    struct Sums {
        Rgb across, up;
        void add(const float* rgb, const Row& row, double sign) {
            for (std::size_t c = 0; c < 3; ++c) {
                across[c] += sign * rgb[c] * row.across;
                up[c] += sign * rgb[c] * row.up;
            }
        }
    };

    /// sin^2 theta d theta = d (theta - sin theta cos theta) / 2; phi = pi - psi.
    void setPixels() {
        const double height = pi / static_cast<double>(light_.height);
        const double width = 2 * pi / static_cast<double>(light_.width);
        for (std::size_t r = 0; r < light_.height; ++r) {
            const double top = height * static_cast<double>(r), bottom = top + height;
            const double s = std::sin(top), t = std::sin(bottom);
            rows_.push_back({(height - t * std::cos(bottom) + s * std::cos(top)) / 2,
                             (t * t - s * s) / 2 * width});
        }
        for (std::size_t c = 0; c < light_.width; ++c) {
            const double left = width * static_cast<double>(c), right = left + width;
            columns_.push_back(
                {std::sin(left) - std::sin(right), std::cos(left) - std::cos(right)});
        }
    }
    const float* pixel(std::size_t row, std::size_t column) const {
        return light_.rgb.data() + 3 * (row * light_.width + column);
    }
    /// The rows before `end`, from the nearest sum.
    Sums above(std::size_t end, std::size_t column) const {
        const std::size_t last = light_.height / rowsOfSum;
        const std::size_t nearest = std::min((end + rowsOfSum / 2) / rowsOfSum, last);
        Sums sum = sums_[nearest * light_.width + column];
        for (std::size_t row = nearest * rowsOfSum; row < end; ++row)
            sum.add(pixel(row, column), rows_[row], 1);
        for (std::size_t row = end; row < nearest * rowsOfSum; ++row)
            sum.add(pixel(row, column), rows_[row], -1);
        return sum;
    }

    const PictureLight& light_;
    std::vector<Row> rows_;
    std::vector<Column> columns_;
    std::vector<Sums> sums_;   ///< of the rows before every eighth, [row / 8][column]
    std::vector<Sums> whole_;  ///< of columns
};

/// A tree of blocks of pixels, each level two by two of the one below.
class DirectIrradiance::Blocks final : public Picture {
public:
    explicit Blocks(const PictureLight& light) : light_(light), geometry_(geometryOf(light)) {
        setVectors();
        Level first{.width = blocks(light.width), .height = blocks(light.height), .nodes = {}};
        first.nodes.reserve(first.width * first.height);
        for (std::size_t row = 0; row < first.height; ++row)
            for (std::size_t column = 0; column < first.width; ++column)
                first.nodes.push_back(block(row, column));
        levels_.push_back(std::move(first));
        while (levels_.back().nodes.size() > 1) levels_.push_back(above(levels_.back()));
    }

    Rgb at(const Direction& normal) const override {
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
        return vectors_[row * light_.width + column];
    }
    Direction corner(std::size_t row, std::size_t column) const {
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
    std::vector<Direction> vectors_;  ///< of pixels, row by row
    std::vector<Level> levels_;
};

DirectIrradiance::DirectIrradiance(std::span<const Light> lights) {
    for (const Light& light : lights) {
        const auto* picture = std::get_if<PictureLight>(&light);
        if (!picture) {
            others_.push_back(&light);
            continue;
        }
        if (picture->width < finePixels) picture = fine_.emplace_back(refined(*picture)).get();
        if (picture->layout == PictureLayout::latlong)
            pictures_.push_back(std::make_unique<Columns>(*picture));
        else
            pictures_.push_back(std::make_unique<Blocks>(*picture));
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
