#include <hshfit/material_library/internal/rounding_errors.h>

#include <hshfit/material_library/log_terms.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace hshfit::material_library {
namespace {

using Eigen::Index;

constexpr Index pairsAtOnce = 512;
constexpr auto smallest = static_cast<float>(logOffset);

/// The sums of FormError of one channel, or of several.
struct ErrorSums {
    double meanLog = 0, logError = 0, square = 0, all = 0;
    float maximum = 0, largest = 0;

    /// f and g without their offset as ln(f + logOffset), at pairs with cosines c and weights w.
    void add(const Eigen::ArrayXf& logF, const Eigen::ArrayXf& logG, const Eigen::ArrayXf& c,
             const Eigen::ArrayXf& w) {
        const float least = std::log(smallest);
        const Eigen::ArrayXf a = logF.max(least), b = logG.max(least);
        const Eigen::ArrayXf fc = (a.exp() - smallest).max(0.0F) * c,
                             gc = (b.exp() - smallest).max(0.0F) * c, off = (fc - gc).abs();
        meanLog += static_cast<double>((w * ((1 + fc) / (1 + gc)).log().abs()).sum());
        logError += static_cast<double>((w * (a - b).abs()).sum());
        square += static_cast<double>((w * off.square()).sum());
        all += static_cast<double>((w * fc.square()).sum());
        maximum = std::max(maximum, off.maxCoeff());
        largest = std::max(largest, fc.maxCoeff());
    }
    FormError error(double channels) const {
        return {.meanLog = meanLog / channels,
                .logError = logError / channels,
                .relativeL2 = all > 0 ? std::sqrt(square / all) : 0,
                .maximum = static_cast<double>(maximum),
                .largest = static_cast<double>(largest)};
    }
};

}  // namespace

RoundingErrors::RoundingErrors(const Basis& basis) : basis_(basis) {
    const PairSample& pairs = errorPairs();
    const auto size = static_cast<Index>(pairs.size()),
               count = static_cast<Index>(basis.mean.size());
    terms_.resize(size, count);
    tbb::parallel_for(Index{0}, size, [&](Index k) {
        std::vector<double> row(basis.mean.size());
        const auto n = static_cast<std::size_t>(k);
        logTerms().evaluate(pairs.incoming(n), pairs.outgoing(n), row.data());
        std::ranges::transform(row, terms_.row(k).data(),
                               [](double value) { return static_cast<float>(value); });
    });
    Eigen::MatrixXf numbers(count, static_cast<Index>(basis.size()) + 1);
    for (Index t = 0; t < count; ++t) {
        const auto term = static_cast<std::size_t>(t);
        numbers(t, 0) = static_cast<float>(basis.mean[term]);
        for (std::size_t k = 0; k < basis.size(); ++k)
            numbers(t, static_cast<Index>(k) + 1) =
                static_cast<float>(basis.components[k * basis.mean.size() + term]);
    }
    functions_ = terms_ * numbers;
}

std::vector<FormError> RoundingErrors::of(std::span<const RoundedMaterial> materials) const {
    const PairSample& pairs = errorPairs();
    const std::size_t bytes = basis_.channelBytes();
    std::vector<std::size_t> owner;
    std::vector<float> tops, boundsG;
    for (std::size_t m = 0; m < materials.size(); ++m)
        owner.insert(owner.end(), materials[m].measured.channels(), m);
    const auto columns = static_cast<Index>(owner.size());
    Eigen::MatrixXf exponents(terms_.cols(), columns), factors(functions_.cols(), columns);
    for (std::size_t m = 0, column = 0; m < materials.size(); ++m) {
        const Measured& measured = materials[m].measured;
        for (std::size_t c = 0; c < measured.channels(); ++c, ++column) {
            const auto at = static_cast<Index>(column);
            exponents.col(at) = Eigen::Map<const Eigen::VectorXf>(
                measured.exponents.data() + c * basis_.mean.size(), terms_.cols());
            const ChannelCode code = unpack(basis_, materials[m].codes.subspan(c * bytes, bytes));
            factors(0, at) = 1;
            for (std::size_t k = 0; k < basis_.size(); ++k)
                factors(static_cast<Index>(k) + 1, at) = static_cast<float>(code.coordinates[k]);
            tops.push_back(measured.tops[c]);
            boundsG.push_back(static_cast<float>(code.top));
        }
    }
    std::vector<ErrorSums> sums(materials.size());
    for (Index first = 0; first < terms_.rows(); first += pairsAtOnce) {
        const Index count = std::min(pairsAtOnce, terms_.rows() - first);
        const Eigen::MatrixXf f = terms_.middleRows(first, count) * exponents,
                              g = functions_.middleRows(first, count) * factors;
        const auto from = static_cast<std::size_t>(first);
        const Eigen::ArrayXf c =
            Eigen::Map<const Eigen::ArrayXd>(pairs.z.data() + from, count).cast<float>();
        const Eigen::ArrayXf w =
            Eigen::Map<const Eigen::ArrayXd>(pairs.weights.data() + from, count).cast<float>();
        for (Index k = 0; k < columns; ++k) {
            const auto column = static_cast<std::size_t>(k);
            sums[owner[column]].add(f.col(k).array().min(tops[column]),
                                    g.col(k).array().min(boundsG[column]), c, w);
        }
    }
    std::vector<FormError> errors;
    for (std::size_t m = 0; m < materials.size(); ++m)
        errors.push_back(sums[m].error(static_cast<double>(materials[m].measured.channels())));
    return errors;
}

}  // namespace hshfit::material_library
