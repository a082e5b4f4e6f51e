#include <hshfit/material_library/basis.h>

#include <hshfit/material_library/internal/least_in_steps.h>
#include <hshfit/material_library/internal/log_samples.h>
#include <hshfit/material_library/log_terms.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

namespace hshfit::material_library {
namespace {

constexpr int mostTop = 255;
constexpr std::array<double, scaleCodes> stepScales{0.5, 0.75, 1, 1.5};
/// The weights of colours of lit pixels, and of their channels each, where all pairs have 1.
constexpr double colourWeight = 48, litWeight = 2;

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

}  // namespace

double stepScale(unsigned code) {
    return stepScales[code];
}

std::size_t Basis::channelBytes() const {
    std::size_t bits = scaled ? scaleBits : 0;
    for (const std::uint8_t width : widths) bits += width;
    return 1 + (bits + 7) / 8;
}

std::size_t Basis::bytes() const {
    return 4 * mean.size() + 2 * components.size() + widths.size() + 4;
}

std::vector<std::uint8_t> pack(const Basis& basis, std::span<const double> coordinates, double top,
                               unsigned scale) {
    assert(coordinates.size() == basis.size());
    assert(basis.scaled ? scale < scaleCodes : scale == plainScale);
    std::vector<std::uint8_t> code(basis.channelBytes(), 0);
    code[0] = topCode(top);
    std::size_t bit = 8;
    const auto put = [&](unsigned number, int width) {
        for (int b = 0; b < width; ++b, ++bit)
            code[bit / 8] |= static_cast<std::uint8_t>((number >> b & 1u) << bit % 8);
    };
    if (basis.scaled) put(scale, scaleBits);
    const double step = stepScale(scale) * basis.step;
    for (std::size_t k = 0; k < basis.size(); ++k) {
        const int half = halfRange(basis.widths[k]);
        const double most = half - 1;
        const double steps = std::clamp(std::round(coordinates[k] / step), -most, most);
        put(static_cast<unsigned>(static_cast<int>(steps) + half), basis.widths[k]);
    }
    return code;
}

ChannelCode unpack(const Basis& basis, std::span<const std::uint8_t> code) {
    assert(code.size() == basis.channelBytes());
    ChannelCode channel{.coordinates = {}, .top = topOf(code[0])};
    std::size_t bit = 8;
    const auto take = [&](int width) {
        unsigned number = 0;
        for (int b = 0; b < width; ++b, ++bit) number |= (code[bit / 8] >> bit % 8 & 1u) << b;
        return number;
    };
    if (basis.scaled) channel.scale = take(scaleBits);
    const double step = stepScale(channel.scale) * basis.step;
    for (const std::uint8_t width : basis.widths)
        channel.coordinates.push_back(step * (static_cast<int>(take(width)) - halfRange(width)));
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

namespace {

/// The cost of coordinates a of all channels, a^T gram a - 2 a^T right: the first coordinate of
/// each channel, then the second.
struct Cost {
    double of(const Eigen::VectorXd& a) const { return a.dot(gram * a) - 2 * a.dot(right); }

    Eigen::MatrixXd gram;
    Eigen::VectorXd right;
};

}  // namespace

struct Encoder::Metric {
    Metric(const Basis& basis, const LogSpace& space);
    Cost costOf(const LogMaterial& material, Eigen::Index used) const;

    const LogSamples& samples;
    Eigen::VectorXd mean;
    Eigen::MatrixXd measured;  ///< components times the metric of all pairs
    Eigen::MatrixXd gram;      ///< that times components
    Eigen::MatrixXd seen;      ///< components at the pairs of pictures, [component][pair]
    Eigen::MatrixXd few;       ///< and at the few pairs of the samples
};

Encoder::Metric::Metric(const Basis& basis, const LogSpace& space)
    : samples(space.samples()),
      mean(Eigen::Map<const Eigen::VectorXd>(basis.mean.data(),
                                             static_cast<Eigen::Index>(basis.mean.size()))),
      measured(matrixOf(basis) * samples.metric),
      gram(measured * matrixOf(basis).transpose()),
      seen(matrixOf(basis) * samples.seen.terms.transpose()),
      few(matrixOf(basis) * samples.few().transpose()) {}

Encoder::Encoder(const Basis& basis, const LogSpace& space)
    : basis_(basis), metric_(std::make_unique<const Metric>(basis, space)) {}

Encoder::~Encoder() = default;

Cost Encoder::Metric::costOf(const LogMaterial& material, Eigen::Index used) const {
    const auto channels = static_cast<Eigen::Index>(material.channels());
    const Eigen::Map<const Eigen::MatrixXd> exponents(material.exponents.data(), mean.size(),
                                                      channels);
    const Eigen::MatrixXd logs = samples.seen.logs(material),
                          peaks =
                              samples.peakWeights(samples.peakLogs(material), LogSamples::peakStep),
                          off = exponents.colwise() - mean, offFew = samples.few() * off,
                          offSeen = samples.seen.terms * off;
    const auto usedSeen = seen.topRows(used), usedFew = few.topRows(used);
    Eigen::MatrixXd pictures = colourWeight * samples.seen.colours(logs);
    const Eigen::MatrixXd lit = litWeight * samples.seen.weights(logs);
    Cost cost{Eigen::MatrixXd(used * channels, used * channels),
              Eigen::VectorXd::Zero(used * channels)};
    for (Eigen::Index c = 0; c < channels; ++c) {
        pictures.col(c * channels + c) += lit.col(c);
        const auto row = Eigen::seqN(c, used, channels);
        for (Eigen::Index d = 0; d < channels; ++d) {
            const auto weight = pictures.col(c * channels + d);
            const Eigen::MatrixXd inPictures = usedSeen * weight.asDiagonal();
            cost.gram(row, Eigen::seqN(d, used, channels)) = inPictures * usedSeen.transpose();
            cost.right(row) += inPictures * offSeen.col(d);
        }
        const Eigen::MatrixXd atPeaks = usedFew * peaks.col(c).asDiagonal();
        cost.gram(row, row) += gram.topLeftCorner(used, used) + atPeaks * usedFew.transpose();
        cost.right(row) += measured.topRows(used) * off.col(c) + atPeaks * offFew.col(c);
    }
    return cost;
}

std::vector<std::uint8_t> Encoder::encode(const LogMaterial& material,
                                          std::size_t components) const {
    const std::size_t used = std::min(components, basis_.size()), channels = material.channels();
    const Cost cost = metric_->costOf(material, static_cast<Eigen::Index>(used));
    Eigen::VectorXd most(cost.right.size());  // steps
    for (Eigen::Index k = 0; k < most.size(); ++k)
        most[k] = halfRange(basis_.widths[static_cast<std::size_t>(k) / channels]) - 1;
    Eigen::VectorXd all;
    unsigned scale = plainScale;
    double least = std::numeric_limits<double>::infinity();
    for (unsigned code = 0; code < scaleCodes; ++code) {
        if (!basis_.scaled && code != plainScale) continue;
        const double step = stepScale(code) * basis_.step;
        Eigen::VectorXd found =
            step * leastInSteps(step * step * cost.gram, step * cost.right, most);
        const double sum = cost.of(found);
        if (all.size() > 0 && !(sum < least)) continue;
        least = sum;
        scale = code;
        all = std::move(found);
    }
    std::vector<std::uint8_t> codes;
    for (std::size_t c = 0; c < channels; ++c) {
        std::vector<double> coordinates(basis_.size(), 0.0);
        for (std::size_t k = 0; k < used; ++k)
            coordinates[k] = all[static_cast<Eigen::Index>(k * channels + c)];
        const std::vector<std::uint8_t> one = pack(basis_, coordinates, material.tops[c], scale);
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
