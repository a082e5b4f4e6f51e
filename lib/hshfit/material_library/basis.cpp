#include <hshfit/material_library/basis.h>

#include <hshfit/material_library/internal/log_samples.h>
#include <hshfit/material_library/log_terms.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace hshfit::material_library {
namespace {

constexpr int mostTop = 255;
/// The weight of lit pixels where all pairs have 1. Of the values 0.5 to 8, tried with the peaks,
/// this one has the least FLIP without a loss.
constexpr double pictureWeight = 4;

int halfRange(std::uint8_t width) {
    return 1 << (width - 1);
}

double topOf(std::uint8_t code) {
    return std::log(logOffset) + code / topsPerLog;
}

std::uint8_t topCode(double top) {
    const double steps = std::ceil((top - std::log(logOffset)) * topsPerLog - 1e-6);
    return static_cast<std::uint8_t>(std::clamp(steps, 0.0, double{mostTop}));
}

using Matrix = Eigen::Map<const linear_algebra::RowMajor>;

Matrix matrixOf(const Basis& basis) {
    return {basis.components.data(), static_cast<Eigen::Index>(basis.size()),
            static_cast<Eigen::Index>(basis.mean.size())};
}

constexpr Eigen::Index peakStep = 8;

/// The terms at every few pairs of the samples.
Eigen::Map<const linear_algebra::RowMajor, 0, Eigen::OuterStride<>> everyFew(
    const LogSamples& samples) {
    const Eigen::Index terms = samples.terms.cols();
    return {samples.terms.data(), samples.terms.rows() / peakStep, terms,
            Eigen::OuterStride<>(peakStep * terms)};
}

/// Weights there by (f c)^2, c = cos(theta_i) and f by the sums of the material, that add up to 1:
/// [pair][channel].
Eigen::MatrixXd peakWeights(const LogSamples& samples, const LogMaterial& material) {
    const auto channels = static_cast<Eigen::Index>(material.channels());
    Eigen::MatrixXd peaks =
        everyFew(samples) * Eigen::Map<const Eigen::MatrixXd>(material.exponents.data(),
                                                              samples.terms.cols(), channels);
    for (Eigen::Index c = 0; c < channels; ++c) {
        const double top = material.tops[static_cast<std::size_t>(c)];
        for (Eigen::Index n = 0; n < peaks.rows(); ++n) {
            const auto k = static_cast<std::size_t>(n * peakStep);
            const double f = std::max(std::exp(std::min(peaks(n, c), top)) - logOffset, 0.0);
            peaks(n, c) = samples.pairs.weights[k] * std::pow(f * samples.pairs.z[k], 2);
        }
        peaks.col(c) /= std::max(peaks.col(c).sum(), 1e-300);
    }
    return peaks;
}

/// Coordinates a in whole steps with a small a^T gram a - 2 a^T right; the others are 0.
std::vector<double> rounded(const Basis& basis, const Eigen::MatrixXd& gram,
                            const Eigen::VectorXd& right) {
    std::vector<double> all(basis.size(), 0.0);
    const Eigen::LLT<Eigen::MatrixXd> factor(gram);
    const Eigen::VectorXd best = factor.solve(right);
    const Eigen::MatrixXd upper = factor.matrixU();
    Eigen::VectorXd off = Eigen::VectorXd::Zero(best.size());  // best - rounded
    for (Eigen::Index k = best.size() - 1; k >= 0; --k) {
        const double most = basis.step * (halfRange(basis.widths[static_cast<std::size_t>(k)]) - 1);
        const double free = best[k] + upper.row(k).dot(off) / upper(k, k);
        const double value = std::clamp(basis.step * std::round(free / basis.step), -most, most);
        all[static_cast<std::size_t>(k)] = value;
        off[k] = best[k] - value;
    }
    return all;
}

}  // namespace

std::size_t Basis::channelBytes() const {
    std::size_t bits = 0;
    for (const std::uint8_t width : widths) bits += width;
    return 1 + (bits + 7) / 8;
}

std::size_t Basis::bytes() const {
    return 4 * mean.size() + 2 * components.size() + widths.size() + 4;
}

std::vector<std::uint8_t> pack(const Basis& basis, std::span<const double> coordinates,
                               double top) {
    assert(coordinates.size() == basis.size());
    std::vector<std::uint8_t> code(basis.channelBytes(), 0);
    code[0] = topCode(top);
    std::size_t bit = 8;
    for (std::size_t k = 0; k < basis.size(); ++k) {
        const int half = halfRange(basis.widths[k]);
        const double most = half - 1;
        const double steps = std::clamp(std::round(coordinates[k] / basis.step), -most, most);
        const auto number = static_cast<unsigned>(static_cast<int>(steps) + half);
        for (int b = 0; b < basis.widths[k]; ++b, ++bit)
            code[bit / 8] |= static_cast<std::uint8_t>((number >> b & 1u) << bit % 8);
    }
    return code;
}

ChannelCode unpack(const Basis& basis, std::span<const std::uint8_t> code) {
    assert(code.size() == basis.channelBytes());
    ChannelCode channel{.coordinates = {}, .top = topOf(code[0])};
    std::size_t bit = 8;
    for (const std::uint8_t width : basis.widths) {
        int number = 0;
        for (int b = 0; b < width; ++b, ++bit) number |= (code[bit / 8] >> bit % 8 & 1) << b;
        channel.coordinates.push_back(basis.step * (number - halfRange(width)));
    }
    return channel;
}

LogMaterial decode(const Basis& basis, std::span<const std::uint8_t> codes) {
    LogMaterial material;
    const std::size_t bytes = basis.channelBytes(), terms = basis.mean.size();
    for (std::size_t first = 0; first + bytes <= codes.size(); first += bytes) {
        const ChannelCode channel = unpack(basis, codes.subspan(first, bytes));
        std::vector<double> sum = basis.mean;
        for (std::size_t k = 0; k < basis.size(); ++k)
            for (std::size_t t = 0; t < terms; ++t)
                sum[t] += channel.coordinates[k] * basis.components[k * terms + t];
        material.exponents.insert(material.exponents.end(), sum.begin(), sum.end());
        material.tops.push_back(channel.top);
    }
    return material;
}

struct Encoder::Metric {
    Eigen::MatrixXd measured;  ///< components times the metric of all pairs
    Eigen::MatrixXd gram;      ///< that times components
    Eigen::MatrixXd seen;      ///< components at the pairs of pictures, [component][pair]
    Eigen::MatrixXd peaks;     ///< and at every `peakStep`th pair of the samples
};

Encoder::Encoder(const Basis& basis, const LogSpace& space) : basis_(basis), space_(space) {
    const Eigen::MatrixXd measured = matrixOf(basis) * space.samples().metric;
    metric_ = std::make_unique<const Metric>(
        Metric{measured, measured * matrixOf(basis).transpose(),
               matrixOf(basis) * space.samples().seen.terms.transpose(),
               matrixOf(basis) * everyFew(space.samples()).transpose()});
}

Encoder::~Encoder() = default;

std::vector<std::uint8_t> Encoder::encode(const LogMaterial& material,
                                          std::size_t components) const {
    const auto terms = static_cast<Eigen::Index>(basis_.mean.size());
    const auto used = static_cast<Eigen::Index>(std::min(components, basis_.size()));
    const Eigen::Map<const Eigen::VectorXd> mean(basis_.mean.data(), terms);
    const LogSamples& samples = space_.samples();
    const Eigen::MatrixXd pictures = pictureWeight * samples.seen.weights(material),
                          peaks = peakWeights(samples, material),
                          seen = metric_->seen.topRows(used), few = metric_->peaks.topRows(used);
    std::vector<std::uint8_t> codes;
    for (std::size_t c = 0; c < material.channels(); ++c) {
        const auto column = static_cast<Eigen::Index>(c);
        const Eigen::VectorXd off = Eigen::Map<const Eigen::VectorXd>(
                                        material.exponents.data() + c * basis_.mean.size(), terms) -
                                    mean;
        const Eigen::MatrixXd inPictures = seen * pictures.col(column).asDiagonal(),
                              atPeaks = few * peaks.col(column).asDiagonal();
        const Eigen::MatrixXd gram = metric_->gram.topLeftCorner(used, used) +
                                     inPictures * seen.transpose() + atPeaks * few.transpose();
        const Eigen::VectorXd right = metric_->measured.topRows(used) * off +
                                      inPictures * (samples.seen.terms * off) +
                                      atPeaks * (everyFew(samples) * off);
        const std::vector<std::uint8_t> one =
            pack(basis_, rounded(basis_, gram, right), material.tops[c]);
        codes.insert(codes.end(), one.begin(), one.end());
    }
    return codes;
}

double distance(const LogSpace& space, const LogMaterial& a, const LogMaterial& b) {
    const auto terms = static_cast<Eigen::Index>(logTerms().size());
    const std::size_t channels = std::max(a.channels(), b.channels());
    // A grey material has its one channel for every colour.
    const auto channel = [&](const LogMaterial& m, std::size_t c) {
        return Eigen::Map<const Eigen::VectorXd>(
            m.exponents.data() + (m.channels() == 1 ? 0 : c) * logTerms().size(), terms);
    };
    double sum = 0;
    for (std::size_t c = 0; c < channels; ++c)
        sum += (space.samples().lower.transpose() * (channel(a, c) - channel(b, c))).squaredNorm();
    return std::sqrt(sum / static_cast<double>(channels));
}

}  // namespace hshfit::material_library
