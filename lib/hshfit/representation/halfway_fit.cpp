#include <hshfit/representation/halfway_fit.h>

#include <hshfit/error.h>

#include <tbb/parallel_for.h>
#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace hshfit {
namespace {

/// Samples are summed in this many parts whatever the number of threads, so that it does not show.
constexpr std::size_t parts = 8;
/// Samples whose terms are held at once.
constexpr std::size_t chunk = 256;
/// Share of the loss that the pairs spread over the axes have.
constexpr double lobeShare = 0.1;
/// Errors below this count as squares: a hundredth of what fits of measured BRDFs leave.
constexpr double smallest = 1e-4;
/// Of the mean of the diagonal.
constexpr double regularisation = 1e-9;

/// The loss ln(1 + f c) as a function of y = ln(1 + f), f not below 0.
double metricOf(double y, double c) {
    return y > 0 ? std::log1p(std::expm1(y) * c) : 0;
}

/// Slope by which a change of y changes the metric, between y and what the sum is now.
double slopeBetween(double y, double now, double c, double difference) {
    if (std::abs(now - y) > 1e-6) return difference / (now - y);
    return c / (std::exp(-std::max(y, 0.0)) * (1 - c) + c);
}

/// Weight per sample: its class has its share.
class Weights {
public:
    explicit Weights(const HalfwaySamples& samples) {
        const auto lobes = std::count(samples.lobe.begin(), samples.lobe.end(), 1);
        const double count = static_cast<double>(samples.size());
        const double inLobes = static_cast<double>(lobes);
        const double share = lobes > 0 ? lobeShare : 0;
        uniform_ = (1 - share) / (count - inLobes);
        lobe_ = lobes > 0 ? share / inLobes : 0;
    }
    double at(bool lobe) const { return lobe ? lobe_ : uniform_; }

private:
    double uniform_, lobe_;
};

/// The terms at samples first .. first + count - 1, one sample per column.
void fillTerms(const HalfwayTerms& terms, const HalfwaySamples& samples, std::size_t first,
               std::size_t count, Eigen::MatrixXd& out) {
    out.resize(static_cast<Eigen::Index>(terms.size()), static_cast<Eigen::Index>(count));
    for (std::size_t k = 0; k < count; ++k) {
        terms.evaluate(samples.points[first + k], out.col(static_cast<Eigen::Index>(k)).data());
    }
}

/// Adds samples first .. first + count - 1 to the systems.
class Accumulator {
public:
    Accumulator(const HalfwayTerms& terms, const HalfwaySamples& samples,
                const HalfwayValues& values, const Weights& weights, HalfwayPass& pass)
        : terms_(terms), samples_(samples), values_(values), weights_(weights), pass_(pass) {
        const std::size_t channels = samples.values.size() / samples.size();
        const auto n = static_cast<Eigen::Index>(terms.size());
        pass_.systems.assign(channels,
                             {Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n), 0.0});
    }

    void add(std::size_t first, std::size_t count) {
        const std::size_t channels = pass_.systems.size();
        fillTerms(terms_, samples_, first, count, products_);
        if (values_.size() > 0) now_.noalias() = products_.transpose() * values_;
        for (std::size_t c = 0; c < channels; ++c) {
            HalfwaySystem& system = pass_.systems[c];
            scaled_ = products_;
            right_.resize(static_cast<Eigen::Index>(count));
            for (std::size_t k = 0; k < count; ++k) {
                const auto column = static_cast<Eigen::Index>(k);
                const double y = std::log1p(samples_.values[(first + k) * channels + c]);
                const double root = rootOfWeight(first + k, y, column, c);
                scaled_.col(column) *= root;
                right_[column] = root * y;
            }
            system.gram.selfadjointView<Eigen::Lower>().rankUpdate(scaled_);
            system.right.noalias() += scaled_ * right_;
            system.squares += right_.squaredNorm();
        }
    }

private:
    double rootOfWeight(std::size_t sample, double y, Eigen::Index column, std::size_t channel) {
        const double c = samples_.cosines[sample];
        const double weight = weights_.at(samples_.lobe[sample] != 0);
        if (values_.size() == 0) return std::sqrt(weight) * slopeBetween(y, y, c, 0);
        const double now = now_(column, static_cast<Eigen::Index>(channel));
        const double difference = metricOf(now, c) - metricOf(y, c);
        pass_.loss += weight * std::abs(difference);
        const double slope = slopeBetween(y, now, c, difference);
        return slope * std::sqrt(weight / std::max(std::abs(difference), smallest));
    }

    const HalfwayTerms& terms_;
    const HalfwaySamples& samples_;
    const HalfwayValues& values_;
    const Weights& weights_;
    HalfwayPass& pass_;
    Eigen::MatrixXd products_, scaled_, now_;
    Eigen::VectorXd right_;
};

}  // namespace

HalfwayPass halfwayPass(const HalfwayTerms& terms, const HalfwaySamples& samples,
                        const HalfwayValues& values) {
    const Weights weights(samples);
    std::vector<HalfwayPass> passes(parts);
    tbb::parallel_for(std::size_t{0}, parts, [&](std::size_t part) {
        Accumulator sums(terms, samples, values, weights, passes[part]);
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
    total.loss /= static_cast<double>(total.systems.size());
    return total;
}

HalfwayValues solveHalfway(const std::vector<HalfwaySystem>& systems) {
    const Eigen::Index terms = systems[0].right.size();
    HalfwayValues values(terms, static_cast<Eigen::Index>(systems.size()));
    for (std::size_t c = 0; c < systems.size(); ++c) {
        Eigen::MatrixXd gram = systems[c].gram;
        gram.diagonal().array() += regularisation * gram.diagonal().mean() + 1e-300;
        const Eigen::LDLT<Eigen::MatrixXd, Eigen::Lower> factor(gram);
        values.col(static_cast<Eigen::Index>(c)) = factor.solve(systems[c].right);
    }
    if (!values.allFinite()) throw NumericError("the halfway form has no solution: f is too large");
    return values;
}

HalfwayValues fitHalfway(const HalfwayTerms& terms, const HalfwaySamples& samples,
                         HalfwayValues values) {
    constexpr int maxSteps = 12;
    constexpr double settled = 1.0 / 300;
    double before = std::numeric_limits<double>::infinity(), best = before;
    HalfwayValues result = values;
    for (int step = 0; step < maxSteps; ++step) {
        const bool first = values.size() == 0;
        const HalfwayPass pass = halfwayPass(terms, samples, values);
        if (!first && pass.loss < best) {
            best = pass.loss;
            result = values;
        }
        if (!first && pass.loss > before * (1 - settled)) break;
        if (!first) before = pass.loss;
        values = solveHalfway(pass.systems);
        if (step + 1 == maxSteps) result = values;
    }
    return result;
}

double halfwayLoss(const HalfwayTerms& terms, const HalfwaySamples& samples,
                   const HalfwayValues& values) {
    const std::size_t channels = samples.values.size() / samples.size();
    std::vector<double> sums(parts, 0.0);
    tbb::parallel_for(std::size_t{0}, parts, [&](std::size_t part) {
        Eigen::MatrixXd products, now;
        const std::size_t end = samples.size() * (part + 1) / parts;
        for (std::size_t first = samples.size() * part / parts; first < end; first += chunk) {
            const std::size_t count = std::min(chunk, end - first);
            fillTerms(terms, samples, first, count, products);
            now.noalias() = products.transpose() * values;
            for (std::size_t k = 0; k < count; ++k) {
                const double c = samples.cosines[first + k];
                for (std::size_t channel = 0; channel < channels; ++channel) {
                    const double f = samples.values[(first + k) * channels + channel];
                    const double g =
                        now(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(channel));
                    sums[part] += std::abs(std::log1p(f * c) - metricOf(g, c));
                }
            }
        }
    });
    double total = 0;
    for (const double sum : sums) total += sum;
    return total / static_cast<double>(samples.values.size());
}

}  // namespace hshfit
