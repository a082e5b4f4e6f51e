#include <brdfs/analytic/sheen_albedo.h>

#include <brdfs/analytic/charlie.h>
#include <brdfs/rows/model.h>
#include <hshfit/brdf/directions.h>
#include <hshfit/quadrature/quadrature.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace hshfit::brdfs {
namespace {

/// Directions over half of the hemisphere, which the plane of wo and the normal cuts, and their
/// weights times cos(theta_i).
struct Nodes {
    std::vector<double> x, y, z, weights;

    Nodes() {
        constexpr int heights = 24;
        const GaussRule& rule = gaussLegendre(heights);
        // Lambda has a kink at 1/2 and a root's slope at the horizon.
        for (int i = 0; i < heights; ++i) {
            const double u = 0.5 * (1 + rule.nodes[i]), weight = 0.25 * rule.weights[i];
            add(0.5 * u * u * u, 3 * u * u * weight);
            add(0.5 + 0.5 * u, weight);
        }
    }

private:
    void add(double height, double weight) {
        constexpr int azimuths = 32;
        for (int k = 0; k < azimuths; ++k) {
            const double phi = (k + 0.5) / azimuths * pi, sine = std::sqrt(1 - height * height);
            x.push_back(sine * std::cos(phi));
            y.push_back(sine * std::sin(phi));
            z.push_back(height);
            weights.push_back(2 * pi / azimuths * weight * height);
        }
    }
};

double albedo(const Brdf& lobe, const Nodes& nodes, double height) {
    std::vector<double> f(nodes.z.size());
    lobe.eval({std::sqrt(1 - height * height), 0, height},
              {nodes.x.data(), nodes.y.data(), nodes.z.data(), nodes.z.size()}, f.data());
    return std::min(1.0, std::inner_product(f.begin(), f.end(), nodes.weights.begin(), 0.0));
}

struct Cubic {
    double value, slope;
};
/// Catmull and Rom's cubic between b and c.
Cubic cubic(double a, double b, double c, double d, double t) {
    const double k1 = c - a, k2 = 2 * a - 5 * b + 4 * c - d, k3 = 3 * (b - c) + d - a;
    return {b + 0.5 * t * (k1 + t * (k2 + t * k3)), 0.5 * (k1 + t * (2 * k2 + 3 * t * k3))};
}

}  // namespace

SheenAlbedoTable::SheenAlbedoTable() {
    const Nodes nodes;
    for (int j = 0; j < roughnesses; ++j) {
        const double roughness = leastRoughness + (1 - leastRoughness) * j / (roughnesses - 1);
        const Model charlie = charlieModel();
        const auto lobe = charlie.make(parseParameters(charlie.name, charlie.parameters,
                                                       fmt::format("r={}", roughness * roughness)));
        Row& row = rows_[j + 1];
        for (int k = 0; k <= steps; ++k) {
            // E at the horizon is its limit, from a height at which nothing underflows.
            const double root = std::max(static_cast<double>(k) / steps, 1e-4);
            row[k + 1] = albedo(*lobe, nodes, root * root);
        }
        row.front() = 2 * row[1] - row[2];
        row.back() = 2 * row[steps + 1] - row[steps];
    }
    for (std::size_t k = 0; k < Row().size(); ++k) {
        rows_.front()[k] = 2 * rows_[1][k] - rows_[2][k];
        rows_.back()[k] = 2 * rows_[roughnesses][k] - rows_[roughnesses - 1][k];
    }
}

const SheenAlbedoTable& SheenAlbedoTable::instance() {
    static const SheenAlbedoTable table;
    return table;
}

void SheenAlbedoTable::at(double roughness, Row& values, Row& slopes) const {
    constexpr double scale = (roughnesses - 1) / (1 - leastRoughness);
    const double x = scale * (std::clamp(roughness, leastRoughness, 1.0) - leastRoughness);
    const int j = std::min(static_cast<int>(x), roughnesses - 2);
    for (std::size_t k = 0; k < values.size(); ++k) {
        const Cubic own =
            cubic(rows_[j][k], rows_[j + 1][k], rows_[j + 2][k], rows_[j + 3][k], x - j);
        values[k] = own.value;
        slopes[k] = roughness < leastRoughness ? 0 : scale * own.slope;
    }
}

}  // namespace hshfit::brdfs
