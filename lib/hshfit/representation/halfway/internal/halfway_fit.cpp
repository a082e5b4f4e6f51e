#include <hshfit/representation/halfway/internal/halfway_fit.h>

#include <hshfit/error.h>
#include <hshfit/representation/halfway/internal/halfway_albedo.h>
#include <hshfit/representation/halfway/internal/halfway_gram.h>

#include <tbb/parallel_for.h>
#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace hshfit::inline representation::inline halfway {
namespace {

using Eigen::Index;

/// Samples are summed in this many parts whatever the number of threads, so that it does not show.
constexpr std::size_t parts = 8;
/// Samples whose terms are held at once: with a few hundred terms they stay in the cache.
constexpr std::size_t chunk = 64;
/// The pull of coefficients to 0: what no sample sees stays small.
constexpr double pull = 1e-6;
/// Weights of the ways to draw pairs, by HalfwaySpread.
constexpr std::array<double, halfwaySpreads> spreadWeights{1, 1, 3, 3, 0.3, 8};

double weightOf(HalfwaySpread spread) {
    return spreadWeights[static_cast<std::size_t>(spread)];
}

double weightOf(const HalfwaySamples& samples) {
    double sum = 0;
    for (const HalfwaySpread spread : samples.spread) sum += weightOf(spread);
    return sum;
}

double huberOf(double error, double limit) {
    const double size = std::abs(error);
    return size <= limit ? error * error / 2 : limit * (size - limit / 2);
}

/// The exponentials of both parts at one pair.
struct TwoParts {
    double smooth, lobe;
};

/// Evaluates the form of all channels at up to `chunk` pairs at a time.
class Evaluation {
public:
    Evaluation(const HalfwayModel& model, const HalfwayValues& values)
        : model_(model),
          values_(values),
          rows_((model.terms.size() + gramPadding - 1) / gramPadding * gramPadding) {}

    void at(const std::vector<DirectionPair>& pairs, std::size_t first, std::size_t count) {
        products_.setZero(static_cast<Index>(rows_), static_cast<Index>(count));
        weights_.resize(count);
        for (std::size_t k = 0; k < count; ++k) {
            const HalfwayPoint point = model_.axes.at(pairs[first + k].wi, pairs[first + k].wo);
            weights_[k] = point.weight;
            model_.terms.evaluate(point, products_.col(static_cast<Index>(k)).data());
        }
        const auto smooth = static_cast<Index>(model_.terms.smooth());
        const Index rest = values_.rows() - smooth;
        smooth_.noalias() = values_.topRows(smooth).transpose() * products_.topRows(smooth);
        lobe_.noalias() = values_.bottomRows(rest).transpose() * products_.middleRows(smooth, rest);
    }
    /// The two parts at the k-th pair.
    TwoParts parts(std::size_t k, Index channel) const {
        const auto at = static_cast<Index>(k);
        return {std::exp(std::min(smooth_(channel, at), greatestExponent)),
                weights_[k] * std::exp(std::min(lobe_(channel, at), greatestExponent))};
    }
    TwoParts exponents(std::size_t k, Index channel) const {
        const auto at = static_cast<Index>(k);
        return {smooth_(channel, at), lobe_(channel, at)};
    }
    /// The derivatives of f by the coefficients, times `factor`, into a column of the padded terms.
    void derivatives(std::size_t k, const TwoParts& parts, double factor, double* out) const {
        const double* from = products_.col(static_cast<Index>(k)).data();
        const std::size_t smooth = model_.terms.smooth();
        for (std::size_t t = 0; t < smooth; ++t) out[t] = factor * parts.smooth * from[t];
        for (std::size_t t = smooth; t < rows_; ++t) out[t] = factor * parts.lobe * from[t];
    }
    std::size_t rows() const { return rows_; }

private:
    const HalfwayModel& model_;
    const HalfwayValues& values_;
    std::size_t rows_;
    Eigen::MatrixXd products_, smooth_, lobe_;
    std::vector<double> weights_;
};

/// Adds samples `first` .. `last` - 1 to the systems, whose matrices are padded.
void addSamples(const HalfwayModel& model, const HalfwayData& data, const HalfwayValues& values,
                const std::vector<HalfwayNeed>& needs, std::size_t first, std::size_t last,
                std::vector<HalfwaySystem>& systems) {
    const HalfwaySamples& samples = data.samples;
    const std::size_t channels = samples.channels();
    Evaluation form(model, values);
    const auto rows = static_cast<Index>(form.rows());
    systems.resize(channels);
    for (std::size_t c = 0; c < channels; ++c) {
        if (needs[c] != HalfwayNeed::all) continue;
        systems[c].gram = Eigen::MatrixXd::Zero(rows, rows);
        systems[c].slope = Eigen::VectorXd::Zero(rows);
    }
    Eigen::MatrixXd slopes(rows, static_cast<Index>(chunk)),
        scaled(rows, static_cast<Index>(chunk));
    std::vector<double> weights(chunk);
    Eigen::VectorXd errors(static_cast<Index>(chunk));
    for (; first < last; first += chunk) {
        const std::size_t count = std::min(chunk, last - first);
        form.at(samples.pairs, first, count);
        for (std::size_t c = 0; c < channels; ++c) {
            if (needs[c] == HalfwayNeed::nothing) continue;
            const bool all = needs[c] == HalfwayNeed::all;
            HalfwaySystem& system = systems[c];
            for (std::size_t k = 0; k < count; ++k) {
                const TwoParts parts = form.parts(k, static_cast<Index>(c));
                const double now = parts.smooth + parts.lobe + model.floor;
                const double wanted = samples.values[(first + k) * channels + c] + model.floor;
                const double error = std::log(now / wanted);
                const double weight = weightOf(samples.spread[first + k]);
                system.loss += weight * huberOf(error, data.huber);
                if (!all) continue;
                weights[k] = weight * std::min(1.0, data.huber / std::max(std::abs(error), 1e-300));
                errors[static_cast<Index>(k)] = weights[k] * error;
                form.derivatives(k, parts, 1 / now, slopes.col(static_cast<Index>(k)).data());
            }
            if (!all) continue;
            // Row-major for the one is column-major for the other: its lower triangle is our upper.
            addWeightedGram(slopes.data(), weights.data(), count, form.rows(), scaled.data(),
                            system.gram.data());
            const auto n = static_cast<Index>(count);
            system.slope.noalias() += slopes.leftCols(n) * errors.head(n);
        }
    }
}

/// One channel on its way down.
struct Descent {
    Eigen::VectorXd values;
    HalfwaySystem system;
    double damping = 1e-2;
    bool done = false;

    Eigen::VectorXd next() const {
        Eigen::MatrixXd matrix = system.gram;
        const double mean = matrix.diagonal().mean();
        matrix.diagonal() *= 1 + damping;
        matrix.diagonal().array() += pull + 1e-9 * damping * mean + 1e-300;
        const Eigen::LDLT<Eigen::MatrixXd> factor(matrix);
        return values - factor.solve(system.slope + pull * values);
    }
    double penalised(const HalfwaySystem& of, const Eigen::VectorXd& at) const {
        return of.loss + pull / 2 * at.squaredNorm();
    }
    void judge(Eigen::VectorXd tried, HalfwaySystem found) {
        constexpr double settled = 5e-4, hopeless = 1e6;
        const double before = penalised(system, values), now = penalised(found, tried);
        if (!(now < before)) {
            damping *= 8;
            done = damping > hopeless;
            return;
        }
        done = now > before * (1 - settled) && damping < 1;
        damping = std::max(damping / 5, 1e-7);
        values = std::move(tried);
        system = std::move(found);
    }
};

}  // namespace

std::vector<HalfwaySystem> halfwaySystems(const HalfwayModel& model, const HalfwayData& data,
                                          const HalfwayValues& values,
                                          const std::vector<HalfwayNeed>& needs) {
    std::vector<std::vector<HalfwaySystem>> sums(parts);
    tbb::parallel_for(std::size_t{0}, parts, [&](std::size_t part) {
        const std::size_t size = data.samples.size();
        addSamples(model, data, values, needs, size * part / parts, size * (part + 1) / parts,
                   sums[part]);
    });
    const auto n = static_cast<Index>(model.terms.size());
    const double share = 1 / weightOf(data.samples);
    std::vector<HalfwaySystem> total(sums[0].size());
    for (std::size_t c = 0; c < total.size(); ++c) {
        for (const auto& part : sums) total[c].loss += share * part[c].loss;
        if (needs[c] != HalfwayNeed::all) continue;
        Eigen::MatrixXd gram =
            Eigen::MatrixXd::Zero(sums[0][c].gram.rows(), sums[0][c].gram.cols());
        total[c].slope = Eigen::VectorXd::Zero(n);
        for (const auto& part : sums) {
            gram += part[c].gram;
            total[c].slope += share * part[c].slope.head(n);
        }
        gram *= share;
        total[c].gram = gram.topLeftCorner(n, n).selfadjointView<Eigen::Upper>();
    }
    if (data.albedo) addAlbedo(model, *data.albedo, values, total);
    return total;
}

double halfwayLoss(const HalfwayModel& model, const HalfwaySamples& samples, double huber,
                   const HalfwayValues& values) {
    const std::size_t channels = samples.channels();
    const std::vector<double> f = halfwayAt(model, samples.pairs, values);
    double sum = 0;
    for (std::size_t k = 0; k < f.size(); ++k) {
        const double error = std::log((f[k] + model.floor) / (samples.values[k] + model.floor));
        sum += weightOf(samples.spread[k / channels]) * huberOf(error, huber);
    }
    return sum / (weightOf(samples) * static_cast<double>(channels));
}

HalfwayValues halfwayStart(const HalfwayModel& model, const HalfwaySamples& samples) {
    const std::size_t channels = samples.channels();
    HalfwayValues values =
        HalfwayValues::Zero(static_cast<Index>(model.terms.size()), static_cast<Index>(channels));
    const auto quantile = [](std::vector<double>& of, double share) {
        const auto at =
            of.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(of.size() - 1));
        std::nth_element(of.begin(), at, of.end());
        return *at;
    };
    for (std::size_t c = 0; c < channels; ++c) {
        std::vector<double> smooth, lobe;
        for (std::size_t k = 0; k < samples.size(); ++k) {
            if (samples.spread[k] == HalfwaySpread::uniform)
                smooth.push_back(samples.values[k * channels + c]);
        }
        const double base = quantile(smooth, 0.3);
        for (std::size_t k = 0; k < samples.size(); ++k) {
            const HalfwayPoint point = model.axes.at(samples.pairs[k].wi, samples.pairs[k].wo);
            if (point.x > 0.2) continue;
            const double left = samples.values[k * channels + c] - base;
            lobe.push_back(std::max(left, 1e-3 * (base + model.floor)) / point.weight);
        }
        const auto column = static_cast<Index>(c);
        values(0, column) = std::log(base + 1e-2 * model.floor);
        values(static_cast<Index>(model.terms.smooth()), column) =
            lobe.empty() ? values(0, column) : std::log(quantile(lobe, 0.5));
    }
    return values;
}

HalfwayValues descended(const HalfwayModel& model, const HalfwayData& data, HalfwayValues values,
                        int steps, const std::function<void()>& stepDone) {
    std::vector<Descent> channels(static_cast<std::size_t>(values.cols()));
    std::vector<HalfwayNeed> needs(channels.size(), HalfwayNeed::all);
    std::vector<HalfwaySystem> systems = halfwaySystems(model, data, values, needs);
    for (std::size_t c = 0; c < channels.size(); ++c) {
        channels[c].values = values.col(static_cast<Index>(c));
        channels[c].system = std::move(systems[c]);
    }
    for (int step = 0; step < steps; ++step) {
        for (std::size_t c = 0; c < channels.size(); ++c)
            if (!channels[c].done) values.col(static_cast<Index>(c)) = channels[c].next();
        if (!values.allFinite())
            throw NumericError("the halfway form has no solution: f is too large");
        systems = halfwaySystems(model, data, values, needs);
        for (std::size_t c = 0; c < channels.size(); ++c) {
            if (channels[c].done) continue;
            channels[c].judge(values.col(static_cast<Index>(c)), std::move(systems[c]));
            if (channels[c].done) needs[c] = HalfwayNeed::nothing;
        }
        if (stepDone) stepDone();
        if (std::ranges::all_of(channels, &Descent::done)) break;
    }
    for (std::size_t c = 0; c < channels.size(); ++c)
        values.col(static_cast<Index>(c)) = channels[c].values;
    return values;
}

std::vector<HalfwayCeiling> halfwayCeilings(const HalfwayModel& model,
                                            const HalfwaySamples& samples,
                                            const HalfwayValues& values) {
    constexpr double counts = 1e-2, nothing = -1e4;
    const std::size_t channels = samples.channels();
    std::vector<HalfwayCeiling> ceilings(channels, {nothing, nothing, 0});
    for (std::size_t k = 0; k < samples.values.size(); ++k) {
        double& top = ceilings[k % channels].top;
        top = std::max(top, samples.values[k]);
    }
    Evaluation form(model, values);
    for (std::size_t first = 0; first < samples.size(); first += chunk) {
        const std::size_t count = std::min(chunk, samples.size() - first);
        form.at(samples.pairs, first, count);
        for (std::size_t c = 0; c < channels; ++c) {
            HalfwayCeiling& ceiling = ceilings[c];
            for (std::size_t k = 0; k < count; ++k) {
                const TwoParts parts = form.parts(k, static_cast<Index>(c));
                const TwoParts exponents = form.exponents(k, static_cast<Index>(c));
                const double least = counts * (parts.smooth + parts.lobe + model.floor);
                if (parts.smooth > least)
                    ceiling.smooth = std::max(ceiling.smooth, exponents.smooth);
                if (parts.lobe > least) ceiling.lobe = std::max(ceiling.lobe, exponents.lobe);
            }
        }
    }
    for (HalfwayCeiling& ceiling : ceilings) {
        for (double* value : {&ceiling.smooth, &ceiling.lobe, &ceiling.top})
            *value = static_cast<double>(static_cast<float>(*value));
    }
    return ceilings;
}

std::vector<double> halfwayAt(const HalfwayModel& model, const std::vector<DirectionPair>& pairs,
                              const HalfwayValues& values) {
    const auto channels = static_cast<std::size_t>(values.cols());
    std::vector<double> f(pairs.size() * channels);
    tbb::parallel_for(std::size_t{0}, parts, [&](std::size_t part) {
        Evaluation form(model, values);
        const std::size_t end = pairs.size() * (part + 1) / parts;
        for (std::size_t first = pairs.size() * part / parts; first < end; first += chunk) {
            const std::size_t count = std::min(chunk, end - first);
            form.at(pairs, first, count);
            for (std::size_t k = 0; k < count; ++k) {
                for (std::size_t c = 0; c < channels; ++c) {
                    const TwoParts parts = form.parts(k, static_cast<Index>(c));
                    f[(first + k) * channels + c] = parts.smooth + parts.lobe;
                }
            }
        }
    });
    return f;
}

}  // namespace hshfit::inline representation::inline halfway
