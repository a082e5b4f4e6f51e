#include <hshfit/wavelets/subdivision.h>

#include <hshfit/brdf/vectors.h>

#include <algorithm>
#include <cmath>

namespace hshfit::wavelets {
namespace {

/// tan(c / 2) of the arc c between two corners.
double halfTangent(const Direction& a, const Direction& b) {
    const Direction chord = b - a;
    const double sine = 0.5 * std::sqrt(dot(chord, chord));
    return sine / std::sqrt((1 - sine) * (1 + sine));
}

/// The point on the arc from a to b, with c = tan(length / 2), at tan(distance / 2) = t.
Direction onArc(const Direction& a, const Direction& b, double c, double t) {
    const double whole = 2 * std::atan(c), x = 2 * std::atan(t);
    const double u = std::sin(whole - x) / std::sin(whole), v = std::sin(x) / std::sin(whole);
    return normalised({u * a.x + v * b.x, u * a.y + v * b.y, u * a.z + v * b.z});
}

/// t -> (a t + b) / (c t + d).
struct Mobius {
    double a, b, c, d;
    double operator()(double t) const { return (a * t + b) / (c * t + d); }
    Mobius after(const Mobius& first) const {
        return {a * first.a + b * first.c, a * first.b + b * first.d, c * first.a + d * first.c,
                c * first.b + d * first.d};
    }
    /// The discriminant of the quadratic equation of fixed points.
    double discriminant() const { return (d - a) * (d - a) + 4 * b * c; }
    double fixedPoint() const { return (a - d) / (2 * c); }
};

/// Sides and angles: side[i] is tan(c / 2) of the edge from corner i to the next one.
class Corners {
public:
    explicit Corners(const Triangle& triangle) {
        for (std::size_t i = 0; i < 3; ++i) {
            const Direction& here = triangle.corners[i];
            const Direction& next = triangle.corners[(i + 1) % 3];
            const Direction u = next - here;
            const Direction w = triangle.corners[(i + 2) % 3] - here;
            const double volume = dot(here, cross(u, w));
            const double level = dot(u, w) - dot(here, u) * dot(here, w);
            const double length = std::hypot(volume, level);
            sine_[i] = volume / length;
            cosine_[i] = level / length;
            side[i] = halfTangent(here, next);
        }
    }

    /// Two sides p and q of a corner triangle of area E have
    ///     tan(p / 2) tan(q / 2) = tan(E / 2) / (sin g - tan(E / 2) cos g).
    double product(std::size_t corner, double tangent) const {
        return tangent / (sine_[corner] - tangent * cosine_[corner]);
    }
    /// The map from the new corner on the edge that begins at corner i to the new corner on the
    /// next edge, so that corner i + 1 has the area.
    Mobius step(std::size_t i, double tangent) const {
        const double k = product((i + 1) % 3, tangent);
        return {k * side[i], k, -1, side[i]};
    }
    /// The map around the triangle, back to the first edge: fixed points are subdivisions.
    Mobius around(double tangent) const {
        return step(2, tangent).after(step(1, tangent).after(step(0, tangent)));
    }

    std::array<double, 3> side{};

private:
    std::array<double, 3> sine_{}, cosine_{};
};

/// tan(E / 2) of the largest equal areas: there the two subdivisions coincide.
double largestTangent(const Corners& corners, double area) {
    double low = 0.5 * std::tan(0.1 * area), high = std::tan(area / 6);
    double value = corners.around(low).discriminant(), at = low;
    // Regula falsi, Illinois, in a bracket that it keeps.
    double end = corners.around(high).discriminant();
    int side = 0;
    for (int step = 0; step < 100; ++step) {
        const double next = (low * end - high * value) / (end - value);
        if (!(next > low && next < high)) break;
        at = next;
        const double here = corners.around(at).discriminant();
        if (here == 0) break;
        if (here > 0) {
            low = at;
            value = here;
            if (side == 1) end /= 2;
            side = 1;
        } else {
            high = at;
            end = here;
            if (side == -1) value /= 2;
            side = -1;
        }
    }
    return at;
}

}  // namespace

double areaOf(const std::array<Direction, 3>& corners) {
    const auto& [a, b, c] = corners;
    const double volume = dot(a, cross(b - a, c - a));
    return 2 * std::atan2(volume, 1 + dot(a, b) + dot(b, c) + dot(c, a));
}

std::array<Triangle, 8> octants() {
    const std::array<Direction, 4> ring{{{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}}};
    std::array<Triangle, 8> all{};
    for (std::size_t q = 0; q < 4; ++q) {
        all[q] = {{ring[q], ring[(q + 1) % 4], {0, 0, 1}}, pi / 2};
        all[4 + q] = {{ring[(q + 1) % 4], ring[q], {0, 0, -1}}, pi / 2};
    }
    return all;
}

std::array<Triangle, 4> subdivided(const Triangle& triangle) {
    const Corners corners(triangle);
    const double tangent = largestTangent(corners, triangle.area);
    std::array<double, 3> t{};
    t[0] = corners.around(tangent).fixedPoint();
    t[1] = corners.step(0, tangent)(t[0]);
    t[2] = corners.step(1, tangent)(t[1]);
    std::array<Direction, 3> on{};
    for (std::size_t i = 0; i < 3; ++i) {
        on[i] = onArc(triangle.corners[i], triangle.corners[(i + 1) % 3], corners.side[i], t[i]);
    }
    const auto& v = triangle.corners;
    const double outer = 2 * std::atan(tangent);
    return {Triangle{{on[1], on[2], on[0]}, triangle.area - 3 * outer},
            {{v[0], on[0], on[2]}, outer},
            {{on[0], v[1], on[1]}, outer},
            {{on[2], on[1], v[2]}, outer}};
}

}  // namespace hshfit::wavelets
