#include <hshfit/material_library/few_samples.h>

#include <hshfit/brdf/uniform.h>
#include <hshfit/error.h>
#include <hshfit/material_library/internal/log_samples.h>
#include <hshfit/material_library/internal/material_prior.h>
#include <hshfit/material_library/log_terms.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace hshfit::material_library {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double usualShare = 0.975, bandShare = 0.683;
constexpr Index checkedPairs = 200;  ///< at which the bands of the library's own are checked
constexpr std::size_t blockPairs = 1024;
constexpr unsigned drawnSeed = 1;
/// The least variance of ln(f + logOffset) of a sample: a tenth of a percent, which the rounding of
/// numbers to single precision stays below.
constexpr double leastVariance = 1e-6;

/// Pairs with the terms at each, as columns of L^-1 P, and their zones.
struct Rows {
    Rows(const LogSpace& space, std::span<const DirectionPair> pairs)
        : terms(static_cast<Index>(logTerms().size()), static_cast<Index>(pairs.size())) {
        for (std::size_t n = 0; n < pairs.size(); ++n) {
            logTerms().evaluate(pairs[n].wi, pairs[n].wo, terms.col(static_cast<Index>(n)).data());
            zones.push_back(restZone(pairs[n].wi, pairs[n].wo));
        }
        space.samples().lower.triangularView<Eigen::Lower>().solveInPlace(terms);
    }
    Index count() const { return terms.cols(); }

    MatrixXd terms;
    std::vector<std::size_t> zones;
};

/// A normal distribution after observations at pairs with noise of these variances.
struct Conditioned {
    Conditioned(const Normal& prior, const MatrixXd& rows, const VectorXd& variance)
        : prior(prior), rows(rows), cross(prior.covariance * rows) {
        MatrixXd sum = rows.transpose() * cross;
        sum.diagonal() += variance;
        factor.compute(sum);
    }
    VectorXd residual(const VectorXd& y) const { return y - rows.transpose() * prior.mean; }
    double chiSquare(const VectorXd& r) const { return r.dot(factor.solve(r)); }
    VectorXd mean(const VectorXd& r) const { return prior.mean + cross * factor.solve(r); }
    MatrixXd covariance() const {
        return prior.covariance - cross * factor.solve(cross.transpose());
    }
    /// The variances of sums of terms.
    VectorXd variances(const MatrixXd& at) const {
        const MatrixXd seen = cross.transpose() * at;
        return at.cwiseProduct(prior.covariance * at).colwise().sum().transpose() -
               seen.cwiseProduct(factor.solve(seen)).colwise().sum().transpose();
    }

    const Normal& prior;
    const MatrixXd& rows;
    MatrixXd cross;
    Eigen::LLT<MatrixXd> factor;
};

std::vector<DirectionPair> spreadEvenly() {
    std::mt19937_64 random(drawnSeed);
    const auto drawn = [&] {
        const double theta = std::acos(1 - uniform(random));
        return directionFromAngles(theta, 2 * pi * uniform(random));
    };
    std::vector<DirectionPair> pairs;
    for (Index n = 0; n < checkedPairs; ++n) {
        const Direction wi = drawn();
        pairs.push_back({wi, drawn()});
    }
    return pairs;
}

/// The value that so much of the numbers is at most.
double quantile(std::vector<double> numbers, double share) {
    std::ranges::sort(numbers);
    const double rank = std::ceil(share * static_cast<double>(numbers.size() + 1));
    return numbers[std::min(static_cast<std::size_t>(rank), numbers.size()) - 1];
}

double scaleOf(double chiSquare, double freedom) {
    return std::sqrt(std::max(1.0, chiSquare / freedom));
}

}  // namespace

struct Posterior::State {
    State(const LogSpace& space, const Library& library)
        : space(space), materials(space, library), now(materials.all) {}

    /// The variances beyond the terms.
    VectorXd rest(std::size_t plane, const std::vector<std::size_t>& zones) const {
        VectorXd variances(static_cast<Index>(zones.size()));
        for (std::size_t n = 0; n < zones.size(); ++n)
            variances[static_cast<Index>(n)] = materials.rest(restRow(plane, zones[n]));
        return variances;
    }
    /// The mean variance beyond the terms, summed over the planes.
    double restSum() const {
        double sum = 0;
        for (const DirectionPair& pair : spreadEvenly())
            for (std::size_t p = 0; p < planes; ++p)
                sum += materials.rest(restRow(p, restZone(pair.wi, pair.wo))) / checkedPairs;
        return sum;
    }
    std::size_t used() const { return channels == 1 ? 1 : planes; }

    const LogSpace& space;
    MaterialPrior materials;
    Prior now;
    double scale = 1;  ///< of the bands
    std::size_t channels = 3;
};

namespace {

/// Observations by planes.
struct Observed {
    MatrixXd values, variances;  ///< [pair][plane]; the variances are of the samples alone
};

Observed observedOf(std::span<const Observation> observations, bool grey) {
    const Eigen::Matrix3d q = planeMatrix();
    const auto n = static_cast<Index>(observations.size());
    Observed observed{MatrixXd(n, 3), MatrixXd(n, 3)};
    for (Index i = 0; i < n; ++i) {
        const Observation& o = observations[static_cast<std::size_t>(i)];
        Eigen::Vector3d y, sigma;
        for (Index c = 0; c < 3; ++c) {
            const std::size_t from = grey ? 0 : static_cast<std::size_t>(c);
            const double f = std::max(o.values[from], 0.0);
            y[c] = std::log(f + logOffset);
            sigma[c] = o.sigmas[from] / (f + logOffset);
        }
        observed.values.row(i) = (q * y).transpose();
        observed.variances.row(i) = (q.cwiseProduct(q) * sigma.cwiseProduct(sigma)).transpose();
        // A grey sample stands for three equal channels of one measurement.
        if (grey) observed.variances(i, 0) = 3 * sigma[0] * sigma[0];
    }
    return observed;
}

/// The chi-squares of the library's own materials, each by a prior that it takes no part in, and
/// the errors of what is found of them over its deviations.
struct OwnErrors {
    std::vector<double> chiSquares, ratios;
};

OwnErrors ownErrors(const MaterialPrior& materials, const Rows& rows, const MatrixXd& sampled,
                    const MatrixXd& variances, const Rows& checked, const MatrixXd& checkedRest,
                    std::size_t used) {
    std::mt19937_64 random(drawnSeed);
    const Eigen::Matrix3d q = planeMatrix();
    const auto noise = [&](const Rows& at, std::size_t m, std::size_t plane, VectorXd more) {
        for (Index n = 0; n < at.count(); ++n)
            more[n] += materials.rests(restRow(plane, at.zones[static_cast<std::size_t>(n)]),
                                       static_cast<Index>(m));
        return VectorXd(more.cwiseSqrt().cwiseProduct(normalNumbers(at.count(), random)));
    };
    OwnErrors own;
    const std::size_t channels = used == 1 ? 1 : 3;
    for (std::size_t fold = 0; fold < materials.folds.size(); ++fold) {
        std::vector<Conditioned> after;
        MatrixXd spread(checked.count(), static_cast<Index>(used));
        for (std::size_t p = 0; p < used; ++p) {
            const auto plane = static_cast<Index>(p);
            after.emplace_back(materials.folds[fold][p], rows.terms, variances.col(plane));
            spread.col(plane) = after[p].variances(checked.terms) + checkedRest.col(plane);
        }
        const MatrixXd squares = q.cwiseProduct(q).topLeftCorner(spread.cols(), 3);
        const MatrixXd deviations = (spread * squares).cwiseSqrt();
        for (std::size_t m = fold; m < materials.count(); m += materials.folds.size()) {
            double chiSquare = 0;
            MatrixXd off(checked.count(), spread.cols());
            for (std::size_t p = 0; p < used; ++p) {
                const auto plane = static_cast<Index>(p);
                const VectorXd d = materials.numbers[p].col(static_cast<Index>(m));
                const VectorXd r = after[p].residual(rows.terms.transpose() * d +
                                                     noise(rows, m, p, sampled.col(plane)));
                chiSquare += after[p].chiSquare(r);
                off.col(plane) = checked.terms.transpose() * (d - after[p].mean(r)) +
                                 noise(checked, m, p, VectorXd::Zero(checked.count()));
            }
            own.chiSquares.push_back(chiSquare);
            const MatrixXd errors = off * q.topLeftCorner(spread.cols(), 3);
            const double scale =
                scaleOf(chiSquare, static_cast<double>(rows.count()) * static_cast<double>(used));
            for (std::size_t c = 0; c < channels; ++c)
                for (Index n = 0; n < checked.count(); ++n)
                    own.ratios.push_back(std::abs(errors(n, static_cast<Index>(c))) /
                                         (scale * deviations(n, static_cast<Index>(c))));
        }
    }
    return own;
}

std::vector<DirectionPair> pairsOf(std::span<const Observation> observations) {
    std::vector<DirectionPair> pairs;
    for (const Observation& one : observations) pairs.push_back(one.pair);
    return pairs;
}

}  // namespace

Posterior::Posterior(const LogSpace& space, const Library& library)
    : state_(new State(space, library)) {
    if (std::ranges::none_of(library.materials, [](const Material& m) { return m.channels == 3; }))
        state_->channels = 1;
}

Posterior::~Posterior() = default;

Agreement Posterior::observe(std::span<const Observation> observations) {
    if (observations.empty()) throw UsageError("there are no samples above the horizon");
    State& s = *state_;
    s.channels = observations.front().values.size();
    const Rows rows(s.space, pairsOf(observations)), checked(s.space, spreadEvenly());
    const Observed observed = observedOf(observations, s.channels == 1);
    MatrixXd variances = observed.variances, checkedRest(checked.count(), 3);
    Agreement agreement{.degreesOfFreedom = observations.size() * s.used()};
    for (std::size_t p = 0; p < s.used(); ++p) {
        const auto plane = static_cast<Index>(p);
        variances.col(plane) += s.rest(p, rows.zones).cwiseMax(leastVariance);
        checkedRest.col(plane) = s.rest(p, checked.zones).cwiseMax(leastVariance);
        const Conditioned after(s.materials.all[p], rows.terms, variances.col(plane));
        const VectorXd r = after.residual(observed.values.col(plane));
        agreement.chiSquare += after.chiSquare(r);
        s.now[p] = {after.mean(r), after.covariance()};
    }
    const OwnErrors own =
        ownErrors(s.materials, rows, observed.variances, variances, checked, checkedRest, s.used());
    const auto freedom = static_cast<double>(agreement.degreesOfFreedom);
    const double usual = quantile(own.chiSquares, usualShare);
    agreement.usual = usual / freedom;
    agreement.known = agreement.chiSquare <= usual;
    s.scale = scaleOf(agreement.chiSquare, freedom) * quantile(own.ratios, bandShare);
    return agreement;
}

LogMaterial Posterior::material() const {
    const State& s = *state_;
    const Eigen::Matrix3d q = planeMatrix();
    LogMaterial material;
    for (std::size_t c = 0; c < s.channels; ++c) {
        VectorXd d = VectorXd::Zero(s.now[0].mean.size());
        for (std::size_t p = 0; p < s.used(); ++p)
            d += q(static_cast<Index>(p), static_cast<Index>(c)) * s.now[p].mean;
        s.space.samples().lower.transpose().triangularView<Eigen::Upper>().solveInPlace(d);
        material.exponents.insert(material.exponents.end(), d.begin(), d.end());
        material.tops.push_back(s.materials.top);
    }
    return material;
}

std::vector<Band> Posterior::bands(std::span<const DirectionPair> pairs) const {
    const State& s = *state_;
    const Eigen::Matrix3d q = planeMatrix();
    const auto used = static_cast<Index>(s.used());
    const auto f = [&](double y) {
        return std::max(std::exp(std::min(y, s.materials.top)) - logOffset, 0.0);
    };
    std::vector<Band> all;
    for (std::size_t from = 0; from < pairs.size(); from += blockPairs) {
        const Rows rows(s.space, pairs.subspan(from, std::min(blockPairs, pairs.size() - from)));
        MatrixXd means(rows.count(), used), variances(rows.count(), used);
        for (Index p = 0; p < used; ++p) {
            const Normal& plane = s.now[static_cast<std::size_t>(p)];
            means.col(p) = rows.terms.transpose() * plane.mean;
            const MatrixXd product = plane.covariance * rows.terms;
            variances.col(p) = rows.terms.cwiseProduct(product).colwise().sum().transpose() +
                               s.rest(static_cast<std::size_t>(p), rows.zones);
        }
        const MatrixXd logs = means * q.topRows(used);
        const MatrixXd deviations =
            s.scale * (variances * q.cwiseProduct(q).topRows(used)).cwiseMax(0).cwiseSqrt();
        for (Index n = 0; n < rows.count(); ++n) {
            Band& band = all.emplace_back();
            for (Index c = 0; c < static_cast<Index>(s.channels); ++c) {
                band.value.push_back(f(logs(n, c)));
                band.low.push_back(f(logs(n, c) - deviations(n, c)));
                band.high.push_back(f(logs(n, c) + deviations(n, c)));
            }
        }
    }
    return all;
}

double Posterior::expectedError() const {
    double sum = state_->restSum();
    for (const Normal& plane : state_->now) sum += plane.covariance.trace();
    return std::sqrt(sum / static_cast<double>(planes));
}

namespace {

std::vector<DirectionPair> candidatePairs(const NextOptions& options) {
    constexpr int step = 5, turn = 15;
    constexpr double hidden = 5;
    std::vector<DirectionPair> pairs;
    const int most = static_cast<int>(options.mostTheta);
    for (int i = 0; i <= most; i += step) {
        for (int o = 0; o <= i; o += step) {  // the others are these exchanged
            for (int phi = 0; phi <= 180; phi += options.inPlane ? 180 : turn) {
                const Direction wi = directionFromAngles(radians(i), 0),
                                wo = directionFromAngles(radians(o), radians(phi));
                if (degrees(std::acos(std::min(1.0, dot(wi, wo)))) < hidden - 1e-6) continue;
                pairs.push_back({wi, wo});
            }
        }
    }
    return pairs;
}

}  // namespace

std::vector<NextPair> Posterior::next(const NextOptions& options) const {
    const State& s = *state_;
    const std::vector<DirectionPair> pairs = candidatePairs(options);
    const Rows rows(s.space, pairs);
    const double toMean = planeMatrix()(0, 0);
    // The variance of a sample by itself; one channel that stands for three is measured once.
    VectorXd noise = toMean * (rows.terms.transpose() * s.now[0].mean);
    for (double& one : noise) {
        const double f = std::max(std::exp(one) - logOffset, 0.0);
        one = (s.channels == 1 ? 3 : 1) *
              (std::pow(options.relative * f, 2) + std::pow(options.absolute, 2)) /
              std::pow(f + logOffset, 2);
    }
    // For each plane, the covariance of the terms with the sums at the pairs.
    std::array<MatrixXd, planes> products, variances;
    double sum = s.restSum();
    for (std::size_t p = 0; p < planes; ++p) {
        products[p] = s.now[p].covariance * rows.terms;
        variances[p] = noise + s.rest(p, rows.zones).cwiseMax(leastVariance) +
                       rows.terms.cwiseProduct(products[p]).colwise().sum().transpose();
        sum += s.now[p].covariance.trace();
    }
    std::vector<NextPair> chosen;
    while (chosen.size() < options.count) {
        VectorXd gain = VectorXd::Zero(rows.count());
        for (std::size_t p = 0; p < planes; ++p)
            gain += products[p].colwise().squaredNorm().transpose().cwiseQuotient(variances[p]);
        Index best = 0;
        sum -= gain.maxCoeff(&best);
        for (std::size_t p = 0; p < planes; ++p) {
            const VectorXd product = products[p].col(best);
            const VectorXd along = rows.terms.transpose() * product;
            const double variance = variances[p](best);
            products[p] -= product * along.transpose() / variance;
            variances[p] -= along.cwiseAbs2() / variance;
        }
        chosen.push_back({pairs[static_cast<std::size_t>(best)],
                          std::sqrt(std::max(sum, 0.0) / static_cast<double>(planes))});
    }
    return chosen;
}

}  // namespace hshfit::material_library
