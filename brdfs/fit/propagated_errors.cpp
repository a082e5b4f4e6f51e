#include <brdfs/fit/propagated_errors.h>

#include <brdfs/fit/instrument/turned.h>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {
namespace {

using Kind = ActsOn::Kind;

/// Per degree.
std::vector<double> shiftByAngle(
    Kind kind, const FitSamples& samples, Cosines cosines,
    const std::function<std::vector<double>(const FitSamples&)>& modelAt) {
    std::vector<double> shift(samples.values.size(), 0);
    for (const double sign : {1.0, -1.0}) {
        AngleZeros zeros;
        (kind == Kind::incidence ? zeros.incidence : zeros.detector) = sign * angleStep;
        const FitSamples own = turned(samples, {&zeros, 1});
        const std::vector<double> f = modelAt(own), ratios = cosineRatios(own, samples, cosines);
        for (std::size_t v = 0; v < shift.size(); ++v)
            shift[v] += sign * f[v] * ratios[v % samples.size()] * radians(1.0) / (2 * angleStep);
    }
    return shift;
}

double linearityOf(double value, double largest) {
    return value > 0 ? value * std::log10(value / largest) : 0;
}

BudgetRow rowOf(const Contribution& own, double sensitivity) {
    BudgetRow row;
    row.name = own.name;
    row.type = own.type;
    row.distribution = own.distribution;
    row.standard = own.standard;
    row.unit = own.on.unit;
    row.sensitivity = sensitivity;
    row.degrees = own.degrees;
    return row;
}

BudgetRow samplesRow(double error, double degrees) {
    return {.name = "samples",
            .type = 'A',
            .distribution = "normal",
            .standard = error,
            .unit = "",
            .sensitivity = 1,
            .degrees = degrees};
}

}  // namespace

std::vector<double> shiftOf(
    const Contribution& contribution, const FitSamples& samples, Cosines cosines,
    const std::function<std::vector<double>(const FitSamples& turned)>& modelAt) {
    const Kind kind = contribution.on.kind;
    if (kind == Kind::incidence || kind == Kind::detector)
        return shiftByAngle(kind, samples, cosines, modelAt);
    if (kind == Kind::scale) return samples.values;
    std::vector<double> shift(samples.values.size(), 1);
    if (kind == Kind::offset) return shift;
    const double largest = *std::ranges::max_element(samples.values);
    for (std::size_t v = 0; v < shift.size(); ++v)
        shift[v] = kind == Kind::linearity ? linearityOf(samples.values[v], largest)
                                           : 1 / samples.wo[v % samples.size()].z;
    return shift;
}

Eigen::VectorXd pullOf(const WeightedRows& rows, const std::vector<double>& shift,
                       const FitSamples& samples, Loss::Kind loss, std::size_t n,
                       std::size_t shapes) {
    Eigen::VectorXd pull = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(n));
    for (std::size_t v = 0; v < shift.size(); ++v) {
        const std::size_t k = v % samples.size();
        const double own =
            rows.whitened ? shift[v]
                          : std::sqrt(samples.weight(v / samples.size(), k)) *
                                mapValue(loss, samples.values[v], samples.wiZ[k]).slope * shift[v];
        for (std::size_t i = 0; i < rows.columns; ++i)
            pull(static_cast<Eigen::Index>(rows.place(i, v / rows.samples, shapes))) +=
                rows.slopes[v * rows.columns + i] * own;
    }
    return pull;
}

void addBudget(const std::vector<Contribution>& contributions, const CommonChanges& changes,
               const std::vector<double>& degrees, FitResult& result) {
    if (contributions.empty()) return;
    const std::size_t n = result.parameters.size(), count = contributions.size();
    Budget budget;
    std::vector<double> ofSamples(n, 0), combined(n, 0);
    for (std::size_t i = 0; i < n; ++i) {
        FittedParameter& parameter = result.parameters[i];
        if (!parameter.standardError) continue;
        ofSamples[i] = *parameter.standardError;
        ParameterBudget own{.name = parameter.name,
                            .channel = parameter.channel,
                            .value = parameter.value,
                            .rows = {samplesRow(ofSamples[i], degrees[i])}};
        for (std::size_t j = 0; j < count; ++j)
            own.rows.push_back(rowOf(contributions[j], changes.parameters[j][i]));
        combine(own);
        parameter.standardError = combined[i] = own.combined;
        budget.parameters.push_back(std::move(own));
    }
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t k = 0; k < n; ++k) {
            double covariance = result.correlations[i * n + k] * ofSamples[i] * ofSamples[k];
            for (std::size_t j = 0; j < count; ++j)
                covariance += contributions[j].standard * contributions[j].standard *
                              changes.parameters[j][i] * changes.parameters[j][k];
            const double size = combined[i] * combined[k];
            result.correlations[i * n + k] = size > 0 ? covariance / size : 0;
        }
    const auto& coefficients =
        changes.coefficients.empty() ? changes.parameters : changes.coefficients;
    FittedPoint& point = result.point;
    for (std::size_t j = 0; j < count && !point.channels.empty(); ++j) {
        FittedPoint::Common own{coefficients[j], contributions[j].degrees};
        for (double& change : own.change) change *= contributions[j].standard;
        const std::size_t m = own.change.size();
        for (std::size_t i = 0; i < m * m; ++i)
            point.covariance[i] += own.change[i / m] * own.change[i % m];
        point.common.push_back(std::move(own));
    }
    result.budget = std::move(budget);
}

}  // namespace hshfit::brdfs
