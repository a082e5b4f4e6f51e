#include <hshfit/material_library/internal/seen_pairs.h>

#include <hshfit/brdf/vectors.h>
#include <hshfit/material_library/log_terms.h>

#include <algorithm>
#include <cmath>

namespace hshfit::material_library {
namespace {

using Eigen::Index;

constexpr int columns = 20, rows = columns / 2;  ///< of pixels of half a sphere
constexpr double lowest = 0.02;                  ///< cos(theta_i) of a lit pixel
constexpr double dark = 0.1, darkest = 1e-5;

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

}  // namespace

SeenPairs::SeenPairs() {
    std::vector<DirectionPair> pairs;
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

Eigen::MatrixXd SeenPairs::weights(const LogMaterial& material) const {
    const auto channels = static_cast<Index>(material.channels());
    Eigen::MatrixXd seen = terms * Eigen::Map<const Eigen::MatrixXd>(material.exponents.data(),
                                                                     terms.cols(), channels);
    for (Index c = 0; c < channels; ++c) {
        const double top = material.tops[static_cast<std::size_t>(c)];
        for (Index k = 0; k < seen.rows(); ++k) {
            const double f = std::exp(std::min(seen(k, c), top)) - logOffset;
            seen(k, c) = std::max(f, 0.0) * cosines[k];
        }
    }
    for (std::size_t lamp = 0; lamp + 1 < first.size(); ++lamp) {
        const auto from = static_cast<Index>(first[lamp]),
                   count = static_cast<Index>(first[lamp + 1]) - from;
        std::vector<double> lit(static_cast<std::size_t>(count));
        for (Index k = 0; k < count; ++k)
            lit[static_cast<std::size_t>(k)] = seen.row(from + k).mean();
        const auto middle = lit.begin() + count / 2;
        std::ranges::nth_element(lit, middle);
        auto part = seen.middleRows(from, count).array();
        part = (part / (part + dark * *middle + darkest)).square();
    }
    return seen / static_cast<double>(seen.rows());
}

}  // namespace hshfit::material_library
