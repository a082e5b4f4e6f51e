#include <brdfs/measured/rgl_normals.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace hshfit::brdfs {
namespace {

// sigma is smooth, since it is an integral over half of the hemisphere.
constexpr std::size_t coarseRows = 33, coarseColumns = 33;

double coordinate(std::size_t i, std::size_t count) {
    return static_cast<double>(i) / static_cast<double>(count - 1);
}

Direction normalAt(double u, double v, double turn = 0) {
    return directionFromAngles(u * u * pi / 2, (v - 0.5) * 2 * pi + turn);
}

/// Midpoints of a grid over (u, v) with D times the solid angle.
struct Facets {
    std::vector<double> x, y, z, weight;

    explicit Facets(const Plane& ndf) {
        const std::size_t columns = std::max<std::size_t>(2 * (ndf.columns - 1), 128);
        const std::size_t rows = std::max<std::size_t>(ndf.rows - 1, 64);
        for (std::size_t r = 0; r < rows; ++r) {
            for (std::size_t c = 0; c < columns; ++c) {
                const double u = (static_cast<double>(c) + 0.5) / static_cast<double>(columns);
                const double v = (static_cast<double>(r) + 0.5) / static_cast<double>(rows);
                const Direction h = normalAt(u, v);
                x.push_back(h.x), y.push_back(h.y), z.push_back(h.z);
                weight.push_back(ndf.at(u, v) * normalsJacobian(u) /
                                 static_cast<double>(rows * columns));
            }
        }
    }

    double projectedArea(const Direction& w) const {
        double sum = 0;
        for (std::size_t k = 0; k < weight.size(); ++k) {
            sum += weight[k] * std::max(x[k] * w.x + y[k] * w.y + z[k] * w.z, 0.0);
        }
        return sum;
    }
};

/// Makes the integral of D cos(theta) 1; false if there is nothing to scale.
bool normalise(Plane& ndf) {
    const double area = Facets(ndf).projectedArea({0, 0, 1});
    if (!(area > 0) || !std::isfinite(area)) return false;
    for (float& value : ndf.values) value = static_cast<float>(value / area);
    return true;
}

class Luminance {
public:
    explicit Luminance(const Brdf& brdf) : brdf_(brdf) {}

    /// 0 where f is negative or not finite.
    double at(const Direction& wi, const Direction& wo) const {
        if (!(wi.z > 0) || !(wo.z > 0)) return 0;
        const std::vector<double> f = evaluate(brdf_, wi, wo);
        const double value = brightness(brdf_.channels(), f.data());
        return std::isfinite(value) ? std::max(value, 0.0) : 0;
    }

private:
    const Brdf& brdf_;
};

/// Values of a function at the vertices of a grid over (u, v), rows in parallel. The last row
/// is a copy of the first.
template <class Function>
Plane tabulate(NormalsGrid grid, const Function& value) {
    Plane plane{grid.rows, grid.columns, std::vector<float>(grid.rows * grid.columns)};
    tbb::parallel_for(std::size_t{0}, grid.rows - 1, [&](std::size_t r) {
        for (std::size_t c = 0; c < grid.columns; ++c) {
            const double u = coordinate(c, grid.columns), v = coordinate(r, grid.rows);
            plane.values[r * grid.columns + c] = static_cast<float>(value(u, v));
        }
    });
    std::copy_n(plane.values.begin(), grid.columns, plane.values.end() - grid.columns);
    return plane;
}

/// The mean of 4 f cos(theta_i) cos(theta_o) over difference angles above the horizon.
double averagedAt(const Luminance& f, const Direction& h) {
    constexpr int elevations = 6, azimuths = 8;
    const double sine = std::sqrt(h.x * h.x + h.y * h.y);
    const double c = sine > 0 ? h.x / sine : 1, s = sine > 0 ? h.y / sine : 0;
    double sum = 0;
    int above = 0;
    for (int i = 0; i < elevations; ++i) {
        for (int j = 0; j < azimuths; ++j) {
            const double sine2 = (i + 0.5) / elevations, across = std::sqrt(sine2);
            const double phi = (j + 0.5) * 2 * pi / azimuths;
            const double dx = across * std::cos(phi), dy = across * std::sin(phi);
            const double dz = std::sqrt(1 - sine2);
            // A vector of the frame of h, turned about y by theta_h and then about z by phi_h.
            const double ex = h.z * dx + sine * dz, ez = h.z * dz - sine * dx;
            const Direction wi{c * ex - s * dy, s * ex + c * dy, ez};
            const double twice = 2 * dz;
            const Direction wo{twice * h.x - wi.x, twice * h.y - wi.y, twice * h.z - wi.z};
            if (!(wi.z > 1e-3) || !(wo.z > 1e-3)) continue;
            sum += 4 * f.at(wi, wo) * wi.z * wo.z;
            ++above;
        }
    }
    return above > 0 ? sum / above : 0;
}

/// The first eigenvector of D(w) = 4 f(w, w) cos(theta) sigma(w).
Plane powerIteration(const Plane& retro, NormalsGrid grid) {
    Plane ndf = retro;
    if (!normalise(ndf)) return {};
    for (int step = 0; step < 64; ++step) {
        const Plane sigma = projectedAreas(ndf, grid.rows > 2 ? coarseRows : 2, coarseColumns);
        Plane next = tabulate(grid, [&](double u, double v) { return sigma.at(u, v); });
        for (std::size_t i = 0; i < next.values.size(); ++i) next.values[i] *= retro.values[i];
        if (!normalise(next)) return {};
        float change = 0, most = 0;
        for (std::size_t i = 0; i < next.values.size(); ++i) {
            change = std::max(change, std::fabs(next.values[i] - ndf.values[i]));
            most = std::max(most, next.values[i]);
        }
        ndf = std::move(next);
        if (change <= 1e-5F * most) break;
    }
    return ndf;
}

}  // namespace

double normalsJacobian(double u) {
    return std::sin(u * u * pi / 2) * pi * u * 2 * pi;
}

double brightness(const Channels& channels, const double* values) {
    if (channels.kind == Channels::Kind::rgb) {
        return 0.2126 * values[0] + 0.7152 * values[1] + 0.0722 * values[2];  // Rec. 709
    }
    const std::size_t count = channels.count();
    return std::accumulate(values, values + count, 0.0) / static_cast<double>(count);
}

Plane estimateNormals(const Brdf& brdf, NormalsFrom from, NormalsGrid grid, double floor) {
    const Luminance f(brdf);
    Plane ndf;
    if (from == NormalsFrom::retroReflection) {
        const Plane retro = tabulate(grid, [&](double u, double v) {
            const Direction w = normalAt(u, v);
            return w.z > 1e-6 ? 4 * f.at(w, w) * w.z : 0;
        });
        ndf = powerIteration(retro, grid);
    } else {
        ndf = tabulate(grid, [&](double u, double v) { return averagedAt(f, normalAt(u, v)); });
        if (!normalise(ndf)) return {};
    }
    for (float& value : ndf.values) {
        value = static_cast<float>((1 - floor) * value + floor / pi);
    }
    return ndf;
}

Plane projectedAreas(const Plane& ndf, std::size_t rows, std::size_t columns) {
    const Facets facets(ndf);
    return tabulate({rows, columns},
                    [&](double u, double v) { return facets.projectedArea(normalAt(u, v)); });
}

std::vector<float> visibleNormals(const Plane& ndf, const Direction& wi, double turn,
                                  NormalsGrid grid, double share) {
    std::vector<double> densities;
    double sum = 0, seenCount = 0;
    for (std::size_t r = 0; r < grid.rows; ++r) {
        for (std::size_t c = 0; c < grid.columns; ++c) {
            const double u = coordinate(c, grid.columns), v = coordinate(r, grid.rows);
            const double seen = std::max(dot(normalAt(u, v, turn), wi), 0.0);
            densities.push_back(seen > 0 ? ndf.at(u, v) * seen * normalsJacobian(u) : -1);
            if (seen > 0) ++seenCount, sum += densities.back();
        }
    }
    // On the coarsest grids all nodes that are seen may be at the pole, where densities are 0.
    std::vector<float> values(densities.size(), 0.0F);
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (densities[i] < 0) continue;
        values[i] = static_cast<float>(
            sum > 0 ? (1 - share) * densities[i] / sum + share / seenCount : 1 / seenCount);
    }
    return values;
}

}  // namespace hshfit::brdfs
