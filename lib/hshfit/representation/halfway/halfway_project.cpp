#include <hshfit/representation/halfway/halfway.h>

#include <hshfit/error.h>
#include <hshfit/representation/halfway/halfway_rounding.h>
#include <hshfit/representation/halfway/internal/halfway_albedo.h>
#include <hshfit/representation/halfway/internal/halfway_fit.h>
#include <hshfit/representation/halfway/internal/halfway_lobe.h>
#include <hshfit/version.h>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

namespace hshfit::inline representation::inline halfway {
namespace {

constexpr std::size_t fewestPairs = 1 << 14;
constexpr std::size_t heldOutPairs = 1 << 15, heldOutOfAll = 1 << 13;
/// The number of steps from constants to the fit of the pairs alone, and of further steps with the
/// albedos.
constexpr int roughSteps = 8, fineSteps = 30;

/// Whether f of an isotropic BRDF changes when both directions are mirrored at a plane by more than
/// the noise of measurements: by a fifth in the mean of |ln|, over pairs about the mirror direction
/// and beside it.
bool hasHandedness(const Brdf& brdf) {
    constexpr std::size_t pairs = 2000;
    constexpr double noise = 0.2, darkest = 1e-3;
    HalfwaySamples samples;
    appendSamples(brdf, HalfwayPart::heldOut, 0, pairs, samples);
    const std::size_t channels = samples.channels();
    std::vector<double> back(channels);
    const double mean = std::accumulate(samples.values.begin(), samples.values.end(), 0.0) /
                        static_cast<double>(samples.values.size());
    if (!(mean > 0)) return false;
    double sum = 0;
    for (std::size_t k = 0; k < samples.size(); ++k) {
        const auto [wi, wo] = samples.pairs[k];
        const Direction beside{wi.x, -wi.y, wi.z};
        brdf.eval({wo.x, -wo.y, wo.z}, {&beside.x, &beside.y, &beside.z, 1}, back.data());
        for (std::size_t c = 0; c < channels; ++c) {
            const double there = samples.values[k * channels + c] + darkest * mean;
            sum += std::abs(std::log((std::max(0.0, back[c]) + darkest * mean) / there));
        }
    }
    return sum > noise * static_cast<double>(samples.values.size());
}

CoefficientHead headFor(const Brdf& brdf, bool reciprocal) {
    CoefficientHead head;
    head.channels = brdf.channels();
    head.isotropic = brdf.laws().isotropic;
    head.bilateral = brdf.laws().mirrorSymmetric ||
                     (brdf.laws().isotropic && (reciprocal || !hasHandedness(brdf)));
    head.reciprocal = reciprocal || brdf.laws().reciprocal;
    head.source = brdf.name();
    head.generator = std::string("hshfit ") + version;
    head.outgoing.directions.clear();
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    head.energy = {none, none, false, "the halfway form is a sum of two exponentials"};
    return head;
}

HalfwaySamples heldOut(const Brdf& brdf, HalfwayPart part, std::size_t count) {
    HalfwaySamples samples;
    appendSamples(brdf, part, 0, count, samples);
    return samples;
}

/// Every n-th of the samples, so that some `count` are left. `grey`: the mean of their channels.
HalfwaySamples thinned(const HalfwaySamples& samples, std::size_t count, bool grey) {
    const std::size_t channels = samples.channels();
    // An odd step meets every way to draw a pair.
    const std::size_t step = std::max<std::size_t>(1, samples.size() / count) | 1U;
    HalfwaySamples few;
    for (std::size_t k = 0; k < samples.size(); k += step) {
        few.pairs.push_back(samples.pairs[k]);
        few.spread.push_back(samples.spread[k]);
        const auto first = samples.values.begin() + static_cast<std::ptrdiff_t>(k * channels);
        const auto last = first + static_cast<std::ptrdiff_t>(channels);
        if (grey) {
            few.values.push_back(std::accumulate(first, last, 0.0) / static_cast<double>(channels));
        } else {
            few.values.insert(few.values.end(), first, last);
        }
    }
    return few;
}

using Progress = std::function<void(std::size_t, std::size_t)>;

/// The steps in all, and the steps that are done.
class Steps {
public:
    Steps(const Progress& call, std::size_t count) : call_(call), count_(count) {}
    void done() {
        if (call_ && done_ + 1 < count_) call_(++done_, count_);
    }
    void finish() const {
        if (call_) call_(count_, count_);
    }

private:
    const Progress& call_;
    std::size_t count_, done_ = 0;
};

/// The coefficients that the pairs alone lead to, with the lobe that they fit best.
HalfwayValues begin(const HalfwaySamples& samples, const HalfwayTerms& terms,
                    const HalfwaySymmetry& symmetry, double floor, HalfwayLobe& lobe,
                    const std::function<void()>& stepDone) {
    const HalfwaySamples few = thinned(samples, 8 * std::max(terms.size(), lobePairs / 8), false);
    HalfwayValues best;
    double least = std::numeric_limits<double>::infinity();
    for (const LobeFound& found :
         chooseLobes(thinned(samples, lobePairs, true), terms.orders(), symmetry, floor)) {
        const HalfwayAxes axes(found.lobe);
        const HalfwayModel model{terms, axes, floor};
        HalfwayErrors errors(model, {few, nullptr, fineHuber});
        HalfwayValues values =
            descended(errors, startFrom(found, model, few, symmetry), roughSteps, stepDone);
        const std::vector<double> losses = errors.losses(values);
        const double loss = std::accumulate(losses.begin(), losses.end(), 0.0);
        if (!(loss < least)) continue;
        least = loss;
        best = std::move(values);
        lobe = found.lobe;
    }
    return best;
}

}  // namespace

Representation projectHalfway(const Brdf& brdf, const HalfwayOrders& asked,
                              const ProjectionOptions& options, bool reciprocal) {
    Representation r;
    r.head = headFor(brdf, reciprocal);
    const HalfwayOrders orders = halfwayOrdersOr(asked, r.head.isotropic, r.head.reciprocal);
    r.halfway = orders;
    const HalfwaySymmetry symmetry = halfwaySymmetryOf(r.head);
    const HalfwayTerms terms(orders, symmetry);
    if (terms.size() > mostHalfwayTerms) {
        throw UsageError(fmt::format(
            "orders {},{},{} of the halfway form make {} terms a channel; "
            "it fits up to {}",
            orders.half, orders.difference, orders.azimuth, terms.size(), mostHalfwayTerms));
    }
    Steps steps(options.progress, static_cast<std::size_t>(mostLobes * roughSteps + fineSteps + 1));
    const HalfwayAlbedo albedo = albedoOf(brdf, r.head.reciprocal);
    const double floor = halfwayFloor(albedo);
    HalfwaySamples samples;
    const std::size_t pairs = halfwayPairsFor(terms, r.head.isotropic);
    appendSamples(brdf, HalfwayPart::fitted, 0,
                  std::min(pairs, std::max(options.maxEvaluations, fewestPairs)), samples);

    const auto stepDone = [&] { steps.done(); };
    HalfwayArray content;
    const HalfwayValues start = begin(samples, terms, symmetry, floor, content.lobe, stepDone);
    const HalfwayAxes axes(content.lobe);
    const HalfwayModel model{terms, axes, floor};
    HalfwayErrors fine(model, {samples, &albedo, fineHuber});
    const HalfwayValues values = descended(fine, start, fineSteps, stepDone);
    content.halfway = {.shape = {r.head.channels.count(), terms.size()}, .values = {}};
    content.halfway.values.assign(values.data(), values.data() + values.size());
    content.ceilings = halfwayCeilings(model, samples, values);
    r.content = std::move(content);
    r.head.error = halfwayError(brdf, r);
    r.steps.push_back({fmt::format("halfway {},{},{}: mean log error over pairs held out",
                                   orders.half, orders.difference, orders.azimuth),
                       r.head.error});
    steps.finish();
    return r;
}

double halfwayError(const Brdf& brdf, const Representation& representation) {
    const HalfwayExpansion form(representation);
    const HalfwaySamples left = heldOut(brdf, HalfwayPart::heldOutUniform, heldOutPairs);
    const std::size_t channels = left.channels();
    std::vector<double> sums(left.size());
    tbb::parallel_for(std::size_t{0}, left.size(), [&](std::size_t k) {
        const auto& [wi, wo] = left.pairs[k];
        std::vector<double> f(channels);
        form.evaluate(wo, {&wi.x, &wi.y, &wi.z, 1}, f.data());
        for (std::size_t c = 0; c < channels; ++c) {
            sums[k] += std::abs(std::log1p(left.values[k * channels + c] * wi.z) -
                                std::log1p(f[c] * wi.z));
        }
    });
    return std::accumulate(sums.begin(), sums.end(), 0.0) /
           static_cast<double>(sums.size() * channels);
}

namespace {

/// The loss of a form as it is stored.
double storedLoss(const Representation& r, const HalfwaySamples& left, double floor) {
    const HalfwayExpansion form(r);
    const StoredArray& array = r.as<HalfwayArray>()->halfway;
    const HalfwayValues values = Eigen::Map<const HalfwayValues>(
        array.values.data(), static_cast<Eigen::Index>(form.terms().size()),
        static_cast<Eigen::Index>(r.head.channels.count()));
    return halfwayLoss({form.terms(), form.axes(), floor}, left, fineHuber, values);
}

/// Orders that are worth a trial, in the order of what they cost.
constexpr std::array ladder{
    HalfwayOrders{3, 2, 1},   HalfwayOrders{4, 3, 2},   HalfwayOrders{5, 4, 3},
    HalfwayOrders{6, 5, 4},   HalfwayOrders{7, 6, 5},   HalfwayOrders{9, 8, 6},
    HalfwayOrders{9, 13, 5},  HalfwayOrders{9, 8, 9},   HalfwayOrders{11, 10, 7},
    HalfwayOrders{13, 12, 8}, HalfwayOrders{16, 12, 9}, HalfwayOrders{18, 14, 11},
    HalfwayOrders{22, 17, 13}};

}  // namespace

HalfwayOrders chooseHalfwayOrders(const Brdf& brdf, std::size_t bytes, Precision precision,
                                  const ProjectionOptions& options, bool reciprocal) {
    constexpr std::size_t tried = 3;
    const CoefficientHead head = headFor(brdf, reciprocal);
    const std::size_t channels = head.channels.count();
    std::vector<HalfwayOrders> within;
    for (const HalfwayOrders& orders : ladder) {
        const HalfwayTerms terms(orders, halfwaySymmetryOf(head));
        Representation empty;
        empty.head = head;
        empty.content =
            HalfwayArray{.halfway = {.shape = {channels, terms.size()},
                                     .precision = precision,
                                     .values = std::vector<double>(channels * terms.size())},
                         .ceilings = std::vector<HalfwayCeiling>(channels)};
        if (terms.size() <= mostHalfwayTerms && empty.bytes() <= bytes) within.push_back(orders);
    }
    if (within.empty()) {
        throw UsageError(fmt::format("{} bytes are too few for the halfway form of {} channels",
                                     bytes, channels));
    }
    const HalfwaySamples left = heldOut(brdf, HalfwayPart::heldOut, heldOutOfAll);
    const double floor = halfwayFloor(albedoOf(brdf, head.reciprocal));
    double least = std::numeric_limits<double>::infinity();
    HalfwayOrders best = within.back();
    for (std::size_t n = within.size() - std::min(tried, within.size()); n < within.size(); ++n) {
        Representation r = projectHalfway(brdf, within[n], options, reciprocal);
        quantiseHalfway(r, precision, brdf);
        const double loss = storedLoss(r, left, floor);
        if (!(loss < least)) continue;
        least = loss;
        best = within[n];
    }
    return best;
}

}  // namespace hshfit::inline representation::inline halfway
