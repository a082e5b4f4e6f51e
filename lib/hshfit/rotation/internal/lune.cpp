#include <hshfit/rotation/internal/lune.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/quadrature/quadrature.h>
#include <hshfit/stop_request.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline rotation {
namespace {

using Matrix = linear_algebra::RowMajor;

/// A node in a: its distances from pi/2, the horizon after the rotation, and from beta - pi/2, the
/// horizon before it.
struct AzimuthNode {
    double after, before, weight;
};

constexpr double smallestPanel = 1e-6;  // adds errors of its square

/// The change of the angle of shifted functions, arccos(2 z - 1), between the horizon and a
/// distance from it: some 2 sqrt(distance), much more than the distance itself where it is small.
double shiftedTurn(double distance) {
    return pi - std::acos(2 * std::sin(std::min(distance, pi / 2)) - 1);
}

/// Twice the degree is the frequency of a product of two functions, in the angle or, next to the
/// horizon, in the shifted angle.
std::vector<AzimuthNode> azimuthNodes(double length, double beta, int order, double density) {
    std::vector<double> breaks = {0};
    for (double end = std::max(beta, smallestPanel); end < length / 2; end *= 4)
        breaks.push_back(end);
    breaks.push_back(length / 2);
    std::vector<AzimuthNode> nodes;
    for (std::size_t p = 0; p + 1 < breaks.size(); ++p) {
        const double low = breaks[p], width = breaks[p + 1] - low;
        const double share = order * (p == 0 ? std::max(2 * width, shiftedTurn(width)) : width);
        const GaussRule& rule = gaussLegendre(static_cast<int>(std::ceil(density * (16 + share))));
        for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
            const double s = (1 + rule.nodes[i]) / 2;
            const double distance = p == 0 ? width * s * s : low + width * s;
            const double weight = rule.weights[i] / 2 * width * (p == 0 ? 2 * s : 1);
            nodes.push_back({distance, length - distance, weight});
            nodes.push_back({length - distance, distance, weight});
        }
    }
    return nodes;
}

/// Nodes of the half of the lune with y > 0.
struct LuneNodes {
    std::vector<double> x, y, z, fromX, fromZ, weight;
};

LuneNodes luneNodes(double beta, int order, double density) {
    LuneNodes nodes;
    const double length = pi - beta;
    if (!(length > 0)) return nodes;
    const std::vector<AzimuthNode> azimuths = azimuthNodes(length, beta, order, density);
    const GaussRule& rule = gaussLegendre(static_cast<int>(std::ceil(density * (24 + 2 * order))));
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
        const double s = (1 + rule.nodes[i]) / 2, t = pi / 2 * s * s;
        const double sine = std::sin(t), cosine = std::cos(t);
        for (const AzimuthNode& a : azimuths) {
            nodes.x.push_back(sine * std::cos(a.after));
            nodes.y.push_back(cosine);
            nodes.z.push_back(sine * std::sin(a.after));
            nodes.fromX.push_back(-sine * std::cos(a.before));
            nodes.fromZ.push_back(sine * std::sin(a.before));
            nodes.weight.push_back(rule.weights[i] / 2 * pi * s * sine * a.weight);
        }
    }
    return nodes;
}

/// Slots of cosines (m >= 0) and of sines.
std::vector<Eigen::Index> slotsOf(int order, bool sines) {
    std::vector<Eigen::Index> slots;
    for (int l = 0; l < order; ++l)
        for (int m = sines ? -l : 0; sines ? m < 0 : m <= l; ++m) slots.push_back(slotOf(l, m));
    return slots;
}

/// Values at directions, a row a slot.
Matrix valuesAt(const Basis& basis, DirectionBatch directions, bool analysis) {
    const auto count = static_cast<Eigen::Index>(directions.count);
    Matrix values(basis.slots(), count);
    if (!analysis) {
        basis.evaluateColumns(directions, values.data());
        return values;
    }
    std::vector<Elevation<double>> points;
    Matrix azimuths(count, 2 * basis.order() - 1);
    for (std::size_t k = 0; k < directions.count; ++k) {
        const Direction d{directions.x[k], directions.y[k], directions.z[k]};
        points.push_back(elevationOf(d));
        azimuthParts(d, basis.order(), basis.condonShortley(),
                     azimuths.row(static_cast<Eigen::Index>(k)).data());
    }
    for (int m = 0; m < basis.order(); ++m) {
        Matrix parts(basis.order() - m, count);
        basis.analysisTheta(m, points, parts.data());
        for (int l = m; l < basis.order(); ++l)
            for (const int order : {m, -m})
                values.row(slotOf(l, order)) = parts.row(l - m).cwiseProduct(
                    azimuths.col(basis.order() - 1 + order).transpose());
    }
    return values;
}

}  // namespace

LuneIntegrals luneIntegrals(const Basis& basis, double beta, const Matrix& c,
                            LuneFunctions functions, double density) {
    constexpr std::size_t parts = 16;
    // Nodes together: their values of all functions stay in the cache, where they are fetched from
    // six times.
    constexpr std::size_t valuesInCache = std::size_t{1} << 17;
    const std::size_t chunk = std::clamp<std::size_t>(
        valuesInCache / static_cast<std::size_t>(basis.slots()) / 8 * 8, 8, 256);
    const int degree = bases::highestDegree(basis) + 1;
    const LuneNodes nodes = luneNodes(beta, degree, density);
    const bool projected = basis.inner() == Basis::Inner::projectedSolidAngle;
    const Eigen::Index vectors = c.cols();
    // A fixed number of partial sums: results do not depend on the number of threads.
    std::vector<LuneIntegrals> partial(
        parts, {Matrix::Zero(c.rows(), vectors), std::vector<double>(vectors, 0.0),
                std::vector<double>(vectors, 0.0)});
    const std::size_t chunks = (nodes.x.size() + chunk - 1) / chunk;
    tbb::parallel_for(std::size_t{0}, parts, [&](std::size_t part) {
        LuneIntegrals& sum = partial[part];
        for (std::size_t b = part; b < chunks; b += parts) {
            stopIfRequested();
            const std::size_t first = b * chunk, n = std::min(chunk, nodes.x.size() - first);
            const DirectionBatch to{&nodes.x[first], &nodes.y[first], &nodes.z[first], n};
            const DirectionBatch from{&nodes.fromX[first], &nodes.y[first], &nodes.fromZ[first], n};
            const Matrix sources = valuesAt(basis, from, false);
            Matrix targets;
            if (functions != LuneFunctions::source)
                targets = valuesAt(basis, to, functions == LuneFunctions::analysis);
            Eigen::VectorXd after(n), before(n);
            for (std::size_t k = 0; k < n; ++k) {
                // Both halves of the lune: cosines are even in y and sines odd, and do not mix.
                const double weight = 2 * nodes.weight[first + k];
                const auto row = static_cast<Eigen::Index>(k);
                after(row) = weight * (projected ? to.z[k] : 1);
                before(row) = weight * (projected ? from.z[k] : 1);
            }
            for (const bool sines : {false, true}) {
                const std::vector<Eigen::Index> slots = slotsOf(basis.order(), sines);
                if (slots.empty()) continue;
                const Matrix source = sources(slots, Eigen::all);
                const Matrix f = source.transpose() * c(slots, Eigen::all);
                const bool still = functions == LuneFunctions::source;
                const Matrix weighted = (still ? before : after).asDiagonal() * f;
                const Matrix moments = still
                                           ? Matrix(source * weighted)
                                           : Matrix(Matrix(targets(slots, Eigen::all)) * weighted);
                for (std::size_t i = 0; i < slots.size(); ++i)
                    sum.moments.row(slots[i]) += moments.row(static_cast<Eigen::Index>(i));
                for (Eigen::Index v = 0; v < vectors; ++v) {
                    const auto at = static_cast<std::size_t>(v);
                    sum.energy[at] += f.col(v).cwiseAbs2().dot(after);
                    sum.stayed[at] += f.col(v).cwiseAbs2().dot(before);
                }
            }
        }
    });
    for (std::size_t part = 1; part < parts; ++part) {
        partial[0].moments += partial[part].moments;
        for (std::size_t v = 0; v < partial[0].energy.size(); ++v) {
            partial[0].energy[v] += partial[part].energy[v];
            partial[0].stayed[v] += partial[part].stayed[v];
        }
    }
    return partial[0];
}

}  // namespace hshfit::inline rotation
