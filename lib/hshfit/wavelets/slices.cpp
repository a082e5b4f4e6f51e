#include <hshfit/wavelets/slices.h>

#include <hshfit/error.h>

#include <Imath/half.h>
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hshfit::wavelets {
namespace {

using Domain = Partition::Domain;

/// Levels of TermsBrdf: as many functions as an index of two bytes names.
constexpr int storedLevels = 7;
constexpr std::size_t indexBytes = 2;

/// The centres of the leaves as a batch.
struct Centres {
    std::vector<double> x, y, z;

    explicit Centres(const Partition& partition) {
        for (const Triangle& leaf : partition.level(partition.levels())) {
            const Direction d = centreOf(leaf);
            x.push_back(d.x);
            y.push_back(d.y);
            z.push_back(d.z);
        }
    }
    DirectionBatch batch() const { return {x.data(), y.data(), z.data(), x.size()}; }
};

/// Coefficients of one outgoing direction, [channel][function].
std::vector<double> coefficientsAt(const Brdf& brdf, const Direction& wo, Quantity quantity,
                                   const Partition& partition, const Centres& centres) {
    const std::size_t leaves = partition.leaves(), channels = brdf.channels().count();
    std::vector<double> values(channels * leaves), coefficients(channels * leaves);
    brdf.eval(wo, centres.batch(), values.data());
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (!std::isfinite(values[i])) {
            throw NumericError(fmt::format(
                "{}: f is {} at theta_i = {:.4g}, theta_o = {:.4g} degrees", brdf.name(), values[i],
                degrees(std::acos(centres.z[i % leaves])), degrees(polarAngle(wo))));
        }
        if (quantity == Quantity::brdfCosine) values[i] *= centres.z[i % leaves];
    }
    for (std::size_t channel = 0; channel < channels; ++channel) {
        analyse(partition, values.data() + channel * leaves,
                coefficients.data() + channel * leaves);
    }
    return coefficients;
}

/// Captured energies of one level: [k], and of all terms last.
std::vector<double> capturedAt(const Brdf& brdf, const OutgoingSet& outgoing, std::size_t most,
                               Quantity quantity, int levels) {
    const Partition partition(Domain::hemisphere, levels);
    const Centres centres(partition);
    std::vector<std::vector<double>> each(outgoing.size());
    tbb::parallel_for(std::size_t{0}, outgoing.size(), [&](std::size_t k) {
        each[k].assign(most + 2, 0.0);
        if (outgoing.solidAngles[k] == 0) return;
        const std::vector<double> coefficients =
            coefficientsAt(brdf, outgoing.directions[k], quantity, partition, centres);
        for (std::size_t first = 0; first < coefficients.size(); first += partition.leaves()) {
            const std::span<const double> one(coefficients.data() + first, partition.leaves());
            const std::vector<double> captured = capturedByTerms(one, most);
            for (std::size_t t = 0; t <= most; ++t) each[k][t] += captured[t];
            for (const double c : one) each[k][most + 1] += c * c;
        }
    });
    std::vector<double> sum(most + 2, 0.0);
    for (std::size_t k = 0; k < each.size(); ++k) {
        for (std::size_t t = 0; t < sum.size(); ++t) sum[t] += outgoing.solidAngles[k] * each[k][t];
    }
    return sum;
}

double rounded(double value, ValueBytes width) {
    const auto single = static_cast<float>(value);
    return width == ValueBytes::half ? static_cast<float>(Imath::half(single)) : single;
}

}  // namespace

SliceCurve sliceCurve(const Brdf& brdf, const OutgoingSet& outgoing, std::size_t most,
                      const SliceOptions& options) {
    SliceCurve curve;
    std::vector<double> before;
    for (int level = options.firstLevel; level <= options.lastLevel; ++level) {
        std::vector<double> now = capturedAt(brdf, outgoing, most, options.quantity, level);
        curve.levels = level;
        curve.evaluations += outgoing.size() * (std::size_t{4} << (2 * level));
        curve.energy = now.back();
        curve.error = std::numeric_limits<double>::quiet_NaN();
        if (!before.empty()) {
            double change = 0;
            for (std::size_t t = 0; t < now.size(); ++t) {
                change = std::max(change, std::abs(now[t] - before[t]));
            }
            curve.error = now.back() > 0 ? change / now.back() / 3 : 0;
        }
        before = std::move(now);
        if (curve.error < options.tolerance) break;
    }
    before.pop_back();
    curve.captured = std::move(before);
    return curve;
}

std::shared_ptr<const TermsBrdf::Source> TermsBrdf::project(const Brdf& brdf,
                                                            const OutgoingSet& outgoing,
                                                            Quantity quantity, std::size_t most) {
    static const auto partition =
        std::make_shared<const Partition>(Domain::hemisphere, storedLevels);
    static const Centres centres(*partition);
    auto source = std::make_shared<Source>();
    *source = {partition, outgoing, brdf.channels(), brdf.laws(), brdf.name(), quantity, {}};
    const std::size_t channels = brdf.channels().count();
    source->terms.resize(outgoing.size() * channels);
    tbb::parallel_for(std::size_t{0}, outgoing.size(), [&](std::size_t k) {
        const std::vector<double> coefficients =
            coefficientsAt(brdf, outgoing.directions[k], quantity, *partition, centres);
        for (std::size_t channel = 0; channel < channels; ++channel) {
            source->terms[k * channels + channel] = bestTerms(
                {coefficients.data() + channel * partition->leaves(), partition->leaves()}, most);
        }
    });
    return source;
}

TermsBrdf::TermsBrdf(std::shared_ptr<const Source> source, std::size_t terms, ValueBytes width)
    : source_(std::move(source)), count_(terms), width_(width) {
    laws_.isotropic = source_->laws.isotropic;
    laws_.mirrorSymmetric = false;
    for (const std::vector<Term>& all : source_->terms) {
        std::vector<double> values;
        for (const Term& term : all) values.push_back(term.value);
        std::vector<Term>& kept = terms_.emplace_back();
        for (const Term& term : bestTerms(values, terms)) {
            kept.push_back({all[term.index].index, rounded(term.value, width)});
        }
    }
}

std::size_t TermsBrdf::bytes() const {
    return terms_.size() * count_ * (static_cast<std::size_t>(width_) + indexBytes);
}

void TermsBrdf::eval(const Direction& wo, DirectionBatch wi, double* out) const {
    const std::size_t channels = source_->channels.count();
    const OutgoingLookup found = lookUp(source_->outgoing, wo);
    for (std::size_t k = 0; k < wi.count; ++k) {
        const Direction d{wi.x[k], wi.y[k], wi.z[k]};
        const bool above = d.z > 0 && wo.z > 0;
        const Direction turned = rotateAboutZ(d, -found.turn);
        for (std::size_t channel = 0; channel < channels; ++channel) {
            double sum = 0;
            for (int n = 0; above && n < found.count; ++n) {
                sum +=
                    found.weight[n] * valueOf(*source_->partition,
                                              terms_[found.index[n] * channels + channel], turned);
            }
            if (above && source_->quantity == Quantity::brdfCosine) sum /= d.z;
            out[channel * wi.count + k] = sum;
        }
    }
}

}  // namespace hshfit::wavelets
