#include <brdfs/hole_filler.h>

#include <hshfit/each_in_parallel.h>
#include <hshfit/linear_algebra/decompositions.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <random>
#include <span>

namespace hshfit::brdfs {
namespace {

/// Degrees in the plane of (theta_d cos phi_d, theta_d sin phi_d).
constexpr std::array<double, 12> rings{1, 2, 3, 4, 6, 8, 11, 15, 20, 27, 36, 48};
constexpr std::size_t around = 16;
constexpr std::size_t enough = 12;

struct Pair {
    Direction wi, wo;
};

Direction combined(double a, const Direction& u, double b, const Direction& v, double c,
                   const Direction& w) {
    return {a * u.x + b * v.x + c * w.x, a * u.y + b * v.y + c * w.y, a * u.z + b * v.z + c * w.z};
}

/// The pairs with one half vector, by their place in the plane.
class SameHalf {
public:
    SameHalf(const Direction& wi, const Direction& wo) {
        const Direction sum{wi.x + wo.x, wi.y + wo.y, wi.z + wo.z};
        const double length = std::sqrt(dot(sum, sum));
        half_ = {sum.x / length, sum.y / length, sum.z / length};
        const double across = std::hypot(half_.x, half_.y);
        // Where the half vector is the normal, the axes follow wi: if the pair is turned about the
        // normal, the axes turn with it.
        const bool tilted = across > 1e-9;
        const Direction& axis = tilted ? half_ : wi;
        const double flatAxis = std::hypot(axis.x, axis.y);
        const double c = flatAxis > 0 ? axis.x / flatAxis : 1,
                     s = flatAxis > 0 ? axis.y / flatAxis : 0;
        along_ = {half_.z * c, half_.z * s, -across};
        aside_ = {-s, c, 0};
        const double x = dot(wi, along_), y = dot(wi, aside_), flat = std::hypot(x, y);
        const double theta = std::atan2(flat, dot(wi, half_));
        a_ = flat > 0 ? theta * x / flat : 0, b_ = flat > 0 ? theta * y / flat : 0;
    }

    /// The pair displaced by (da, db) radians; false below the horizon.
    bool at(double da, double db, Pair& pair) const {
        const double a = a_ + da, b = b_ + db, theta = std::hypot(a, b);
        if (theta >= pi / 2) return false;
        const double scale = theta > 0 ? std::sin(theta) / theta : 1;
        const double flatA = scale * a, flatB = scale * b, up = std::cos(theta);
        pair.wi = combined(flatA, along_, flatB, aside_, up, half_);
        pair.wo = combined(-flatA, along_, -flatB, aside_, up, half_);
        constexpr double horizon = 1e-6;
        return pair.wi.z > horizon && pair.wo.z > horizon;
    }

private:
    Direction half_, along_, aside_;
    double a_ = 0, b_ = 0;
};

bool covers(const Brdf& brdf, const Direction& wi, const Direction& wo) {
    unsigned char covered = 0;
    brdf.coverage(wo, {&wi.x, &wi.y, &wi.z, 1}, &covered);
    return covered != 0;
}

struct Neighbour {
    double a, b, weight;
    std::vector<double> values;
};

/// The value at the middle of the plane's part that the neighbours surround, of one transformed
/// channel.
double middleOf(const std::vector<Neighbour>& neighbours, std::span<const double> values) {
    // A slight pull to 0 of the slopes and, more, of the bend keeps what few neighbours leave open
    // from growing.
    constexpr std::array<double, 4> pull{0, 1e-3, 1e-3, 1e-2};
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Zero();
    Eigen::Vector4d right = Eigen::Vector4d::Zero();
    double reach = 0, total = 0;
    for (const Neighbour& n : neighbours) {
        reach = std::max(reach, std::hypot(n.a, n.b));
        total += n.weight;
    }
    for (std::size_t k = 0; k < neighbours.size(); ++k) {
        const Neighbour& n = neighbours[k];
        const double x = n.a / reach, y = n.b / reach;
        const Eigen::Vector4d terms(1, x, y, x * x + y * y);
        matrix += n.weight * terms * terms.transpose();
        right += n.weight * values[k] * terms;
    }
    for (Eigen::Index i = 0; i < 4; ++i) matrix(i, i) += pull[static_cast<std::size_t>(i)] * total;
    const double middle = matrix.ldlt().solve(right)(0);
    const auto [least, most] = std::ranges::minmax(values);
    return std::clamp(middle, least, most);
}

Pair randomPair(std::mt19937_64& random) {
    const auto draw = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
    const auto direction = [&] {
        const double z = draw(), phi = 2 * pi * draw(), s = std::sqrt(1 - z * z);
        return Direction{s * std::cos(phi), s * std::sin(phi), std::max(z, 1e-4)};
    };
    const Direction wi = direction();
    return {wi, direction()};
}

double quantile(std::vector<double>& sorted, double share) {
    if (sorted.empty()) return 0;
    std::ranges::sort(sorted);
    return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

}  // namespace

HoleFiller::HoleFiller(const Brdf& brdf,
                       const std::function<void(std::size_t, std::size_t)>& progress)
    : brdf_(brdf) {
    findScales();
    measure(progress);
}

void HoleFiller::findScales() {
    constexpr int tries = 2000;
    constexpr double share = 1e-3;
    const std::size_t channels = brdf_.channels().count();
    std::vector<std::vector<double>> sizes(channels);
    std::mt19937_64 random(1);
    for (int k = 0; k < tries; ++k) {
        const Pair pair = randomPair(random);
        if (!covers(brdf_, pair.wi, pair.wo)) continue;
        const std::vector<double> f = evaluate(brdf_, pair.wi, pair.wo);
        for (std::size_t c = 0; c < channels; ++c)
            if (f[c] != 0) sizes[c].push_back(std::abs(f[c]));
    }
    for (std::vector<double>& own : sizes) {
        const double median = quantile(own, 0.5);
        scales_.push_back(median > 0 ? share * median : 1);
    }
}

std::optional<HoleFiller::Prediction> HoleFiller::predict(const Direction& wi, const Direction& wo,
                                                          const Places& only) const {
    const SameHalf plane(wi, wo);
    std::vector<Neighbour> neighbours;
    Prediction prediction;
    prediction.places.resize(rings.size() * around);
    for (std::size_t ring = 0; ring < rings.size() && neighbours.size() < enough; ++ring) {
        const double radius = radians(rings[ring]);
        const double weight = 1 / (rings[ring] * rings[ring]);
        for (std::size_t k = 0; k < around; ++k) {
            const std::size_t place = ring * around + k;
            if (!only.empty() && !only[place]) continue;
            const double turn =
                2 * pi * (static_cast<double>(k) + 0.5 * static_cast<double>(ring % 2)) / around;
            const double a = radius * std::cos(turn), b = radius * std::sin(turn);
            Pair pair;
            if (!plane.at(a, b, pair) || !covers(brdf_, pair.wi, pair.wo)) continue;
            if (neighbours.empty())
                prediction.reach = rings[ring], prediction.a = a, prediction.b = b;
            neighbours.push_back({a, b, weight, evaluate(brdf_, pair.wi, pair.wo)});
            prediction.places[place] = true;
        }
    }
    if (neighbours.empty()) return std::nullopt;
    std::vector<double> transformed(neighbours.size());
    for (std::size_t c = 0; c < scales_.size(); ++c) {
        for (std::size_t k = 0; k < neighbours.size(); ++k)
            transformed[k] = std::asinh(neighbours[k].values[c] / (2 * scales_[c]));
        prediction.values.push_back(2 * scales_[c] * std::sinh(middleOf(neighbours, transformed)));
    }
    return prediction;
}

std::optional<std::vector<double>> HoleFiller::fill(const Direction& wi,
                                                    const Direction& wo) const {
    auto prediction = predict(wi, wo);
    if (!prediction) return std::nullopt;
    return std::move(prediction->values);
}

void HoleFiller::measure(const std::function<void(std::size_t, std::size_t)>& progress) {
    constexpr std::size_t holes = 1000, tries = 100'000;
    std::mt19937_64 random(2);
    std::vector<Pair> found;
    for (std::size_t k = 0; k < tries && found.size() < holes; ++k)
        if (const Pair pair = randomPair(random); !covers(brdf_, pair.wi, pair.wo))
            found.push_back(pair);
    struct Errors {
        double reach = 0;
        Pair at = {};
        std::vector<double> asHole, asNeighbour;
    };
    std::vector<Errors> errors(found.size());
    std::atomic<std::size_t> done = 0;
    eachInParallel(found.size(), [&](std::size_t k) {
        Errors& own = errors[k];
        const auto hole = predict(found[k].wi, found[k].wo);
        if (hole && SameHalf(found[k].wi, found[k].wo).at(hole->a, hole->b, own.at)) {
            own.reach = hole->reach;
            const std::vector<double> f = evaluate(brdf_, own.at.wi, own.at.wo);
            const auto compare = [&](const Places& only, std::vector<double>& to) {
                const auto prediction = predict(own.at.wi, own.at.wo, only);
                if (!prediction) return;
                for (std::size_t c = 0; c < f.size(); ++c)
                    to.push_back(std::abs(prediction->values[c] - f[c]) /
                                 std::max(std::abs(f[c]), 10 * scales_[c]));
            };
            compare(hole->places, own.asHole);
            compare({}, own.asNeighbour);
        }
        if (progress) progress(++done, found.size());
    });
    FillCheck check;
    std::vector<double> asHole, asNeighbour, degrees;
    for (const Errors& own : errors) {
        if (own.asHole.empty()) continue;
        ++check.pairs;
        degrees.push_back(own.reach);
        for (const double error : own.asHole) {
            asHole.push_back(error);
            if (error <= check.largest) continue;
            check.largest = error, check.worstWi = own.at.wi, check.worstWo = own.at.wo;
        }
        asNeighbour.insert(asNeighbour.end(), own.asNeighbour.begin(), own.asNeighbour.end());
    }
    if (check.pairs == 0) return;
    check.median = quantile(asHole, 0.5);
    check.percentile95 = quantile(asHole, 0.95);
    check.noise = 1.4826 * quantile(asNeighbour, 0.5);
    check.reach = quantile(degrees, 0.5);
    check_ = check;
}

}  // namespace hshfit::brdfs
