#include <hshfit/representation/halfway/halfway.h>

#include <hshfit/error.h>
#include <hshfit/representation/halfway/halfway_rounding.h>
#include <hshfit/representation/halfway/internal/halfway_fit.h>
#include <hshfit/representation/halfway/internal/halfway_limit.h>
#include <hshfit/version.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hshfit::inline representation::inline halfway {
namespace {

constexpr std::size_t fewestFitted = 1 << 14, mostFitted = 1 << 18, heldOutPairs = 1 << 15;
/// Change of the error of the pairs that are held out at which their number is enough.
constexpr double settled = 0.02;
/// Of the mean of the diagonal, where orders are ranked.
constexpr double rankRegularisation = 1e-6;
/// Of albedo / pi: below that, f counts as this where it is bounded.
constexpr double darkest = 1e-3;

CoefficientHead headFor(const Brdf& brdf, bool reciprocal) {
    CoefficientHead head;
    head.channels = brdf.channels();
    head.isotropic = brdf.laws().isotropic;
    head.bilateral = brdf.laws().mirrorSymmetric || (reciprocal && brdf.laws().isotropic);
    head.reciprocal = reciprocal || brdf.laws().reciprocal;
    head.source = brdf.name();
    head.generator = std::string("hshfit ") + version;
    head.tolerance = settled;
    head.outgoing.directions.clear();
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    head.energy = {none, none, false, "the halfway form expands ln(1 + f)"};
    return head;
}

HalfwaySamples heldOut(const Brdf& brdf) {
    HalfwaySamples samples;
    appendSamples(brdf, HalfwayPart::heldOut, 0, heldOutPairs, samples);
    return samples;
}

/// Orders that fill a budget, one for each pair of orders along v and the azimuth.
std::vector<HalfwayOrders> candidates(std::size_t mostInBudget, const HalfwaySymmetry& symmetry) {
    std::vector<HalfwayOrders> found;
    for (int difference = 2; difference <= 8; ++difference) {
        for (int azimuth = 1; azimuth <= 7; ++azimuth) {
            int half = 16;
            const auto terms = [&] {
                return HalfwayTerms({half, difference, azimuth}, symmetry).size();
            };
            while (half >= 4 && terms() > std::min(mostInBudget, mostHalfwayTerms)) --half;
            if (half >= 4) found.push_back({half, difference, azimuth});
        }
    }
    return found;
}

bool within(const HalfwayOrders& a, const HalfwayOrders& b) {
    return a.half <= b.half && a.difference <= b.difference && a.azimuth <= b.azimuth;
}

bool same(const HalfwayTerm& a, const HalfwayTerm& b) {
    return a.i == b.i && a.j == b.j && a.k == b.k && a.q == b.q && a.exchange == b.exchange &&
           a.mirror == b.mirror && a.sine == b.sine;
}

/// The weighted squares that the terms of `part` leave if the others are 0.
double residual(const HalfwayTerms& all, const HalfwayTerms& part,
                const std::vector<HalfwaySystem>& systems) {
    std::vector<Eigen::Index> kept;
    for (const HalfwayTerm& term : part.list()) {
        const auto at = std::find_if(all.list().begin(), all.list().end(),
                                     [&](const HalfwayTerm& t) { return same(t, term); });
        kept.push_back(at - all.list().begin());
    }
    std::vector<HalfwaySystem> smaller;
    for (const HalfwaySystem& system : systems) {
        smaller.push_back({system.gram(kept, kept), system.right(kept), system.squares});
    }
    const HalfwayValues values = solveHalfway(smaller, rankRegularisation);
    double total = 0;
    for (std::size_t c = 0; c < smaller.size(); ++c) {
        total +=
            smaller[c].squares - values.col(static_cast<Eigen::Index>(c)).dot(smaller[c].right);
    }
    return total;
}

}  // namespace

Representation projectHalfway(const Brdf& brdf, const HalfwayOrders& orders,
                              const ProjectionOptions& options, bool reciprocal) {
    Representation r;
    r.head = headFor(brdf, reciprocal);
    r.halfway = orders;
    const HalfwayTerms terms(orders, halfwaySymmetryOf(r.head));
    if (terms.size() > mostHalfwayTerms) {
        throw UsageError(fmt::format(
            "orders {},{},{} of the halfway form make {} terms a channel; "
            "it fits up to {}",
            orders.half, orders.difference, orders.azimuth, terms.size(), mostHalfwayTerms));
    }
    const HalfwaySamples left = heldOut(brdf);
    HalfwaySamples samples;
    HalfwayFit fit;
    const std::size_t most = std::clamp(options.maxEvaluations, fewestFitted, mostFitted);
    double error = 0, change = 1;
    for (std::size_t first = 0, last = fewestFitted;; first = last, last *= 2) {
        appendSamples(brdf, HalfwayPart::fitted, first, last, samples);
        // A fit to fewer pairs than several times the terms says nothing: go on at once.
        if (samples.size() < 24 * terms.size() && 2 * last <= most) continue;
        fit = fitHalfway(terms, samples, std::move(fit.values));
        const double before = error;
        error = halfwayLoss(left, halfwaySums(terms, left, fit.values));
        change = before > 0 ? std::abs(before - error) / before : 1;
        if (options.progress) options.progress(last, most);
        if (error == 0 || (before > 0 && change < settled) || 2 * last > most) break;
    }
    if (options.progress) options.progress(most, most);
    const HalfwayAlbedo albedo = albedoOf(brdf, r.head.reciprocal);
    fit = heldToAlbedo(terms, samples, albedo, {}, std::move(fit));
    const HalfwayBounds bounds =
        boundsOf(brdf, r.head.reciprocal, darkest * albedo.greatestMean() / pi);
    EnvelopeArray limit = chooseLimit(terms, bounds, left, albedo, fit.values);
    fit = heldToAlbedo(terms, samples, albedo, capsAt(limit, r.head.reciprocal, albedo.places),
                       std::move(fit));
    StoredArray array{.shape = {r.head.channels.count(), terms.size()}, .values = {}};
    array.values.assign(fit.values.data(), fit.values.data() + fit.values.size());
    r.head.error = halfwayLoss(left, halfwaySums(terms, left, fit.values),
                               capsAt(limit, r.head.reciprocal, left.places));
    r.content = HalfwayArray{std::move(array), std::move(limit)};
    r.steps.push_back({fmt::format("halfway {},{},{}: mean log error over pairs held out",
                                   orders.half, orders.difference, orders.azimuth),
                       r.head.error});
    return r;
}

double halfwayError(const Brdf& brdf, const Representation& representation) {
    const HalfwayExpansion checked(representation);
    const std::vector<double>& stored =
        std::get<HalfwayArray>(representation.content).halfway.values;
    const HalfwayValues values = Eigen::Map<const HalfwayValues>(
        stored.data(), static_cast<Eigen::Index>(checked.terms().size()),
        static_cast<Eigen::Index>(representation.head.channels.count()));
    const HalfwaySamples left = heldOut(brdf);
    std::vector<double> caps;
    if (const auto& envelope = representation.as<HalfwayArray>()->envelope) {
        caps = capsAt(*envelope, representation.head.reciprocal, left.places);
    }
    return halfwayLoss(left, halfwaySums(checked.terms(), left, values), caps);
}

namespace {

/// The best orders whose expansion takes at most `room`, and what its representation takes.
struct OrdersFound {
    HalfwayOrders orders;
    std::size_t bytes = 0;
};

OrdersFound ordersWithin(const Brdf& brdf, std::size_t room, Precision precision,
                         const ProjectionOptions& options, bool reciprocal) {
    const CoefficientHead head = headFor(brdf, reciprocal);
    const HalfwaySymmetry symmetry = halfwaySymmetryOf(head);
    const std::size_t channels = head.channels.count();
    std::size_t most = 0;
    while (storedBytes({.shape = {channels, most + 1},
                        .precision = precision,
                        .values = std::vector<double>(channels * (most + 1))}) <= room) {
        ++most;
    }
    std::vector<HalfwayOrders> known = candidates(most, symmetry);
    if (known.empty()) {
        throw UsageError(fmt::format("{} bytes are too few for the halfway form of {} channels",
                                     room, channels));
    }
    HalfwayOrders largest = known[0];
    for (const HalfwayOrders& o : known) {
        largest = {std::max(largest.half, o.half), std::max(largest.difference, o.difference),
                   std::max(largest.azimuth, o.azimuth)};
    }
    const HalfwayTerms all(largest, symmetry);
    HalfwaySamples samples;
    appendSamples(brdf, HalfwayPart::fitted, 0, std::max(fewestFitted, 16 * all.size()), samples);
    HalfwayPass pass = halfwayPass(all, samples, {});
    pass = halfwayPass(all, samples, solveHalfway(pass.systems, rankRegularisation));

    std::vector<std::pair<double, HalfwayOrders>> ranked;
    for (const HalfwayOrders& o : known) {
        const bool contained = std::any_of(known.begin(), known.end(), [&](const auto& other) {
            return within(o, other) && !within(other, o);
        });
        if (!contained) ranked.push_back({residual(all, {o, symmetry}, pass.systems), o});
    }
    std::stable_sort(ranked.begin(), ranked.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    constexpr std::size_t fitted = 4;
    double least = std::numeric_limits<double>::infinity();
    OrdersFound best;
    for (std::size_t n = 0; n < std::min(fitted, ranked.size()); ++n) {
        Representation r = projectHalfway(brdf, ranked[n].second, options, reciprocal);
        quantiseHalfway(r, precision, brdf);
        const double error = halfwayError(brdf, r);
        if (error < least) {
            least = error;
            best = {ranked[n].second, r.bytes()};
        }
    }
    return best;
}

}  // namespace

HalfwayOrders chooseHalfwayOrders(const Brdf& brdf, std::size_t bytes, Precision precision,
                                  const ProjectionOptions& options, bool reciprocal) {
    // The envelope takes its part, which shows when it is fitted.
    std::size_t room = bytes;
    while (true) {
        const OrdersFound found = ordersWithin(brdf, room, precision, options, reciprocal);
        if (found.bytes <= bytes) return found.orders;
        room -= std::min(room, found.bytes - bytes);
    }
}

}  // namespace hshfit::inline representation::inline halfway
