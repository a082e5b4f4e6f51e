#include <hshfit/material_library/internal/seen_pairs.h>

#include <hshfit/brdf/vectors.h>
#include <hshfit/material_library/log_terms.h>
#include <hshfit/pictures/flip.h>
#include <hshfit/pictures/lab.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace hshfit::material_library {
namespace {

using Eigen::Index;

constexpr int columns = 20, rows = columns / 2;  ///< of pixels of half a sphere
constexpr double lowest = 0.02;                  ///< cos(theta_i) of a lit pixel
constexpr double dark = 0.1, darkest = 1e-5;
/// The lightness by which a bright grey changes where ln f changes by 1.
constexpr double brightStep = 40;

/// The pairs of a sphere that is seen from +z, with the lamp in the plane y = 0.
void appendPairs(double lampAngle, std::vector<DirectionPair>& pairs) {
    const Direction lamp = directionFromAngles(lampAngle, 0), eye{0, 0, 1};
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            const double x = (2 * column + 1.0) / columns - 1, y = (row + 0.5) / rows;
            if (x * x + y * y >= 1) continue;
            const Direction n{x, y, std::sqrt(1 - x * x - y * y)};
            if (dot(n, lamp) < lowest) continue;
            const Direction t = normalised(cross({0, 1, 0}, n)), b = cross(n, t);
            const auto inFrame = [&](const Direction& d) {
                return Direction{dot(d, t), dot(d, b), dot(d, n)};
            };
            pairs.push_back({inFrame(lamp), inFrame(eye)});
        }
    }
}

using Jacobian = Eigen::Matrix3d;

/// Columns are derivatives of Hunt-adjusted L*a*b* by the logarithm of R, G and B.
Jacobian huntByLog(const LinearRgb& rgb) {
    static const std::array<std::array<double, 3>, 3> columns{
        relativeXyz({1, 0, 0}), relativeXyz({0, 1, 0}), relativeXyz({0, 0, 1})};
    constexpr double delta = 6.0 / 29;  // below its cube the curve of L*a*b* is linear
    Eigen::Vector3d curve, slope;
    const std::array<double, 3> xyz = relativeXyz(rgb);
    for (Index i = 0; i < 3; ++i) {
        const double t = xyz[static_cast<std::size_t>(i)];
        const bool linear = t <= delta * delta * delta;
        curve[i] = linear ? t / (3 * delta * delta) + 4.0 / 29 : std::cbrt(t);
        slope[i] = linear ? 1 / (3 * delta * delta) : 1 / (3 * curve[i] * curve[i]);
    }
    const double lightness = 116 * curve[1] - 16, a = 500 * (curve[0] - curve[1]),
                 b = 200 * (curve[1] - curve[2]);
    Jacobian jacobian;
    for (std::size_t c = 0; c < 3; ++c) {
        Eigen::Vector3d d;
        for (std::size_t i = 0; i < 3; ++i)
            d[static_cast<Index>(i)] = slope[static_cast<Index>(i)] * columns[c][i] * rgb[c];
        const double dLightness = 116 * d[1];
        jacobian.col(static_cast<Index>(c)) << dLightness,
            0.01 * (dLightness * a + lightness * 500 * (d[0] - d[1])),
            0.01 * (dLightness * b + lightness * 200 * (d[1] - d[2]));
    }
    return jacobian;
}

}  // namespace

SeenPairs::SeenPairs() {
    for (int angle = 5; angle <= 80; angle += 15) {
        first.push_back(pairs.size());
        appendPairs(radians(angle), pairs);
    }
    first.push_back(pairs.size());
    cosines.resize(static_cast<Index>(pairs.size()));
    terms.resize(cosines.size(), static_cast<Index>(logTerms().size()));
    for (Index k = 0; k < cosines.size(); ++k) {
        const DirectionPair& pair = pairs[static_cast<std::size_t>(k)];
        cosines[k] = pair.wi.z;
        logTerms().evaluate(pair.wi, pair.wo, terms.row(k).data());
    }
}

Eigen::MatrixXd SeenPairs::logs(const LogMaterial& material) const {
    const auto channels = static_cast<Index>(material.channels());
    Eigen::MatrixXd logs = terms * Eigen::Map<const Eigen::MatrixXd>(material.exponents.data(),
                                                                     terms.cols(), channels);
    for (Index c = 0; c < channels; ++c)
        logs.col(c) = logs.col(c).cwiseMin(material.tops[static_cast<std::size_t>(c)]);
    return logs;
}

Eigen::MatrixXd SeenPairs::lit(const Eigen::MatrixXd& logs) const {
    Eigen::MatrixXd seen = (logs.array().exp() - logOffset).max(0.0);
    return cosines.asDiagonal() * seen;
}

Eigen::MatrixXd SeenPairs::weights(const Eigen::MatrixXd& logs) const {
    Eigen::MatrixXd seen = lit(logs);
    for (std::size_t lamp = 0; lamp + 1 < first.size(); ++lamp) {
        const auto from = static_cast<Index>(first[lamp]),
                   count = static_cast<Index>(first[lamp + 1]) - from;
        std::vector<double> means(static_cast<std::size_t>(count));
        for (Index k = 0; k < count; ++k)
            means[static_cast<std::size_t>(k)] = seen.row(from + k).mean();
        const auto middle = means.begin() + count / 2;
        std::ranges::nth_element(means, middle);
        auto part = seen.middleRows(from, count).array();
        part = (part / (part + dark * *middle + darkest)).square();
    }
    return seen / static_cast<double>(seen.rows());
}

Eigen::MatrixXd SeenPairs::colours(const Eigen::MatrixXd& logs) const {
    const Eigen::MatrixXd seen = lit(logs);
    const Index channels = seen.cols();
    Eigen::MatrixXd metric(seen.rows(), channels * channels);
    for (std::size_t lamp = 0; lamp + 1 < first.size(); ++lamp) {
        std::vector<double> largest;
        for (std::size_t k = first[lamp]; k < first[lamp + 1]; ++k)
            largest.push_back(seen.row(static_cast<Index>(k)).maxCoeff());
        const std::vector<double> exposures = flipExposures(largest);  // the longest first
        for (std::size_t k = first[lamp]; k < first[lamp + 1]; ++k) {
            const double value = largest[k - first[lamp]];
            const auto shown = std::ranges::find_if(
                exposures, [&](double stops) { return std::exp2(stops) * value < 1; });
            const double exposure = std::exp2(shown == exposures.end() ? exposures.back() : *shown);
            LinearRgb rgb;
            for (Index c = 0; c < 3; ++c)
                rgb[static_cast<std::size_t>(c)] =
                    exposure * seen(static_cast<Index>(k), channels == 1 ? 0 : c);
            Eigen::MatrixXd jacobian = huntByLog(rgb) / brightStep;
            if (channels == 1) jacobian = jacobian.rowwise().sum().eval();
            const Eigen::MatrixXd square = jacobian.transpose() * jacobian;
            metric.row(static_cast<Index>(k)) = square.reshaped().transpose();
        }
    }
    return metric / static_cast<double>(seen.rows());
}

}  // namespace hshfit::material_library
