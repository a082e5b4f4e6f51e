#include <hshfit/representation/factoring/factoring.h>

#include <hshfit/linear_algebra/decompositions.h>
#include <hshfit/quadrature/quadrature.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline representation::inline factoring {
namespace {

/// Directions over wi and the roots of their weights.
struct Nodes {
    std::vector<double> x, y, z, roots;
};

/// Gauss-Legendre nodes in sqrt(cos theta) times equispaced azimuths, twice as many.
Nodes nodesOf(int rings, Basis::Inner inner) {
    const GaussRule& rule = gaussLegendre(rings);
    Nodes nodes;
    const int azimuths = 2 * rings;
    for (int r = 0; r < rings; ++r) {
        const double u = (1 + rule.nodes[static_cast<std::size_t>(r)]) / 2, mu = u * u;
        double weight = rule.weights[static_cast<std::size_t>(r)] * u * 2 * pi / azimuths;
        if (inner == Basis::Inner::projectedSolidAngle) weight *= mu;
        const double sine = std::sqrt((1 - mu) * (1 + mu));
        for (int j = 0; j < azimuths; ++j) {
            const double phi = (j + 0.5) * 2 * pi / azimuths;
            nodes.x.push_back(sine * std::cos(phi));
            nodes.y.push_back(sine * std::sin(phi));
            nodes.z.push_back(mu);
            nodes.roots.push_back(std::sqrt(weight));
        }
    }
    return nodes;
}

/// [row][row] inner products of the weighted rows.
Eigen::MatrixXd gramOf(const Brdf& brdf, const OutgoingSet& outgoing, Quantity quantity,
                       const Nodes& nodes) {
    constexpr std::size_t atOnce = 4096;  // nodes: bounds the memory
    const std::size_t channels = brdf.channels().count();
    const auto rows = static_cast<Eigen::Index>(outgoing.size() * channels);
    Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(rows, rows);
    for (std::size_t first = 0; first < nodes.x.size(); first += atOnce) {
        const std::size_t count = std::min(atOnce, nodes.x.size() - first);
        const DirectionBatch wi{&nodes.x[first], &nodes.y[first], &nodes.z[first], count};
        Eigen::MatrixXd values(static_cast<Eigen::Index>(count), rows);
        tbb::parallel_for(std::size_t{0}, outgoing.size(), [&](std::size_t o) {
            double* out = values.data() + o * channels * count;
            brdf.eval(outgoing.directions[o], wi, out);
            const double root = std::sqrt(outgoing.solidAngles[o]);
            for (std::size_t i = 0; i < channels * count; ++i) {
                const std::size_t k = first + i % count;
                const double cosine = quantity == Quantity::brdfCosine ? nodes.z[k] : 1;
                out[i] *= root * nodes.roots[k] * cosine;
            }
        });
        gram.selfadjointView<Eigen::Lower>().rankUpdate(values.transpose());
    }
    return gram;
}

/// Roots of the eigenvalues, falling. The squares are right to 1e-15 of the largest, so that values
/// below 3e-8 of the largest are rounding errors.
std::vector<double> singularValues(const Eigen::MatrixXd& gram) {
    const Eigen::VectorXd values =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(gram, Eigen::EigenvaluesOnly).eigenvalues();
    std::vector<double> result;
    for (Eigen::Index i = values.size(); i-- > 0;) {
        result.push_back(std::sqrt(std::max(values(i), 0.0)));
    }
    return result;
}

double largestChange(const std::vector<double>& a, const std::vector<double>& b) {
    double change = 0;
    for (std::size_t i = 0; i < a.size(); ++i) change = std::max(change, std::abs(a[i] - b[i]));
    return change;
}

}  // namespace

double SliceSpectrum::relativeError(std::size_t rank) const {
    double tail = 0, all = 0;
    for (std::size_t i = values.size(); i-- > 0;) {
        all += values[i] * values[i];
        if (i >= rank) tail = all;
    }
    return all > 0 ? std::sqrt(tail / all) : 0;
}

SliceSpectrum sliceSpectrum(const Brdf& brdf, const OutgoingSet& outgoing, Quantity quantity,
                            Basis::Inner inner) {
    constexpr int mostRings = 192;
    SliceSpectrum spectrum;
    for (int rings = 24; rings <= mostRings && !spectrum.converged; rings *= 2) {
        const std::vector<double> values =
            singularValues(gramOf(brdf, outgoing, quantity, nodesOf(rings, inner)));
        spectrum.converged = !spectrum.values.empty() &&
                             largestChange(values, spectrum.values) <= 1e-3 * values.front();
        spectrum.values = values;
    }
    return spectrum;
}

}  // namespace hshfit::inline representation::inline factoring
