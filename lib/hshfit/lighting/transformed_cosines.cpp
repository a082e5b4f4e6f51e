#include <hshfit/lighting/transformed_cosines.h>

#include <hshfit/lighting/harmonics.h>

#include <algorithm>
#include <cmath>

namespace hshfit::lighting {
namespace {

using Corners = std::array<Direction, 6>;

struct Polygon {
    Corners corners;
    std::size_t count = 0;
    void add(const Direction& d) { corners[count++] = d; }
};

/// The part of a convex polygon above z = 0.
Polygon above(const Polygon& polygon) {
    Polygon result;
    for (std::size_t k = 0; k < polygon.count; ++k) {
        const Direction& p = polygon.corners[k];
        const Direction& q = polygon.corners[k + 1 == polygon.count ? 0 : k + 1];
        if (p.z > 0) result.add(p);
        if ((p.z > 0) == (q.z > 0)) continue;
        const double t = p.z / (p.z - q.z);
        result.add({p.x + t * (q.x - p.x), p.y + t * (q.y - p.y), 0});
    }
    return result;
}

/// Lambert's formula: the sum over edges of the angle times the z of the unit normal of its plane.
double edges(const Polygon& polygon) {
    double sum = 0;
    for (std::size_t k = 0; k < polygon.count; ++k) {
        const Direction& p = polygon.corners[k];
        const Direction& q = polygon.corners[k + 1 == polygon.count ? 0 : k + 1];
        const Direction n{p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x};
        const double sine = std::sqrt(dot(n, n));
        if (sine > 0) sum += n.z / sine * std::atan2(sine, dot(p, q));
    }
    return std::abs(sum) / (2 * pi);
}

Polygon polygonOf(const std::array<Direction, 4>& corners) {
    Polygon polygon;
    for (const Direction& d : corners) polygon.add(d);
    return polygon;
}

}  // namespace

double TransformedCosine::share() const {
    // The surface's normal is taken to the third row of the inverse.
    const double x = e * g - c, y = a * g;
    return (1 + a / std::sqrt(a * a + x * x + y * y)) / 2;
}

CosineTable cosineTable(std::span<const CosineRow> rows, AzimuthNodes azimuths, bool inPlane) {
    const std::size_t count = rows.size() / azimuths.count;
    CosineTable result{ElevationTable({.count = count}, inPlane ? 3 : 4, azimuths)};
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const TransformedCosine& lobe = rows[k].lobe;
        const std::span<double> row = result.table.row(k % count, k / count);
        for (std::size_t c = 0; c < 3; ++c) {
            row[c] = rows[k].even[c];
            row[4 + c] = rows[k].rest[c] / lobe.share();
        }
        row[3] = lobe.a;
        row[7] = lobe.b;
        row[8] = lobe.c;
        row[9] = lobe.d;
        if (inPlane) continue;
        row[10] = lobe.e;
        row[11] = lobe.f;
        row[12] = lobe.g;
    }
    return result;
}

double formFactor(const std::array<Direction, 4>& corners) {
    return edges(above(polygonOf(corners)));
}

Rgb radiance(const CosineTable& table, std::span<const AreaLight> lights, const Direction& normal,
             const Direction& viewer, const Direction& tangent) {
    ViewAxes axes(normal, viewer, tangent);
    Rgb sum{};
    if (!(axes.cosine > 0)) return sum;
    std::array<double, 16> row{};
    if (table.table.at(axes.cosine, axes.azimuth, {row.data(), 4 * table.table.texels}))
        axes.mirror();
    for (const AreaLight& light : lights) {
        Polygon polygon;
        for (const Direction& corner : light.corners) polygon.add(axes.toLocal(corner));
        polygon = above(polygon);
        if (polygon.count == 0) continue;
        const double even = edges(polygon);
        for (std::size_t k = 0; k < polygon.count; ++k) {
            Direction& p = polygon.corners[k];
            p = {row[3] * p.x + row[7] * p.z, row[10] * p.x + p.y + row[11] * p.z,
                 row[8] * p.x + row[12] * p.y + row[9] * p.z};
        }
        const double rest = edges(above(polygon));
        for (std::size_t c = 0; c < 3; ++c)
            sum[c] += light.radiance[c] * (row[c] * even + row[4 + c] * rest);
    }
    return sum;
}

}  // namespace hshfit::lighting
