#include <hshfit/representation/halfway/internal/halfway_fit.h>

#include <hshfit/error.h>

#include <hshfit/representation/halfway/internal/halfway_gram.h>
#include <tbb/parallel_for.h>
#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace hshfit::inline representation::inline halfway {
namespace {

/// Samples are summed in this many parts whatever the number of threads, so that it does not show.
constexpr std::size_t parts = 8;
/// Samples whose terms are held at once: with a few hundred terms they stay in the cache.
constexpr std::size_t chunk = 64;
/// Shares of the loss that the pairs spread over the axes and towards the horizon have: without
/// them nothing holds narrow lobes and the sum where the cosines are small.
constexpr double axesShare = 0.02, horizonShare = 0.02;
/// Regularisation, of the mean of the diagonal, and the share of the loss that is left where a
/// thousandth of it is worth its larger coefficients.
constexpr double firstRegularisation = 1e-6, worthIt = 0.95;
/// Errors below this count as squares: a fiftieth of what fits of measured BRDFs leave.
constexpr double smallest = 1e-4;

/// The loss ln(1 + f c) as a function of y = ln(1 + f), f not below 0.
double metricOf(double y, double c) {
    if (y > 30) return y + std::log(c);
    return y > 0 ? std::log1p(std::expm1(y) * c) : 0;
}

/// Slope by which a change of y changes the metric, between y and what the sum is now.
double slopeBetween(double y, double now, double c, double difference) {
    if (std::abs(now - y) > 1e-6) return difference / (now - y);
    return c / (std::exp(-std::max(y, 0.0)) * (1 - c) + c);
}

/// Weight per sample: each way to draw them has its share.
class Weights {
public:
    explicit Weights(const HalfwaySamples& samples) {
        const auto count = [&](HalfwaySpread spread) {
            return static_cast<double>(
                std::count(samples.spread.begin(), samples.spread.end(), spread));
        };
        const double axes = count(HalfwaySpread::axes), horizon = count(HalfwaySpread::horizon);
        const double left = 1 - (axes > 0 ? axesShare : 0) - (horizon > 0 ? horizonShare : 0);
        weights_ = {left / count(HalfwaySpread::uniform), axesShare / std::max(axes, 1.0),
                    horizonShare / std::max(horizon, 1.0)};
    }
    double at(HalfwaySpread spread) const { return weights_[static_cast<std::size_t>(spread)]; }

private:
    std::array<double, 3> weights_;
};

/// The terms at samples first .. first + count - 1, one sample per column; rows are padded.
void fillTerms(const HalfwayTerms& terms, const HalfwaySamples& samples, std::size_t first,
               std::size_t count, Eigen::MatrixXd& out) {
    const std::size_t rows = (terms.size() + gramPadding - 1) / gramPadding * gramPadding;
    out.setZero(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(count));
    for (std::size_t k = 0; k < count; ++k) {
        terms.evaluate(samples.points[first + k], out.col(static_cast<Eigen::Index>(k)).data());
    }
}

/// Adds samples to the systems.
class Accumulator {
public:
    Accumulator(const HalfwayTerms& terms, const HalfwaySamples& samples,
                const HalfwayValues& values, HalfwayPass& pass)
        : terms_(terms),
          samples_(samples),
          values_(values),
          weights_(samples),
          pass_(pass),
          size_(static_cast<Eigen::Index>(terms.size())) {
        fillTerms(terms, samples, 0, 1, products_);
        const Eigen::Index n = products_.rows();
        pass_.systems.assign(samples.channels(),
                             {Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(size_), 0.0});
    }

    /// Samples first .. first + count - 1.
    void add(std::size_t first, std::size_t count) {
        const std::size_t channels = pass_.systems.size();
        fillTerms(terms_, samples_, first, count, products_);
        scaled_.resize(products_.rows(), products_.cols());
        weight_.resize(static_cast<Eigen::Index>(count));
        right_.resize(static_cast<Eigen::Index>(count));
        if (values_.size() > 0) now_.noalias() = products_.topRows(size_).transpose() * values_;
        for (std::size_t c = 0; c < channels; ++c) {
            HalfwaySystem& system = pass_.systems[c];
            for (std::size_t k = 0; k < count; ++k) {
                const auto row = static_cast<Eigen::Index>(k);
                const double y = std::log1p(samples_.values[(first + k) * channels + c]);
                weight_[row] = weightOf(first + k, y, row, static_cast<Eigen::Index>(c));
                right_[row] = weight_[row] * y;
                system.squares += right_[row] * y;
            }
            // Row-major for the one is column-major for the other: its lower triangle is our upper.
            addWeightedGram(products_.data(), weight_.data(), count,
                            static_cast<std::size_t>(products_.rows()), scaled_.data(),
                            system.gram.data());
            system.right.noalias() += products_.topRows(size_) * right_;
        }
    }

private:
    double weightOf(std::size_t sample, double y, Eigen::Index row, Eigen::Index channel) {
        const double c = samples_.cosines[sample];
        const double weight = weights_.at(samples_.spread[sample]);
        if (values_.size() == 0) {
            const double slope = slopeBetween(y, y, c, 0);
            return weight * slope * slope;
        }
        const double now = now_(row, channel);
        const double difference = metricOf(now, c) - metricOf(y, c);
        pass_.loss += weight * std::abs(difference);
        const double slope = slopeBetween(y, now, c, difference);
        return weight * slope * slope / std::max(std::abs(difference), smallest);
    }

    const HalfwayTerms& terms_;
    const HalfwaySamples& samples_;
    const HalfwayValues& values_;
    Weights weights_;
    HalfwayPass& pass_;
    Eigen::Index size_;
    Eigen::MatrixXd products_, scaled_, now_;
    Eigen::VectorXd right_, weight_;
};

/// Reweighted least squares from `values`, or from none, down to the least loss.
struct Descent {
    const HalfwayTerms& terms;
    const HalfwaySamples& samples;
    HalfwayValues values;
    double loss = std::numeric_limits<double>::infinity();
    std::vector<HalfwaySystem> systems = {};  ///< at `values`

    void run(double regularisation) {
        constexpr int maxSteps = 12;
        constexpr double settled = 1.0 / 300;
        HalfwayValues next = values;
        for (int step = 0; step <= maxSteps; ++step) {
            HalfwayPass pass = halfwayPass(terms, samples, next);
            const bool done = next.size() > 0 && pass.loss > loss * (1 - settled);
            if (next.size() > 0 && pass.loss < loss) {
                loss = pass.loss;
                values = next;
                systems = pass.systems;
            }
            if (done) break;
            next = solveHalfway(pass.systems, regularisation);
        }
    }
};

/// The loss of values as half precision would keep them.
double lossInHalf(const HalfwayTerms& terms, const HalfwaySamples& samples, HalfwayValues values) {
    StoredArray array{.shape = {static_cast<std::size_t>(values.size())},
                      .values = {values.data(), values.data() + values.size()}};
    constexpr double most = 65504;
    for (double& value : array.values) value = std::clamp(value, -most, most);
    quantise(array, Precision::half);
    values = Eigen::Map<const HalfwayValues>(array.values.data(), values.rows(), values.cols());
    return halfwayLoss(samples, halfwaySums(terms, samples, values));
}

}  // namespace

HalfwayPass halfwayPass(const HalfwayTerms& terms, const HalfwaySamples& samples,
                        const HalfwayValues& values) {
    std::vector<HalfwayPass> passes(parts);
    tbb::parallel_for(std::size_t{0}, parts, [&](std::size_t part) {
        Accumulator sums(terms, samples, values, passes[part]);
        const std::size_t end = samples.size() * (part + 1) / parts;
        for (std::size_t k = samples.size() * part / parts; k < end; k += chunk) {
            sums.add(k, std::min(chunk, end - k));
        }
    });
    HalfwayPass total = std::move(passes[0]);
    for (std::size_t part = 1; part < parts; ++part) {
        total.loss += passes[part].loss;
        for (std::size_t c = 0; c < total.systems.size(); ++c) {
            total.systems[c].gram += passes[part].systems[c].gram;
            total.systems[c].right += passes[part].systems[c].right;
            total.systems[c].squares += passes[part].systems[c].squares;
        }
    }
    const auto n = static_cast<Eigen::Index>(terms.size());
    for (HalfwaySystem& system : total.systems) {
        const Eigen::MatrixXd whole =
            system.gram.topLeftCorner(n, n).selfadjointView<Eigen::Upper>();
        system.gram = whole;
    }
    total.loss /= static_cast<double>(total.systems.size());
    return total;
}

HalfwayValues solveHalfway(const std::vector<HalfwaySystem>& systems, double regularisation) {
    const Eigen::Index terms = systems[0].right.size();
    HalfwayValues values(terms, static_cast<Eigen::Index>(systems.size()));
    for (std::size_t c = 0; c < systems.size(); ++c) {
        Eigen::MatrixXd gram = systems[c].gram;
        gram.diagonal().array() += regularisation * gram.diagonal().mean() + 1e-300;
        const Eigen::LDLT<Eigen::MatrixXd> factor(gram);
        values.col(static_cast<Eigen::Index>(c)) = factor.solve(systems[c].right);
    }
    if (!values.allFinite()) throw NumericError("the halfway form has no solution: f is too large");
    return values;
}

HalfwayFit fitHalfway(const HalfwayTerms& terms, const HalfwaySamples& samples,
                      HalfwayValues values) {
    double regularisation = firstRegularisation;
    // Values that were found with less regularisation would leave no step to take.
    if (values.size() > 0) {
        values = solveHalfway(halfwayPass(terms, samples, values).systems, regularisation);
    }
    Descent descent{terms, samples, std::move(values)};
    descent.run(regularisation);
    // Small coefficients survive coarse storage: larger ones have to be worth it, in half precision
    // too.
    for (int lower = 0; lower < 2 && descent.loss > 0; ++lower) {
        const double next = regularisation * 1e-3;
        Descent freer{terms, samples, solveHalfway(descent.systems, next)};
        freer.run(next);
        if (freer.loss > worthIt * descent.loss ||
            lossInHalf(terms, samples, freer.values) > lossInHalf(terms, samples, descent.values)) {
            break;
        }
        regularisation = next;
        descent.values = std::move(freer.values);
        descent.systems = std::move(freer.systems);
        descent.loss = freer.loss;
    }
    return {std::move(descent.values), descent.loss, regularisation};
}

std::vector<double> halfwaySums(const HalfwayTerms& terms, const HalfwaySamples& samples,
                                const HalfwayValues& values) {
    const auto channels = static_cast<std::size_t>(values.cols());
    std::vector<double> sums(samples.size() * channels);
    tbb::parallel_for(std::size_t{0}, parts, [&](std::size_t part) {
        Eigen::MatrixXd products, now;
        const std::size_t end = samples.size() * (part + 1) / parts;
        for (std::size_t first = samples.size() * part / parts; first < end; first += chunk) {
            const std::size_t count = std::min(chunk, end - first);
            fillTerms(terms, samples, first, count, products);
            now.noalias() = values.transpose() * products.topRows(values.rows());
            std::copy_n(now.data(), count * channels, sums.data() + first * channels);
        }
    });
    return sums;
}

double halfwayLoss(const HalfwaySamples& samples, const std::vector<double>& sums,
                   const std::vector<double>& caps) {
    const std::size_t channels = samples.channels();
    double total = 0;
    for (std::size_t k = 0; k < sums.size(); ++k) {
        const double c = samples.cosines[k / channels];
        double now = metricOf(sums[k], c);
        if (!caps.empty()) now = std::min(now, std::log1p(std::exp(caps[k]) * c));
        total += std::abs(std::log1p(samples.values[k] * c) - now);
    }
    return total / static_cast<double>(sums.size());
}

}  // namespace hshfit::inline representation::inline halfway
