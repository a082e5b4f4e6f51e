#include <brdfs/fit/ltc_lobe.h>

#include <brdfs/fit/ltc_nodes.h>
#include <hshfit/error.h>

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <array>
#include <cmath>

namespace hshfit::brdfs {
namespace {

/// `change` applied to where `reference` takes directions: W = change * reference.
template <class Number>
LtcMatrix<Number> product(const LtcMatrix<Number>& change, const Ltc& reference) {
    return {.a = change.a * reference.a + change.b * reference.c,
            .c = change.c * reference.a + change.d * reference.c,
            .b = change.a * reference.b + change.b * reference.d,
            .d = change.c * reference.b + change.d * reference.d};
}

/// Residuals whose squares add up to the integral of |f cos - magnitude D|^3, over the largest
/// (f cos)^3 d omega. In the frame of the reference the four numbers are all of order 1, however
/// narrow the lobe; blocks: d, then a, c, b.
class CubedError final : public ceres::CostFunction {
public:
    CubedError(const LtcNodes& nodes, double magnitude) : nodes_(nodes), magnitude_(magnitude) {
        set_num_residuals(static_cast<int>(nodes.wi.size()));
        *mutable_parameter_block_sizes() = {1, 3};
        double sum = 0;
        for (std::size_t k = 0; k < nodes.wi.size(); ++k)
            sum += nodes.weights[k] * nodes.values[k] * nodes.values[k] * nodes.values[k];
        scale_ = std::cbrt(1 / sum);
    }

    bool Evaluate(double const* const* parameters, double* residuals,
                  double** jacobians) const override {
        using Jet = ceres::Jet<double, 4>;
        const LtcMatrix<Jet> change{.a = {parameters[1][0], 1},
                                    .c = {parameters[1][1], 2},
                                    .b = {parameters[1][2], 3},
                                    .d = {parameters[0][0], 0}};
        if (!(change.determinant().a > 0)) return false;
        for (std::size_t k = 0; k < nodes_.wi.size(); ++k) {
            const double factor = magnitude_ / nodes_.stretches[k] * scale_;
            const Jet density = change.density(nodes_.cosines[k]);
            const double difference = factor * density.a - scale_ * nodes_.values[k];
            const double root = std::sqrt(std::abs(difference) * nodes_.weights[k]);
            residuals[k] = difference * root;
            if (!jacobians) continue;
            const double slope = 1.5 * root * factor;
            if (jacobians[0]) jacobians[0][k] = slope * density.v[0];
            if (!jacobians[1]) continue;
            for (int p = 0; p < 3; ++p) jacobians[1][3 * k + p] = slope * density.v[p + 1];
        }
        return true;
    }

private:
    const LtcNodes& nodes_;
    double magnitude_, scale_ = 1;
};

/// The integral of f cos (1 - cos theta_d)^5: 2 cos^2 theta_d = 1 + wi.wo.
double fresnelIntegral(const LtcNodes& nodes, const Direction& wo) {
    double sum = 0;
    for (std::size_t k = 0; k < nodes.wi.size(); ++k) {
        const double rest = 1 - std::sqrt(std::max(0.0, (1 + dot(nodes.wi[k], wo)) / 2));
        sum += nodes.weights[k] * nodes.values[k] * std::pow(rest, 5);
    }
    return sum;
}

void judge(LtcLobe& lobe, const LtcNodes& nodes) {
    double cubes = 0, differences = 0, absolute = 0;
    for (std::size_t k = 0; k < nodes.wi.size(); ++k) {
        const double value = nodes.values[k];
        const double difference = std::abs(value - lobe.magnitude * lobe.ltc.density(nodes.wi[k]));
        cubes += nodes.weights[k] * value * value * value;
        differences += nodes.weights[k] * difference * difference * difference;
        absolute += nodes.weights[k] * difference;
    }
    lobe.error = std::cbrt(differences / cubes);
    lobe.misplaced = absolute / 2 / lobe.magnitude;
}

struct Step {
    LtcMatrix<double> change;
    int iterations = 0;
    bool converged = false;
};

/// One minimisation with the nodes as they are.
Step minimise(const LtcNodes& nodes, double magnitude, bool symmetric) {
    double depth = 1;
    std::array<double, 3> rest{1, 0, 0};
    ceres::Problem::Options problemOptions;
    problemOptions.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    CubedError cost(nodes, magnitude);
    ceres::Problem problem(problemOptions);
    problem.AddResidualBlock(&cost, nullptr, &depth, rest.data());
    if (symmetric) problem.SetParameterBlockConstant(rest.data());

    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.logging_type = ceres::SILENT;
    options.max_num_iterations = 60;
    options.function_tolerance = 1e-9;
    options.num_threads = 1;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    return {{.a = rest[0], .c = rest[1], .b = rest[2], .d = depth},
            static_cast<int>(summary.iterations.size()),
            summary.termination_type == ceres::CONVERGENCE};
}

/// The distance of the change from the identity.
double distance(const LtcMatrix<double>& m) {
    return std::max({std::abs(m.a - 1), std::abs(m.c), std::abs(m.b), std::abs(m.d - 1)});
}

double positiveIntegral(const Brdf& brdf, const Direction& wo, const LtcNodes& nodes) {
    const double magnitude = nodes.integral();
    if (magnitude > 0) return magnitude;
    throw NumericError(fmt::format("{}: is 0 wherever it was looked at for wo at {:.4f},0 degrees",
                                   brdf.name(), degrees(polarAngle(wo))));
}

}  // namespace

LtcLobe judgeLtc(const Brdf& brdf, const Direction& wo, const Ltc& ltc, const Ltc& around) {
    constexpr double settled = 2e-4;
    constexpr int mostNodes = 30;
    LtcLobe before;
    for (LtcRule rule = fineRule();; rule.nodes += rule.nodes / 2) {
        const LtcNodes nodes(brdf, wo, around, rule);
        LtcLobe lobe{.ltc = ltc, .magnitude = positiveIntegral(brdf, wo, nodes)};
        lobe.fresnel = fresnelIntegral(nodes, wo);
        lobe.uncertainty = std::max(std::abs(before.magnitude - lobe.magnitude),
                                    std::abs(before.fresnel - lobe.fresnel)) /
                           lobe.magnitude;
        judge(lobe, nodes);
        if (lobe.uncertainty < settled || rule.nodes >= mostNodes) return lobe;
        before = lobe;
    }
}

LtcLobe fitLtc(const Brdf& brdf, const Direction& wo, const Ltc& start,
               const LtcFitOptions& options) {
    Ltc ltc = start;
    int iterations = 0;
    bool converged = false;
    const LtcRule rule = settledRule(brdf, wo, start, coarseRule(), 2e-3, 12);
    for (int round = 0; round < options.rounds && !converged; ++round) {
        const LtcNodes nodes(brdf, wo, ltc, rule);
        const Step step = minimise(nodes, positiveIntegral(brdf, wo, nodes), options.symmetric);
        iterations += step.iterations;
        ltc = product(step.change, ltc);
        converged = step.converged && distance(step.change) < options.settled;
    }
    LtcLobe lobe = judgeLtc(brdf, wo, ltc, ltc);
    lobe.iterations = iterations;
    lobe.converged = converged;
    return lobe;
}

Ltc firstLtc(const Brdf& brdf, const Direction& wo) {
    double along = 1, across = 1;
    for (const Lobe& hint : brdf.lobes(wo)) {
        // A half vector turned by an angle turns wi by twice as much in the plane of incidence, and
        // by 2 cos theta_o as much across it.
        const bool halfway = hint.about == Lobe::About::halfway;
        along = std::min(along, hint.width * (halfway ? 2 : 1));
        across = std::min(across, hint.width * (halfway ? 2 * wo.z : 1));
    }
    // W of a lobe about +z is diag(1 / along, 1 / across, 1) up to a factor.
    const Ltc upright{.a = across / along, .c = 0, .b = 0, .d = across};
    return turned(upright, -polarAngle(wo));
}

}  // namespace hshfit::brdfs
