#include <hshfit/representation/halfway/halfway_rounding.h>

#include <hshfit/representation/halfway/halfway.h>
#include <hshfit/representation/halfway/internal/halfway_albedo.h>
#include <hshfit/representation/halfway/internal/halfway_fit.h>
#include <hshfit/representation/halfway/internal/halfway_lobe.h>

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace hshfit::inline representation::inline halfway {
namespace {

/// Parts of the mean of the diagonal, which leave to rounding what no pair sees. With a small part
/// the other coefficients make up for much: more, at times, than their grids hold, or than the
/// normal equations hold for. All are tried.
constexpr std::array regularisations{1e-9, 1e-7, 1e-5, 1e-3};
constexpr double greatestHalf = 65504;

/// The numbers that one coefficient may have.
struct Grid {
    Precision precision;
    double offset = 0, scale = 0, steps = 0;

    /// The distance of neighbours about `value`.
    double step(double value) const {
        return precision == Precision::half ? std::abs(value) / 1024 : scale / steps;
    }
    double nearest(double value) const {
        if (precision == Precision::half) {
            StoredArray one{.shape = {1},
                            .values = {std::clamp(value, -greatestHalf, greatestHalf)}};
            quantise(one, Precision::half);
            return one.values[0];
        }
        if (!(scale > 0)) return offset;
        return offset + scale *
                            std::nearbyint(std::clamp((value - offset) / scale, 0.0, 1.0) * steps) /
                            steps;
    }
};

Grid gridOf(const StoredArray& rounded, std::size_t at) {
    Grid grid{.precision = rounded.precision};
    if (rounded.precision == Precision::half) return grid;
    const std::size_t group = at % rounded.columns() / rounded.groupColumns();
    grid.offset = static_cast<double>(rounded.offsets[group]);
    grid.scale = static_cast<double>(rounded.scales[group]);
    grid.steps = rounded.precision == Precision::unorm16 ? 65535 : 255;
    return grid;
}

/// Rounds one channel, given H.
void roundChannel(const Eigen::MatrixXd& gram, double regularisation, const double* fitted,
                  const StoredArray& rounded, std::size_t first, double* out) {
    const auto terms = static_cast<std::size_t>(gram.rows());
    std::vector<std::size_t> order;
    for (std::size_t t = 0; t < terms; ++t) {
        const bool kept = rounded.kept.empty() || rounded.kept[first + t];
        out[t] = fitted[t];
        if (kept) order.push_back(t);
    }
    const auto stepOf = [&](std::size_t t) { return gridOf(rounded, first + t).step(fitted[t]); };
    std::ranges::stable_sort(order, {}, stepOf);
    const auto count = static_cast<Eigen::Index>(order.size());
    Eigen::MatrixXd h(count, count);
    for (Eigen::Index r = 0; r < count; ++r) {
        for (Eigen::Index c = 0; c < count; ++c) {
            h(r, c) = gram(static_cast<Eigen::Index>(order[static_cast<std::size_t>(r)]),
                           static_cast<Eigen::Index>(order[static_cast<std::size_t>(c)]));
        }
    }
    h.diagonal().array() += regularisation * h.diagonal().mean() + 1e-300;
    const Eigen::MatrixXd upper = h.llt().matrixU();
    Eigen::VectorXd off = Eigen::VectorXd::Zero(count);  // fitted less rounded
    for (Eigen::Index i = count - 1; i >= 0; --i) {
        const std::size_t t = order[static_cast<std::size_t>(i)];
        const Eigen::Index after = count - 1 - i;
        const double owed = upper.row(i).tail(after).dot(off.tail(after)) / upper(i, i);
        out[t] = gridOf(rounded, first + t).nearest(fitted[t] + (std::isfinite(owed) ? owed : 0));
        off[i] = fitted[t] - out[t];
    }
}

}  // namespace

void quantiseHalfway(Representation& representation, Precision precision, const Brdf& brdf) {
    HalfwayArray& content = *representation.as<HalfwayArray>();
    const std::vector<double> fitted = content.halfway.values;
    StoredArray& rounded = content.halfway;
    quantise(rounded, precision, "halfway");
    if (precision == Precision::float64 || precision == Precision::float32) return;

    const HalfwayTerms terms(representation.halfway, halfwaySymmetryOf(representation.head));
    const HalfwayAxes axes(content.lobe);
    const std::size_t channels = representation.head.channels.count();
    const HalfwayValues values =
        Eigen::Map<const HalfwayValues>(fitted.data(), static_cast<Eigen::Index>(terms.size()),
                                        static_cast<Eigen::Index>(channels));
    HalfwaySamples samples;
    appendSamples(brdf, HalfwayPart::fitted, 0,
                  halfwayPairsFor(terms, representation.head.isotropic), samples);
    const HalfwayAlbedo albedo = albedoOf(brdf, representation.head.reciprocal);
    const HalfwayModel model{terms, axes, halfwayFloor(albedo)};
    const HalfwayData data{samples, &albedo, fineHuber};
    const std::vector<HalfwaySystem> systems =
        halfwaySystems(model, data, values, std::vector<HalfwayNeed>(channels, HalfwayNeed::all));
    std::vector<double> found(fitted.size()), tried(fitted.size());
    std::vector<double> least(channels, std::numeric_limits<double>::infinity());
    for (const double regularisation : regularisations) {
        for (std::size_t c = 0; c < channels; ++c) {
            const std::size_t first = c * terms.size();
            roundChannel(systems[c].gram, regularisation, fitted.data() + first, rounded, first,
                         tried.data() + first);
        }
        const auto losses = halfwaySystems(
            model, data,
            Eigen::Map<const HalfwayValues>(tried.data(), values.rows(), values.cols()),
            std::vector<HalfwayNeed>(channels, HalfwayNeed::loss));
        for (std::size_t c = 0; c < channels; ++c) {
            if (!(losses[c].loss < least[c])) continue;
            least[c] = losses[c].loss;
            const auto first = static_cast<std::ptrdiff_t>(c * terms.size());
            std::copy_n(tried.begin() + first, terms.size(), found.begin() + first);
        }
    }
    rounded.values = std::move(found);
}

}  // namespace hshfit::inline representation::inline halfway
