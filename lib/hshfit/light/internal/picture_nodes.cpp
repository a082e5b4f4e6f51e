#include <hshfit/light/internal/picture_nodes.h>

#include <hshfit/light/picture_light.h>
#include <hshfit/quadrature/quadrature.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace hshfit::inline light {
namespace {

/// Bands times radians of a block: its functions are then polynomials of low degree to 1e-9.
constexpr double blockPhase = 0.5;
constexpr std::size_t largestBlock = 16;

/// Gauss nodes of [low, high], and for each pixel in it the integral of each Lagrange polynomial:
/// [pixel][node], by sin(theta) d theta or by d phi.
struct Spread {
    std::vector<double> at, share;
    std::size_t nodes, pixels;

    Spread(double low, double pixel, std::size_t pixelsIn, std::size_t nodesIn, bool polar)
        : share(pixelsIn * nodesIn, 0.0), nodes(nodesIn), pixels(pixelsIn) {
        const GaussRule& rule = gaussLegendre(static_cast<int>(nodes));
        const GaussRule& inner = gaussLegendre(static_cast<int>(nodes / 2 + 3));
        const double width = pixel * static_cast<double>(pixels);
        for (const double x : rule.nodes) at.push_back(low + width * (1 + x) / 2);
        for (std::size_t p = 0; p < pixels; ++p) {
            for (std::size_t k = 0; k < inner.nodes.size(); ++k) {
                const double place =
                    low + pixel * (static_cast<double>(p) + (1 + inner.nodes[k]) / 2);
                const double weight =
                    pixel * inner.weights[k] / 2 * (polar ? std::sin(place) : 1.0);
                for (std::size_t i = 0; i < nodes; ++i) {
                    double value = weight;
                    for (std::size_t j = 0; j < nodes; ++j)
                        if (j != i) value *= (place - at[j]) / (at[i] - at[j]);
                    share[p * nodes + i] += value;
                }
            }
        }
    }
};

struct Block {
    std::size_t row, column, rows, columns;
};

class Pictured {
public:
    Pictured(const PictureLight& light, const LightDomain& domain, int order, int level)
        : light_(light),
          hemisphere_(domain.normal.has_value()),
          frame_(domain.frame()),
          normal_(toPicture(light, frame_.normal)) {
        pixel_ = pi / static_cast<double>(light.height);
        step_ = 2 * pi / static_cast<double>(light.width);
        const double phase = order * pixel_;
        block_ =
            std::clamp(static_cast<std::size_t>(blockPhase / phase), std::size_t{1}, largestBlock);
        nodes_ = static_cast<std::size_t>(5 + 2 * level +
                                          std::ceil(phase * static_cast<double>(block_)));
    }

    /// The nodes of one row of blocks.
    LightNodes rowOfBlocks(std::size_t row) const {
        LightNodes nodes;
        const std::size_t rows = std::min(block_, light_.height - row);
        const Spread down(pixel_ * static_cast<double>(row), pixel_, rows, nodes_, true);
        for (std::size_t column = 0; column < light_.width; column += block_) {
            const std::size_t columns = std::min(block_, light_.width - column);
            add({row, column, rows, columns}, down, nodes);
        }
        return nodes;
    }
    std::size_t block() const { return block_; }

    /// Solid angle of the pixel's part in the domain.
    double solidAngle(std::size_t row, std::size_t column) const {
        const double at = pixel_ * (static_cast<double>(row) + 0.5);
        const double whole = 2 * std::sin(at) * std::sin(pixel_ / 2) * step_;
        const int side = sideOf({row, column, 1, 1});
        if (side != 0) return side > 0 ? whole : 0;
        double above = 0;
        forEachNode(row, column, [&](const Direction&, double weight) { above += weight; });
        return above;
    }

private:
    /// 1: the block lies above the horizon of the domain, -1: below, 0: on it.
    int sideOf(const Block& b) const {
        if (!hemisphere_) return 1;
        const double row = static_cast<double>(b.row) + static_cast<double>(b.rows) / 2;
        const double column = static_cast<double>(b.column) + static_cast<double>(b.columns) / 2;
        const double height = frame_.toLocal(directionOf(light_, column, row)).z;
        const double reach = std::hypot(pixel_ * static_cast<double>(b.rows),
                                        step_ * static_cast<double>(b.columns)) /
                             2;
        return std::abs(height) <= std::sin(std::min(reach, pi / 2)) ? 0 : height > 0 ? 1 : -1;
    }
    /// Polar angle at which the horizon of the domain crosses a meridian of the picture; none where
    /// it follows meridians.
    std::optional<double> crossing(double phi) const {
        const Direction& n = normal_;
        const double across = n.x * std::cos(phi) + n.y * std::sin(phi);
        if (std::abs(n.z) < 1e-12) return {};
        return std::atan2(std::abs(n.z), n.z > 0 ? -across : across);
    }

    /// Gauss nodes of the part of a pixel above the horizon: panels in theta between the places
    /// where the horizon enters and leaves the pixel or touches a ring, then arcs.
    template <class Take>
    void forEachNode(std::size_t row, std::size_t column, Take take) const {
        const Direction& n = normal_;
        const double slope = std::hypot(n.x, n.y), middle = (static_cast<double>(column) + 0.5);
        const double towards = std::atan2(n.y, n.x) - azimuthOf(middle);
        const double touch = std::atan2(std::abs(n.z), slope);
        const double low = pixel_ * static_cast<double>(row), high = low + pixel_;
        std::vector<double> ends{low, high, touch, pi - touch};
        for (const double edge : {middle - 0.5, middle + 0.5})
            if (const auto at = crossing(azimuthOf(edge))) ends.push_back(*at);
        for (double& end : ends) end = std::clamp(end, low, high);
        std::sort(ends.begin(), ends.end());
        const GaussRule& rule = gaussLegendre(static_cast<int>(nodes_ + 2));
        for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
            const double half = (ends[k + 1] - ends[k]) / 2;
            if (half < 1e-14) continue;
            for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
                // Arcs grow like a root from where the horizon touches a ring.
                const double at = pi / 2 * rule.nodes[i];
                const double theta = ends[k] + half * (1 + std::sin(at));
                const double weight = half * pi / 2 * std::cos(at) * rule.weights[i];
                const double ahead = std::cos(theta) * n.z, across = std::sin(theta) * slope;
                const double arc = std::abs(ahead) >= across
                                       ? (ahead > 0 ? pi : 0)
                                       : std::acos(std::clamp(-ahead / across, -1.0, 1.0));
                for (const int turn : {-1, 0, 1}) {
                    const double centre = std::remainder(towards, 2 * pi) + 2 * pi * turn;
                    const double from = std::max(-step_ / 2, centre - arc);
                    const double to = std::min(step_ / 2, centre + arc);
                    if (!(to > from)) continue;
                    // Functions of odd m grow like a root from the horizon.
                    for (std::size_t j = 0; j < rule.nodes.size(); ++j) {
                        const double along = pi / 2 * rule.nodes[j];
                        const double phi = (from + to + (to - from) * std::sin(along)) / 2;
                        const double share =
                            (to - from) / 2 * pi / 2 * std::cos(along) * rule.weights[j];
                        take(frame_.toLocal(
                                 directionOf(light_, middle - phi / step_, theta / pixel_)),
                             weight * std::sin(theta) * share);
                    }
                }
            }
        }
    }
    double azimuthOf(double column) const { return pi - step_ * column; }
    Rgb radiance(std::size_t row, std::size_t column) const {
        const float* rgb = light_.rgb.data() + 3 * (row * light_.width + column);
        return {rgb[0], rgb[1], rgb[2]};
    }

    void add(const Block& b, const Spread& down, LightNodes& nodes) const {
        const int side = sideOf(b);
        if (side < 0) return;
        if (side > 0) return addSpread(b, down, nodes);
        for (std::size_t row = b.row; row < b.row + b.rows; ++row) {
            for (std::size_t column = b.column; column < b.column + b.columns; ++column) {
                const Block pixel{row, column, 1, 1};
                const int one = sideOf(pixel);
                if (one < 0) continue;
                const Rgb value = radiance(row, column);
                if (one > 0) {
                    addSpread(pixel,
                              Spread(pixel_ * static_cast<double>(row), pixel_, 1, nodes_, true),
                              nodes);
                    continue;
                }
                forEachNode(row, column, [&](const Direction& d, double solidAngle) {
                    // Rounding of a node on the horizon does not put it below.
                    nodes.add({d.x, d.y, std::max(d.z, 0.0)}, value, solidAngle);
                });
            }
        }
    }

    void addSpread(const Block& b, const Spread& down, LightNodes& nodes) const {
        // phi grows to the left; columns only need the same nodes.
        const Spread across(step_ * static_cast<double>(b.column), step_, b.columns, nodes_, false);
        std::vector<double> half(nodes_ * b.columns * 3, 0.0), flux(nodes_ * nodes_ * 3, 0.0);
        for (std::size_t r = 0; r < b.rows; ++r) {
            const float* rgb = light_.rgb.data() + 3 * ((b.row + r) * light_.width + b.column);
            for (std::size_t i = 0; i < nodes_; ++i)
                for (std::size_t k = 0; k < 3 * b.columns; ++k)
                    half[i * 3 * b.columns + k] += down.share[r * nodes_ + i] * rgb[k];
        }
        for (std::size_t i = 0; i < nodes_; ++i)
            for (std::size_t column = 0; column < b.columns; ++column)
                for (std::size_t j = 0; j < nodes_; ++j)
                    for (std::size_t c = 0; c < 3; ++c)
                        flux[(i * nodes_ + j) * 3 + c] += across.share[column * nodes_ + j] *
                                                          half[(i * b.columns + column) * 3 + c];
        for (std::size_t i = 0; i < nodes_; ++i) {
            for (std::size_t j = 0; j < nodes_; ++j) {
                const double* from = flux.data() + (i * nodes_ + j) * 3;
                const Direction d =
                    frame_.toLocal(directionOf(light_, across.at[j] / step_, down.at[i] / pixel_));
                nodes.add(d, {from[0], from[1], from[2]}, 1);
            }
        }
    }

    const PictureLight& light_;
    bool hemisphere_;
    Frame frame_;
    Direction normal_;  ///< of the domain, in the picture's own frame
    double pixel_, step_;
    std::size_t block_, nodes_;
};

/// For pictures of other layouts: Gauss nodes in each pixel. They are weighted with the density of
/// solid angle, which varies over a pixel, and scaled so that the weights add up to the pixel's
/// solid angle. Functions that turn within a pixel take more nodes.
void addPixelNodes(const PictureLight& light, const LightDomain& domain, int order, int level,
                   LightNodes& nodes) {
    const PictureGeometry geometry = geometryOf(light);
    const Frame frame = domain.frame();
    const GaussRule& rule =
        gaussLegendre(level + 1 + static_cast<int>(order * geometry.pixelAngle()));
    const std::size_t side = rule.nodes.size();
    std::vector<double> shares(side * side);
    for (std::size_t row = 0; row < light.height; ++row) {
        for (std::size_t column = 0; column < light.width; ++column) {
            const float* rgb = light.rgb.data() + 3 * (row * light.width + column);
            const double solidAngle = geometry.solidAngle(column, row);
            if (!(solidAngle * (rgb[0] + rgb[1] + rgb[2]) > 0)) continue;
            const auto place = [&](std::size_t from, std::size_t node) {
                return static_cast<double>(from) + (1 + rule.nodes[node]) / 2;
            };
            double sum = 0;
            for (std::size_t k = 0; k < shares.size(); ++k) {
                const std::size_t i = k / side, j = k % side;
                shares[k] = rule.weights[i] * rule.weights[j] *
                            geometry.density(place(column, j), place(row, i));
                sum += shares[k];
            }
            // A pixel of which the rim of a disc leaves a corner without nodes.
            if (!(sum > 0)) std::ranges::fill(shares, 1.0), sum = static_cast<double>(side * side);
            for (std::size_t k = 0; k < shares.size(); ++k) {
                if (!(shares[k] > 0)) continue;
                const Direction d = frame.toLocal(
                    directionOf(light, place(column, k % side), place(row, k / side)));
                if (domain.normal && !(d.z > 0)) continue;
                nodes.add(d, {rgb[0], rgb[1], rgb[2]}, solidAngle * shares[k] / sum);
            }
        }
    }
}

}  // namespace

void addPictureNodes(const PictureLight& light, const LightDomain& domain, int order, int level,
                     LightNodes& nodes) {
    if (light.layout != PictureLayout::latlong)
        return addPixelNodes(light, domain, order, level, nodes);
    const Pictured pictured(light, domain, order, level);
    const std::size_t rows = (light.height + pictured.block() - 1) / pictured.block();
    std::vector<LightNodes> parts(rows);
    tbb::parallel_for(std::size_t{0}, rows, [&](std::size_t k) {
        parts[k] = pictured.rowOfBlocks(k * pictured.block());
    });
    const auto append = [](std::vector<double>& to, const std::vector<double>& from) {
        to.insert(to.end(), from.begin(), from.end());
    };
    for (const LightNodes& part : parts) {
        append(nodes.x, part.x);
        append(nodes.y, part.y);
        append(nodes.z, part.z);
        append(nodes.weight, part.weight);
        for (std::size_t c = 0; c < 3; ++c) append(nodes.flux[c], part.flux[c]);
    }
}

struct PictureWeights::Kept {
    const PictureLight& light;
    bool hemisphere;
    Frame frame;
    PictureGeometry geometry;
    std::optional<Pictured> latlong = {};
};

PictureWeights::PictureWeights(const PictureLight& light, const LightDomain& domain)
    : kept_(std::make_unique<Kept>(
          Kept{light, domain.normal.has_value(), domain.frame(), geometryOf(light)})) {
    if (light.layout == PictureLayout::latlong) kept_->latlong.emplace(light, domain, 1, 2);
}

PictureWeights::~PictureWeights() = default;

double PictureWeights::solidAngle(std::size_t row, std::size_t column) const {
    if (kept_->latlong) return kept_->latlong->solidAngle(row, column);
    const Direction d = kept_->frame.toLocal(directionOf(
        kept_->light, static_cast<double>(column) + 0.5, static_cast<double>(row) + 0.5));
    return kept_->hemisphere && !(d.z > 0) ? 0 : kept_->geometry.solidAngle(column, row);
}

}  // namespace hshfit::inline light
