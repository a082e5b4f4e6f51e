#include <hshfit/material_library/pair_fit.h>

#include <hshfit/linear_algebra/decompositions.h>
#include <hshfit/material_library/log_terms.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace hshfit::material_library {
namespace {

using Eigen::Index;

constexpr SpreadOptions fitSpread{.replicates = 4, .seed = 2, .incoming = 16};
constexpr int ridgePairs = 32;
constexpr double shareByPair = 0.5;  ///< share of the weight that counts pairs
constexpr double seenWeight = 4;     ///< as of Encoder
constexpr double darkShare = 0.1, darkLeast = 1e-5;
constexpr double onDiagonal = 1e-6;  ///< on the diagonal, which is about 1

PairSample makeFitPairs() {
    PairSample pairs = spreadPairs(fitSpread);
    for (int n = 0; n < ridgePairs; ++n) {
        const Direction wo = directionFromAngles(n * pi / 2 / ridgePairs, 0), wi = mirrored(wo);
        pairs.wo.push_back(wo);
        pairs.x.push_back(wi.x);
        pairs.y.push_back(wi.y);
        pairs.z.push_back(wi.z);
        pairs.weights.push_back(0);
        pairs.replicate.push_back(0);
        pairs.first.push_back(pairs.size());
    }
    return pairs;
}

double topAt(double number) {
    return std::log(logOffset) + number / topsPerLog;
}

}  // namespace

const PairSample& fitPairs() {
    static const PairSample pairs = makeFitPairs();
    return pairs;
}

/// The functions of a basis at the pairs.
struct PairFit::Functions {
    explicit Functions(const Basis& basis);

    Eigen::VectorXd mean, cosines, weights;  ///< [pair], the last by solid angle
    Eigen::MatrixXd steps;                   ///< step * component: [pair][component]
    Index spread = 0;                        ///< pairs that are fitted; the others follow
};

PairFit::Functions::Functions(const Basis& basis) {
    const PairSample& pairs = fitPairs();
    const auto size = static_cast<Index>(pairs.size()),
               terms = static_cast<Index>(basis.mean.size()),
               count = static_cast<Index>(basis.size());
    linear_algebra::RowMajor values(size, terms);
    cosines.resize(size);
    weights.resize(size);
    for (Index k = 0; k < size; ++k) {
        const auto n = static_cast<std::size_t>(k);
        logTerms().evaluate(pairs.incoming(n), pairs.outgoing(n), values.row(k).data());
        cosines[k] = pairs.z[n];
        weights[k] = pairs.weights[n];
    }
    spread = size - ridgePairs;
    mean = values * Eigen::Map<const Eigen::VectorXd>(basis.mean.data(), terms);
    steps = basis.step * values *
            Eigen::Map<const linear_algebra::RowMajor>(basis.components.data(), count, terms)
                .transpose();
}

PairFit::PairFit(const Basis& basis) : functions_(std::make_unique<const Functions>(basis)) {}
PairFit::~PairFit() = default;

std::size_t PairFit::components() const {
    return static_cast<std::size_t>(functions_->steps.cols());
}

void PairFit::fit(const float* f, double* numbers) const {
    const Functions& at = *functions_;
    const Index size = at.mean.size(), count = at.spread;
    const Eigen::ArrayXd values = Eigen::Map<const Eigen::ArrayXf>(f, size).cast<double>().max(0.0);
    const Eigen::ArrayXd seen = (values * at.cosines.array()).head(count);
    std::vector<double> sorted(seen.begin(), seen.end());
    const auto middle = sorted.begin() + count / 2;
    std::ranges::nth_element(sorted, middle);
    const auto pairs = static_cast<double>(count);
    const Eigen::ArrayXd byAngle = at.weights.head(count).array();
    const Eigen::ArrayXd peaks = byAngle * seen.square();
    const Eigen::ArrayXd weights =
        (1 - shareByPair) * byAngle + shareByPair / pairs +
        seenWeight / pairs * (seen / (seen + darkShare * *middle + darkLeast)).square() +
        peaks / std::max(peaks.sum(), 1e-300);
    const Eigen::VectorXd off =
        (values.head(count) + logOffset).log() - at.mean.head(count).array();
    const auto steps = at.steps.topRows(count);
    const Eigen::MatrixXd weighted = weights.matrix().asDiagonal() * steps;
    Eigen::MatrixXd gram = steps.transpose() * weighted;
    const double scale = gram.trace() / static_cast<double>(std::max<Index>(gram.cols(), 1));
    gram.diagonal().array() += onDiagonal * scale;
    Eigen::Map<Eigen::VectorXd>(numbers, gram.cols()) =
        gram.llt().solve(weighted.transpose() * off);
    const double top = std::log(values.maxCoeff() + logOffset);
    numbers[gram.cols()] =
        std::clamp(std::ceil((top - std::log(logOffset)) * topsPerLog - 1e-6), 0.0, 255.0);
}

PairFit::Squares PairFit::squares(const float* f, const double* numbers) const {
    const Functions& at = *functions_;
    const Index size = at.mean.size(), count = at.steps.cols();
    const Eigen::ArrayXd values = Eigen::Map<const Eigen::ArrayXf>(f, size).cast<double>().max(0.0);
    const Eigen::ArrayXd logs =
        (at.mean + at.steps * Eigen::Map<const Eigen::VectorXd>(numbers, count)).array();
    const Eigen::ArrayXd found = (logs.min(topAt(numbers[count])).exp() - logOffset).max(0.0);
    const Eigen::ArrayXd c = at.cosines.array(), w = at.weights.array();
    return {(w * ((found - values) * c).square()).sum(), (w * (values * c).square()).sum()};
}

std::vector<std::size_t> farthest(std::span<const float> values, std::size_t count,
                                  std::size_t most) {
    const PairSample& pairs = fitPairs();
    const std::size_t each = values.size() / count;
    Eigen::MatrixXf logs = Eigen::Map<const Eigen::MatrixXf>(
        values.data(), static_cast<Index>(each), static_cast<Index>(count));
    for (std::size_t n = 0; n < each; ++n) {
        const auto weight = static_cast<float>(std::sqrt(pairs.weights[n % pairs.size()]));
        auto row = logs.row(static_cast<Index>(n)).array();
        row = weight * (row + static_cast<float>(logOffset)).log();
    }
    const auto distancesFrom = [&](const Eigen::VectorXf& from) -> Eigen::VectorXf {
        return (logs.colwise() - from).colwise().squaredNorm().transpose();
    };
    Eigen::VectorXf distances = distancesFrom(logs.rowwise().mean());
    std::vector<std::size_t> chosen;
    while (chosen.size() < std::min(most, count)) {
        Index next = 0;
        const float distance = distances.maxCoeff(&next);
        if (!chosen.empty() && !(distance > 0)) break;
        const Eigen::VectorXf found = distancesFrom(logs.col(next));
        distances = chosen.empty() ? found : distances.cwiseMin(found).eval();
        chosen.push_back(static_cast<std::size_t>(next));
    }
    return chosen;
}

LogMaterial fromNumbers(const Basis& basis, const double* numbers, std::size_t channels) {
    LogMaterial material;
    const std::size_t terms = basis.mean.size(), count = basis.size();
    for (std::size_t c = 0; c < channels; ++c) {
        const double* const channel = numbers + c * (count + 1);
        std::vector<double> sum = basis.mean;
        for (std::size_t k = 0; k < count; ++k)
            for (std::size_t t = 0; t < terms; ++t)
                sum[t] += channel[k] * basis.step * basis.components[k * terms + t];
        material.exponents.insert(material.exponents.end(), sum.begin(), sum.end());
        material.tops.push_back(topAt(channel[count]));
    }
    return material;
}

}  // namespace hshfit::material_library
