#include <hshfit/lighting/environment_cube.h>
#include <hshfit/lighting/transformed_cosines.h>

#include <hshfit/light/light_samples.h>

#include <algorithm>
#include <cmath>
#include <queue>

namespace hshfit::lighting {
namespace {

constexpr std::size_t grid = 256;  // cells along the edge of a face
constexpr double leastAngle = pi / 360;

/// Solid angle of the part of a face from its centre to (a, b), with the signs of a and b.
double cornerAngle(double a, double b) {
    return std::atan2(a * b, std::sqrt(1 + a * a + b * b));
}

double at(std::size_t k) {
    return 2 * static_cast<double>(k) / grid - 1;
}

/// Sums of flux over the cells of each face to the left of and above a grid point.
class FluxSums {
public:
    explicit FluxSums(std::span<const Light> lights) : sums_(6 * (grid + 1) * (grid + 1)) {
        for (std::size_t face = 0; face < 6; ++face) {
            for (std::size_t row = 0; row < grid; ++row) {
                Rgb line{};
                for (std::size_t column = 0; column < grid; ++column) {
                    const Rgb flux = cellFlux(lights, face, row, column);
                    const Rgb& above = sum(face, row, column + 1);
                    Rgb& here = sums_[place(face, row + 1, column + 1)];
                    for (std::size_t c = 0; c < 3; ++c) here[c] = above[c] + (line[c] += flux[c]);
                }
            }
        }
    }
    const Rgb& sum(std::size_t face, std::size_t row, std::size_t column) const {
        return sums_[place(face, row, column)];
    }
    /// The largest of the faces, by R, G, B.
    double largest() const {
        double most = 0;
        for (std::size_t face = 0; face < 6; ++face)
            for (const double flux : sum(face, grid, grid)) most = std::max(most, flux);
        return most;
    }

private:
    static std::size_t place(std::size_t face, std::size_t row, std::size_t column) {
        return (face * (grid + 1) + row) * (grid + 1) + column;
    }
    static Rgb cellFlux(std::span<const Light> lights, std::size_t face, std::size_t row,
                        std::size_t column) {
        const double a = at(column), b = at(row), step = 1.0 / grid;
        const double angle = cornerAngle(at(column + 1), at(row + 1)) -
                             cornerAngle(a, at(row + 1)) - cornerAngle(at(column + 1), b) +
                             cornerAngle(a, b);
        Rgb flux{};
        for (const double v : {0.5, 1.5}) {
            for (const double u : {0.5, 1.5}) {
                Direction d = cubeDirection(face, a + u * step, b + v * step);
                const double length = std::sqrt(dot(d, d));
                d = {d.x / length, d.y / length, d.z / length};
                const Rgb radiance = radianceFrom(lights, d);
                for (std::size_t c = 0; c < 3; ++c) flux[c] += radiance[c] * angle / 4;
            }
        }
        return flux;
    }
    std::vector<Rgb> sums_;
};

struct Rectangle {
    std::size_t face, left, right, top, bottom;  ///< of cells, the ends excluded

    double angle() const {
        return cornerAngle(at(right), at(bottom)) - cornerAngle(at(left), at(bottom)) -
               cornerAngle(at(right), at(top)) + cornerAngle(at(left), at(top));
    }
    Rgb flux(const FluxSums& sums) const {
        Rgb result{};
        for (std::size_t c = 0; c < 3; ++c)
            result[c] = sums.sum(face, bottom, right)[c] - sums.sum(face, bottom, left)[c] -
                        sums.sum(face, top, right)[c] + sums.sum(face, top, left)[c];
        return result;
    }
    std::pair<Rectangle, Rectangle> halves(bool across) const {
        Rectangle first = *this, second = *this;
        if (across)
            first.right = second.left = (left + right) / 2;
        else
            first.bottom = second.top = (top + bottom) / 2;
        return {first, second};
    }
};

/// A rectangle and its best cut.
struct Cut {
    Rectangle rectangle;
    bool across = false;
    double gain = 0;

    Cut(const Rectangle& whole, const FluxSums& sums) : rectangle(whole) {
        const double width = std::sqrt(whole.angle());
        for (const bool way : {false, true}) {
            if ((way ? whole.right - whole.left : whole.bottom - whole.top) < 2) continue;
            const auto [first, second] = whole.halves(way);
            const Rgb a = first.flux(sums), b = second.flux(sums);
            const double omega = second.angle() / first.angle();
            double moved = 0;  // flux that the mean radiance puts into the other half
            for (std::size_t c = 0; c < 3; ++c)
                moved += std::abs(a[c] * omega - b[c]) / (1 + omega);
            if (moved * width <= gain) continue;
            gain = moved * width;
            across = way;
        }
    }
    bool operator<(const Cut& other) const { return gain < other.gain; }
};

AreaLight areaLight(const Rectangle& r, const FluxSums& sums) {
    AreaLight light{.corners = {cubeDirection(r.face, at(r.left), at(r.top)),
                                cubeDirection(r.face, at(r.right), at(r.top)),
                                cubeDirection(r.face, at(r.right), at(r.bottom)),
                                cubeDirection(r.face, at(r.left), at(r.bottom))},
                    .radiance = r.flux(sums)};
    for (double& value : light.radiance) value /= r.angle();
    return light;
}

void addTiles(std::span<const Light> lights, std::size_t count, std::vector<AreaLight>& out) {
    const FluxSums sums(lights);
    std::priority_queue<Cut> cuts;
    for (std::size_t face = 0; face < 6; ++face)
        cuts.emplace(Rectangle{face, 0, grid, 0, grid}, sums);
    // Differences of sums leave rounding, which is no reason to cut.
    const double least = 1e-9 * sums.largest();
    while (cuts.size() < count && cuts.top().gain > least) {
        const Cut best = cuts.top();
        cuts.pop();
        const auto [first, second] = best.rectangle.halves(best.across);
        cuts.emplace(first, sums);
        cuts.emplace(second, sums);
    }
    for (; !cuts.empty(); cuts.pop()) {
        const AreaLight tile = areaLight(cuts.top().rectangle, sums);
        if (tile.radiance != Rgb{}) out.push_back(tile);
    }
}

/// The square across `towards` that is seen under a solid angle.
std::array<Direction, 4> squareTowards(const Direction& towards, double angle, double turn,
                                       double halfWidth, double halfHeight) {
    const double theta = polarAngle(towards), phi = azimuth(towards);
    const Direction down{std::cos(theta) * std::cos(phi), std::cos(theta) * std::sin(phi),
                         -std::sin(theta)};
    const Direction along{-std::sin(phi), std::cos(phi), 0};
    if (angle > 0) {
        // Four times the solid angle of a quadrant, atan(h^2 / sqrt(1 + 2 h^2)) = angle / 4.
        const double t = std::tan(std::min(angle, 0.9 * 2 * pi) / 4);
        halfWidth = halfHeight = std::sqrt(t * t + t * std::sqrt(t * t + 1));
    }
    const double c = std::cos(turn), s = std::sin(turn);
    std::array<Direction, 4> corners;
    constexpr double signs[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    for (std::size_t k = 0; k < 4; ++k) {
        const double x = signs[k][0] * halfWidth, y = signs[k][1] * halfHeight;
        const double u = c * x - s * y, v = s * x + c * y;
        corners[k] = {towards.x + u * along.x + v * down.x, towards.y + u * along.y + v * down.y,
                      towards.z + u * along.z + v * down.z};
    }
    return corners;
}

}  // namespace

std::vector<AreaLight> areaLights(std::span<const Light> lights, std::size_t count) {
    std::vector<AreaLight> result;
    std::vector<Light> spread;
    for (const Light& light : lights) {
        if (const auto* panel = std::get_if<PanelLight>(&light)) {
            result.push_back(
                {squareTowards(panel->towards, 0, panel->turn, std::tan(panel->width / 2),
                               std::tan(panel->height / 2)),
                 panel->radiance});
        } else if (const auto* disc = std::get_if<DiscLight>(&light)) {
            const double angle = 4 * pi * std::pow(std::sin(disc->radius / 2), 2);
            result.push_back({squareTowards(disc->towards, angle, 0, 0, 0), disc->radiance});
        } else if (const auto* beam = std::get_if<DirectionalLight>(&light)) {
            const double angle = leastAngle * leastAngle * 4;
            AreaLight square{squareTowards(beam->towards, angle, 0, 0, 0), beam->irradiance};
            for (double& value : square.radiance) value /= angle;
            result.push_back(square);
        } else {
            spread.push_back(light);
        }
    }
    if (!spread.empty()) addTiles(spread, std::max<std::size_t>(count, 6), result);
    return result;
}

}  // namespace hshfit::lighting
