#include <hshfit/material_library/few_samples.h>

#include <hshfit/error.h>
#include <hshfit/linear_algebra/decompositions.h>
#include <hshfit/material_library/log_terms.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace hshfit::material_library {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t planes = 3, fewestMaterials = 3;
constexpr double usualShare = 0.95, knownFactor = 2;
/// The least variance of ln(f + logOffset) of a sample: a tenth of a percent, which rounding of
/// components to half precision and of coordinates to steps stays below.
constexpr double leastVariance = 1e-6;

/// Channels as their sum and two differences, an orthogonal matrix.
Eigen::Matrix3d planeMatrix() {
    Eigen::Matrix3d q;
    q << 1, 1, 1, 1, 0, -1, 1, -2, 1;
    return q.rowwise().normalized();
}

/// A normal distribution of the coordinates of one plane.
struct Normal {
    VectorXd mean;
    MatrixXd covariance;
};

/// [plane][coordinate] of a material; a grey one has its channel for every colour.
MatrixXd planesOf(const Basis& basis, const Material& material) {
    const auto k = static_cast<Index>(basis.size());
    MatrixXd channels(3, k);
    for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t from = material.channels == 1 ? 0 : c;
        const ChannelCode code = unpack(
            basis,
            std::span(material.codes).subspan(from * basis.channelBytes(), basis.channelBytes()));
        channels.row(static_cast<Index>(c)) =
            Eigen::Map<const VectorXd>(code.coordinates.data(), k).transpose();
    }
    return planeMatrix() * channels;
}

Normal normalOf(const std::vector<MatrixXd>& materials, Index plane) {
    const auto count = static_cast<double>(materials.size());
    const Index k = materials.front().cols();
    Normal normal{VectorXd::Zero(k), MatrixXd::Zero(k, k)};
    for (const MatrixXd& m : materials) normal.mean += m.row(plane).transpose() / count;
    for (const MatrixXd& m : materials) {
        const VectorXd off = m.row(plane).transpose() - normal.mean;
        normal.covariance += off * off.transpose() / (count - 1);
    }
    const double shrink = static_cast<double>(k) / (static_cast<double>(k) + count);
    const VectorXd diagonal = normal.covariance.diagonal();
    normal.covariance *= 1 - shrink;
    normal.covariance.diagonal() = diagonal;
    return normal;
}

}  // namespace

struct Posterior::State {
    const Basis& basis;
    std::vector<MatrixXd> materials = {};  ///< [plane][coordinate] of each
    std::array<Normal, planes> prior = {}, now = {};
    double beyond = 0;  ///< variance of ln(f + logOffset) beyond the basis
    double scale = 1;   ///< of the bands: chi-square says that the prior is too narrow
    double top = 0;
    std::size_t channels = 3;

    /// The components at a pair.
    VectorXd row(const DirectionPair& pair) const {
        const VectorXd terms = termsAt(pair);
        const Eigen::Map<const linear_algebra::RowMajor> components(
            basis.components.data(), static_cast<Index>(basis.size()), terms.size());
        return components * terms;
    }
    double meanAt(const DirectionPair& pair) const {
        const VectorXd terms = termsAt(pair);
        return terms.dot(Eigen::Map<const VectorXd>(basis.mean.data(), terms.size()));
    }
    static VectorXd termsAt(const DirectionPair& pair) {
        VectorXd terms(static_cast<Index>(logTerms().size()));
        logTerms().evaluate(pair.wi, pair.wo, terms.data());
        return terms;
    }
};

Posterior::Posterior(const Library& library) : state_(new State{.basis = library.basis}) {
    State& s = *state_;
    double square = 0, top = std::log(logOffset);
    for (const Material& material : library.materials) {
        if (material.kind != Kind::coded) continue;
        s.materials.push_back(planesOf(library.basis, material));
        square += std::pow(1.25 * material.error.logError, 2);
        for (const double one : decode(library.basis, material.codes).tops)
            top = std::max(top, one);
    }
    if (s.materials.size() < fewestMaterials)
        throw InputError(
            fmt::format("the library has {} materials in its basis; a prior needs {} "
                        "or more",
                        s.materials.size(), fewestMaterials));
    // The mean magnitude of a normal distribution is 0.8 of the standard deviation.
    s.beyond = library.unseen > 0 ? library.unseen * library.unseen
                                  : square / static_cast<double>(s.materials.size());
    s.top = top;
    s.channels =
        std::ranges::any_of(library.materials, [](const Material& m) { return m.channels == 3; })
            ? 3
            : 1;
    for (std::size_t p = 0; p < planes; ++p)
        s.prior[p] = s.now[p] = normalOf(s.materials, static_cast<Index>(p));
}

Posterior::~Posterior() = default;

Agreement Posterior::observe(std::span<const Observation> observations) {
    if (observations.empty()) throw UsageError("there are no samples above the horizon");
    State& s = *state_;
    s.channels = observations.front().values.size();
    const auto n = static_cast<Index>(observations.size());
    const auto k = static_cast<Index>(s.basis.size());
    const std::size_t used = s.channels == 1 ? 1 : planes;
    const double beyond = std::max(s.beyond, leastVariance);
    // A grey sample stands for three equal channels of one measurement.
    const Eigen::Matrix3d q = planeMatrix();
    MatrixXd rows(n, k), residual(n, 3), variance(n, 3);
    for (Index i = 0; i < n; ++i) {
        const Observation& o = observations[static_cast<std::size_t>(i)];
        rows.row(i) = s.row(o.pair).transpose();
        const double mean = s.meanAt(o.pair);
        Eigen::Vector3d y, sigma;
        for (Index c = 0; c < 3; ++c) {
            const std::size_t from = s.channels == 1 ? 0 : static_cast<std::size_t>(c);
            const double f = std::max(o.values[from], 0.0);
            y[c] = std::log(f + logOffset) - mean;
            sigma[c] = o.sigmas[from] / (f + logOffset);
        }
        residual.row(i) = (q * y).transpose();
        variance.row(i) =
            (q.cwiseProduct(q) * sigma.cwiseProduct(sigma)).transpose().array() + beyond;
        if (s.channels == 1) variance(i, 0) = 3 * (sigma[0] * sigma[0] + beyond);
    }
    Agreement agreement{.degreesOfFreedom = static_cast<std::size_t>(n) * used};
    std::vector<double> own(s.materials.size(), 0.0);
    for (std::size_t p = 0; p < used; ++p) {
        const auto plane = static_cast<Index>(p);
        const Normal& prior = s.prior[p];
        const MatrixXd cross = prior.covariance * rows.transpose();
        MatrixXd covariance = rows * cross;
        covariance.diagonal() += variance.col(plane);
        const Eigen::LLT<MatrixXd> factor(covariance);
        const VectorXd r = residual.col(plane) - rows * prior.mean;
        agreement.chiSquare += r.dot(factor.solve(r));
        s.now[p].mean = prior.mean + cross * factor.solve(r);
        s.now[p].covariance = prior.covariance - cross * factor.solve(cross.transpose());
        // A material of the library has its own residual, and the noise of its samples.
        const MatrixXd inverse = factor.solve(MatrixXd::Identity(n, n));
        const double noise = inverse.diagonal().dot(variance.col(plane));
        for (std::size_t m = 0; m < own.size(); ++m) {
            const VectorXd theirs = rows * (s.materials[m].row(plane).transpose() - prior.mean);
            own[m] += theirs.dot(factor.solve(theirs)) + noise;
        }
    }
    std::ranges::sort(own);
    const auto at = static_cast<std::size_t>(usualShare * static_cast<double>(own.size() - 1));
    const auto freedom = static_cast<double>(agreement.degreesOfFreedom);
    agreement.usual = own[at] / freedom;
    agreement.known = agreement.chiSquare / freedom <= knownFactor * std::max(agreement.usual, 1.0);
    s.scale = std::sqrt(std::max(1.0, agreement.chiSquare / freedom));
    return agreement;
}

LogMaterial Posterior::material() const {
    const State& s = *state_;
    const Eigen::Matrix3d q = planeMatrix();
    const auto terms = static_cast<Index>(s.basis.mean.size()),
               k = static_cast<Index>(s.basis.size());
    const Eigen::Map<const linear_algebra::RowMajor> components(s.basis.components.data(), k,
                                                                terms);
    LogMaterial material;
    for (std::size_t c = 0; c < s.channels; ++c) {
        VectorXd a = VectorXd::Zero(k);
        for (std::size_t p = 0; p < (s.channels == 1 ? 1 : planes); ++p)
            a += q(static_cast<Index>(p), static_cast<Index>(c)) * s.now[p].mean;
        const VectorXd sum =
            Eigen::Map<const VectorXd>(s.basis.mean.data(), terms) + components.transpose() * a;
        material.exponents.insert(material.exponents.end(), sum.begin(), sum.end());
        material.tops.push_back(s.top);
    }
    return material;
}

Band Posterior::at(const DirectionPair& pair) const {
    const State& s = *state_;
    const Eigen::Matrix3d q = planeMatrix();
    const VectorXd row = s.row(pair);
    const double base = s.meanAt(pair);
    Band band;
    for (std::size_t c = 0; c < s.channels; ++c) {
        double mean = base, variance = s.beyond;
        for (std::size_t p = 0; p < (s.channels == 1 ? 1 : planes); ++p) {
            const double weight = q(static_cast<Index>(p), static_cast<Index>(c));
            mean += weight * row.dot(s.now[p].mean);
            variance += weight * weight * row.dot(s.now[p].covariance * row);
        }
        const double deviation = s.scale * std::sqrt(std::max(variance, 0.0));
        const auto f = [&](double y) {
            return std::max(std::exp(std::min(y, s.top)) - logOffset, 0.0);
        };
        band.value.push_back(f(mean));
        band.low.push_back(f(mean - deviation));
        band.high.push_back(f(mean + deviation));
    }
    return band;
}

double Posterior::expectedError() const {
    const State& s = *state_;
    double trace = 0;
    for (const Normal& plane : s.now) trace += plane.covariance.trace();
    return std::sqrt(trace / static_cast<double>(planes) + s.beyond);
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
    const auto n = static_cast<Index>(pairs.size());
    MatrixXd rows(static_cast<Index>(s.basis.size()), n);
    VectorXd noise(n);
    const Eigen::Matrix3d q = planeMatrix();
    for (Index i = 0; i < n; ++i) {
        const DirectionPair& pair = pairs[static_cast<std::size_t>(i)];
        rows.col(i) = s.row(pair);
        const double y = s.meanAt(pair) + q(0, 0) * rows.col(i).dot(s.now[0].mean);
        const double f = std::max(std::exp(y) - logOffset, 0.0);
        // One channel that stands for three is measured once.
        noise[i] = (s.channels == 1 ? 3 : 1) *
                   ((std::pow(options.relative * f, 2) + std::pow(options.absolute, 2)) /
                        std::pow(f + logOffset, 2) +
                    s.beyond);
    }
    std::array<MatrixXd, planes> covariance;
    double trace = 0;
    for (std::size_t p = 0; p < planes; ++p) {
        covariance[p] = s.now[p].covariance;
        trace += covariance[p].trace();
    }
    std::vector<NextPair> chosen;
    while (chosen.size() < options.count) {
        VectorXd gain = VectorXd::Zero(n);
        for (const MatrixXd& c : covariance) {
            const MatrixXd product = c * rows;
            const VectorXd variance = rows.cwiseProduct(product).colwise().sum().transpose();
            gain +=
                (product.colwise().squaredNorm().transpose().array() / (variance + noise).array())
                    .matrix();
        }
        Index best = 0;
        trace -= gain.maxCoeff(&best);
        for (MatrixXd& c : covariance) {
            const VectorXd product = c * rows.col(best);
            c -= product * product.transpose() / (rows.col(best).dot(product) + noise[best]);
        }
        chosen.push_back(
            {pairs[static_cast<std::size_t>(best)],
             std::sqrt(std::max(trace, 0.0) / static_cast<double>(planes) + s.beyond)});
    }
    return chosen;
}

}  // namespace hshfit::material_library
