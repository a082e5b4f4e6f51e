#include <hshfit/representation/halfway/internal/halfway_fit.h>

#include <hshfit/error.h>
#include <hshfit/representation/halfway/internal/halfway_albedo.h>

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
/// Terms that are held: 8 MiB. A default form takes 2 % less time with 64, and 22 % more with none.
constexpr std::size_t mostHeld = std::size_t{1} << 20;
/// The pull of coefficients to 0: what no sample sees stays small.
constexpr double pull = 1e-6;
/// Weights of the ways to draw pairs, by HalfwaySpread.
constexpr std::array<double, halfwaySpreads> spreadWeights{1, 1, 3, 3, 0.3, 8, 3};
/// Pixels count in full where f cos(theta_i) is far above this multiple of the floor, a hundredth
/// of the greatest mean albedo.
constexpr double darkPixel = 10;

double weightOf(HalfwaySpread spread) {
    return spreadWeights[static_cast<std::size_t>(spread)];
}

/// The weight of a pair where f has a value.
double weightOf(const HalfwaySamples& samples, std::size_t k, double f, double floor) {
    const HalfwaySpread spread = samples.spread[k];
    if (spread != HalfwaySpread::seen) return weightOf(spread);
    const double bright = f * samples.pairs[k].wi.z, share = bright / (bright + darkPixel * floor);
    return weightOf(spread) * share * share;
}

/// The sum of the weights of the pairs that no picture picks: the loss is a mean over these, and
/// the pairs that are seen come on top.
double weightOf(const HalfwaySamples& samples) {
    double sum = 0;
    for (const HalfwaySpread spread : samples.spread)
        sum += spread == HalfwaySpread::seen ? 0 : weightOf(spread);
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
    Evaluation(const HalfwayModel& model, const HalfwayProducts& products,
               const HalfwayValues& values)
        : model_(model), products_(products), values_(values) {}

    void at(std::size_t first, std::size_t count) {
        products_.find(first, count, columns_);
        const Eigen::Map<const Eigen::MatrixXd> terms(
            columns_.terms, static_cast<Index>(products_.rows()), static_cast<Index>(count));
        const auto smooth = static_cast<Index>(model_.terms.smooth());
        const Index rest = values_.rows() - smooth;
        smooth_.noalias() = values_.topRows(smooth).transpose() * terms.topRows(smooth);
        lobe_.noalias() = values_.bottomRows(rest).transpose() * terms.middleRows(smooth, rest);
    }
    /// The two parts at the k-th pair.
    TwoParts parts(std::size_t k, Index channel) const {
        const auto at = static_cast<Index>(k);
        return {std::exp(std::min(smooth_(channel, at), greatestExponent)),
                columns_.weights[k] * std::exp(std::min(lobe_(channel, at), greatestExponent))};
    }
    TwoParts exponents(std::size_t k, Index channel) const {
        const auto at = static_cast<Index>(k);
        return {smooth_(channel, at), lobe_(channel, at)};
    }

private:
    const HalfwayModel& model_;
    const HalfwayProducts& products_;
    const HalfwayValues& values_;
    HalfwayProducts::Columns columns_ = {};
    Eigen::MatrixXd smooth_, lobe_;
};

/// One channel on its way down.
struct Descent {
    Eigen::VectorXd values;
    HalfwaySystem system = {};
    double loss = 0, damping = 1e-2;
    bool done = false;

    Eigen::VectorXd next() const {
        Eigen::MatrixXd matrix = system.gram;
        const double mean = matrix.diagonal().mean();
        matrix.diagonal() *= 1 + damping;
        matrix.diagonal().array() += pull + 1e-9 * damping * mean + 1e-300;
        const Eigen::LDLT<Eigen::MatrixXd> factor(matrix);
        return values - factor.solve(system.slope + pull * values);
    }
    /// Whether the values tried take the place of the values before.
    bool judge(Eigen::VectorXd tried, double found) {
        constexpr double settled = 5e-4, hopeless = 1e6;
        const auto penalised = [](double of, const Eigen::VectorXd& at) {
            return of + pull / 2 * at.squaredNorm();
        };
        const double before = penalised(loss, values), now = penalised(found, tried);
        if (!(now < before)) {
            damping *= 8;
            done = damping > hopeless;
            return false;
        }
        done = now > before * (1 - settled) && damping < 1;
        damping = std::max(damping / 5, 1e-7);
        values = std::move(tried);
        loss = found;
        return true;
    }
};

}  // namespace

HalfwayProducts::HalfwayProducts(const HalfwayModel& model, const std::vector<DirectionPair>& pairs,
                                 bool held)
    : model_(model),
      pairs_(pairs),
      rows_((model.terms.size() + gramPadding - 1) / gramPadding * gramPadding) {
    const std::size_t count = held ? std::min(pairs.size(), mostHeld / rows_) : 0;
    terms_.resize(rows_ * count);
    weights_.resize(count);
    tbb::parallel_for(std::size_t{0}, parts, [&](std::size_t part) {
        const std::size_t first = count * part / parts, last = count * (part + 1) / parts;
        compute(first, last - first, terms_.data() + rows_ * first, weights_.data() + first);
    });
}

void HalfwayProducts::compute(std::size_t first, std::size_t count, double* terms,
                              double* weights) const {
    for (std::size_t k = 0; k < count; ++k, terms += rows_) {
        const auto& [wi, wo] = pairs_[first + k];
        const HalfwayPoint point = model_.axes.at(wi, wo);
        weights[k] = point.weight;
        model_.terms.evaluate(point, terms);
        std::fill(terms + model_.terms.size(), terms + rows_, 0.0);
    }
}

void HalfwayProducts::find(std::size_t first, std::size_t count, Columns& columns) const {
    if (first + count <= weights_.size()) {
        columns.terms = terms_.data() + rows_ * first;
        columns.weights = weights_.data() + first;
        return;
    }
    columns.space.resize(rows_ * count);
    columns.weightSpace.resize(count);
    compute(first, count, columns.space.data(), columns.weightSpace.data());
    columns.terms = columns.space.data();
    columns.weights = columns.weightSpace.data();
}

HalfwayErrors::HalfwayErrors(const HalfwayModel& model, const HalfwayData& data)
    : model_(model),
      data_(data),
      products_(model_, data.samples.pairs, true),
      residuals_(data.samples.values.size()),
      share_(1 / weightOf(data.samples)) {}

HalfwayErrors::~HalfwayErrors() = default;

void HalfwayErrors::addLosses(std::size_t first, std::size_t last, const HalfwayValues& values,
                              std::vector<double>& losses) {
    const HalfwaySamples& samples = data_.samples;
    const std::size_t channels = samples.channels();
    losses.assign(channels, 0.0);
    Evaluation form(model_, products_, values);
    for (; first < last; first += chunk) {
        const std::size_t count = std::min(chunk, last - first);
        form.at(first, count);
        for (std::size_t c = 0; c < channels; ++c) {
            for (std::size_t k = 0; k < count; ++k) {
                const TwoParts parts = form.parts(k, static_cast<Index>(c));
                const std::size_t place = (first + k) * channels + c;
                const double now = parts.smooth + parts.lobe + model_.floor;
                const double error = std::log(now / (samples.values[place] + model_.floor));
                const double weight =
                    weightOf(samples, first + k, samples.values[place], model_.floor);
                losses[c] += weight * huberOf(error, data_.huber);
                residuals_[place] = {
                    1 / now * parts.smooth, 1 / now * parts.lobe, error,
                    weight * std::min(1.0, data_.huber / std::max(std::abs(error), 1e-300))};
            }
        }
    }
}

std::vector<double> HalfwayErrors::losses(const HalfwayValues& values) {
    std::vector<std::vector<double>> sums(parts);
    tbb::parallel_for(std::size_t{0}, parts, [&](std::size_t part) {
        const std::size_t size = data_.samples.size();
        addLosses(size * part / parts, size * (part + 1) / parts, values, sums[part]);
    });
    if (data_.albedo)
        albedo_ = std::make_unique<const HalfwayAlbedoErrors>(model_, *data_.albedo, values);
    std::vector<double> total(data_.samples.channels(), 0.0);
    for (std::size_t c = 0; c < total.size(); ++c) {
        for (const auto& part : sums) total[c] += share_ * part[c];
        if (albedo_) total[c] += albedo_->loss(c);
    }
    return total;
}

void HalfwayErrors::addSamples(std::size_t first, std::size_t last, const std::vector<bool>& wanted,
                               std::vector<HalfwaySystem>& systems) const {
    const std::size_t channels = wanted.size(), rows = products_.rows();
    const auto n = static_cast<Index>(rows);
    systems.resize(channels);
    for (std::size_t c = 0; c < channels; ++c) {
        if (wanted[c]) systems[c] = {Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n)};
    }
    std::vector<double> space(2 * rows * chunk);
    HalfwayProducts::Columns columns;
    for (; first < last; first += chunk) {
        const std::size_t count = std::min(chunk, last - first);
        products_.find(first, count, columns);
        for (std::size_t c = 0; c < channels; ++c) {
            if (!wanted[c]) continue;
            // Row-major for the one is column-major for the other: its lower triangle is our upper.
            addResiduals({columns.terms, &residuals_[first * channels + c], count, rows,
                          model_.terms.smooth(), channels},
                         space.data(), systems[c].gram.data(), systems[c].slope.data());
        }
    }
}

std::vector<HalfwaySystem> HalfwayErrors::systems(const std::vector<bool>& wanted) const {
    std::vector<std::vector<HalfwaySystem>> sums(parts);
    tbb::parallel_for(std::size_t{0}, parts, [&](std::size_t part) {
        const std::size_t size = data_.samples.size();
        addSamples(size * part / parts, size * (part + 1) / parts, wanted, sums[part]);
    });
    const auto n = static_cast<Index>(model_.terms.size());
    std::vector<HalfwaySystem> total(wanted.size());
    for (std::size_t c = 0; c < total.size(); ++c) {
        if (!wanted[c]) continue;
        Eigen::MatrixXd gram =
            Eigen::MatrixXd::Zero(sums[0][c].gram.rows(), sums[0][c].gram.cols());
        total[c].slope = Eigen::VectorXd::Zero(n);
        for (const auto& part : sums) {
            gram += part[c].gram;
            total[c].slope += share_ * part[c].slope.head(n);
        }
        gram *= share_;
        total[c].gram = gram.topLeftCorner(n, n).selfadjointView<Eigen::Upper>();
        if (albedo_) albedo_->addTo(c, total[c]);
    }
    return total;
}

double halfwayLoss(const HalfwayModel& model, const HalfwaySamples& samples, double huber,
                   const HalfwayValues& values) {
    const std::size_t channels = samples.channels();
    const std::vector<double> f = halfwayAt(model, samples.pairs, values);
    double sum = 0;
    for (std::size_t k = 0; k < f.size(); ++k) {
        const double there = samples.values[k];
        const double error = std::log((f[k] + model.floor) / (there + model.floor));
        sum += weightOf(samples, k / channels, there, model.floor) * huberOf(error, huber);
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

HalfwayValues descended(HalfwayErrors& errors, HalfwayValues values, int steps,
                        const std::function<void()>& stepDone) {
    std::vector<double> losses = errors.losses(values);
    const std::size_t channels = losses.size();
    std::vector<Descent> descents;
    for (std::size_t c = 0; c < channels; ++c)
        descents.push_back({.values = values.col(static_cast<Index>(c)), .loss = losses[c]});
    std::vector<bool> moved(channels, true);
    for (int step = 0; step < steps; ++step) {
        std::vector<HalfwaySystem> systems = errors.systems(moved);
        for (std::size_t c = 0; c < channels; ++c) {
            if (moved[c]) descents[c].system = std::move(systems[c]);
            if (!descents[c].done) values.col(static_cast<Index>(c)) = descents[c].next();
        }
        if (!values.allFinite())
            throw NumericError("the halfway form has no solution: f is too large");
        losses = errors.losses(values);
        bool done = true;
        for (std::size_t c = 0; c < channels; ++c) {
            Descent& descent = descents[c];
            moved[c] = !descent.done &&
                       descent.judge(values.col(static_cast<Index>(c)), losses[c]) && !descent.done;
            done = done && descent.done;
        }
        if (stepDone) stepDone();
        if (done) break;
    }
    for (std::size_t c = 0; c < channels; ++c)
        values.col(static_cast<Index>(c)) = descents[c].values;
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
    const HalfwayProducts products(model, samples.pairs, false);
    Evaluation form(model, products, values);
    for (std::size_t first = 0; first < samples.size(); first += chunk) {
        const std::size_t count = std::min(chunk, samples.size() - first);
        form.at(first, count);
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
    const HalfwayProducts products(model, pairs, false);
    tbb::parallel_for(std::size_t{0}, parts, [&](std::size_t part) {
        Evaluation form(model, products, values);
        const std::size_t end = pairs.size() * (part + 1) / parts;
        for (std::size_t first = pairs.size() * part / parts; first < end; first += chunk) {
            const std::size_t count = std::min(chunk, end - first);
            form.at(first, count);
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
