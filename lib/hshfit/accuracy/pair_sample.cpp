#include <hshfit/accuracy/pair_sample.h>

#include <hshfit/brdf/uniform.h>
#include <hshfit/error.h>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

namespace hshfit::inline accuracy {
namespace {

constexpr double leastSlope = 1e-4, greatestSlope = 10, leastCosine = 1e-4;
/// Shares of the pairs of one wo: evenly, towards lobes, towards the horizon.
constexpr std::array<int, 3> eighths{3, 3, 2};
/// Divisions of the lowest stratum of cos(theta_o).
constexpr std::array<double, 4> lowest{0, 1.0 / 64, 1.0 / 8, 1};
constexpr int givenReplicates = 8;
const double slopeRange = std::log(greatestSlope / leastSlope);
const double cosineRange = std::log(1 / leastCosine);

double fraction(double x) {
    return x - std::floor(x);
}

Direction ofHeight(double mu, double turn) {
    const double s = std::sqrt((1 - mu) * (1 + mu)), phi = 2 * pi * turn;
    return {s * std::cos(phi), s * std::sin(phi), mu};
}

/// Point j of n of a rank-1 lattice, shifted.
std::array<double, 2> latticePoint(int j, int n, const std::array<double, 2>& shift) {
    return {fraction((j + 0.5) / n + shift[0]), fraction(j / std::numbers::phi + shift[1])};
}

/// wi of the half vector whose slope is `a` of the way through the logarithm.
Direction lobeDirection(const Direction& wo, double a, double turn) {
    const double slope = leastSlope * std::exp(a * slopeRange);
    const Direction h = ofHeight(1 / std::sqrt(1 + slope * slope), turn);
    const double twice = 2 * dot(wo, h);
    return {twice * h.x - wo.x, twice * h.y - wo.y, twice * h.z - wo.z};
}

/// Density of the lattices together at wi, per steradian.
double density(const Direction& wo, const Direction& wi) {
    double sum = eighths[0] / (2 * pi);
    if (wi.z >= leastCosine) sum += eighths[2] / (2 * pi * wi.z * cosineRange);
    Direction h{wi.x + wo.x, wi.y + wo.y, wi.z + wo.z};
    const double length = std::sqrt(dot(h, h));
    h = {h.x / length, h.y / length, h.z / length};
    const double sine = std::hypot(h.x, h.y), slope = sine / h.z;
    if (slope >= leastSlope && slope <= greatestSlope) {
        const double perHalf = 1 / (2 * pi * slopeRange * sine * sine * h.z);
        sum += eighths[1] * perHalf / (4 * dot(wo, h));
    }
    return sum / 8;
}

/// Appends the pairs of one wo, which stands for `share` of the hemisphere.
void appendGroup(PairSample& sample, const Direction& wo, double share, int incoming,
                 std::mt19937_64& random) {
    sample.wo.push_back(wo);
    for (std::size_t way = 0; way < eighths.size(); ++way) {
        const double first = uniform(random), second = uniform(random);
        const int count = std::max(1, incoming * eighths[way] / 8);
        for (int j = 0; j < count; ++j) {
            const auto [a, b] = latticePoint(j, count, {first, second});
            const Direction wi = way == 0   ? ofHeight(1 - a, b)
                                 : way == 1 ? lobeDirection(wo, a, b)
                                            : ofHeight(std::exp(-a * cosineRange), b);
            if (!(wi.z > 0)) continue;
            sample.x.push_back(wi.x);
            sample.y.push_back(wi.y);
            sample.z.push_back(wi.z);
            sample.weights.push_back(share / density(wo, wi));
        }
    }
    sample.first.push_back(sample.size());
}

void normalise(std::vector<double>& weights) {
    const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
    for (double& weight : weights) weight /= sum;
}

}  // namespace

bool inZone(PairZone zone, const Direction& wi, const Direction& wo) {
    static const double low = std::cos(80 * pi / 180), near = std::cos(5 * pi / 180);
    if (zone == PairZone::horizon) return std::min(wi.z, wo.z) < low;
    const Direction h{wi.x + wo.x, wi.y + wo.y, wi.z + wo.z};
    return h.z > near * std::sqrt(dot(h, h));
}

const Direction& PairSample::outgoing(std::size_t k) const {
    const auto after = std::upper_bound(first.begin(), first.end(), k);
    return wo[static_cast<std::size_t>(after - first.begin()) - 1];
}

std::size_t bandOf(const Direction& wo) {
    const double degrees = polarAngle(wo) * 180 / pi;
    std::size_t band = 0;
    while (band + 1 < bandCount && degrees >= bandEdges[band + 1]) ++band;
    return band;
}

PairSample spreadPairs(const SpreadOptions& options) {
    assert(options.replicates >= 1 && options.replicates <= 255 && options.incoming >= 2);
    std::mt19937_64 random(options.seed);
    PairSample sample;
    sample.replicates = options.replicates;
    sample.first.push_back(0);
    std::vector<std::array<double, 2>> strata;  // bottom and height, of the cosine
    const double height = 1.0 / options.outgoing;
    for (std::size_t k = lowest.size() - 1; k > 0; --k) {
        strata.push_back({lowest[k - 1] * height, (lowest[k] - lowest[k - 1]) * height});
    }
    for (int s = 1; s < options.outgoing; ++s) strata.push_back({s * height, height});
    const int count = static_cast<int>(strata.size());
    for (int r = 0; r < options.replicates; ++r) {
        const double shift = uniform(random), turn = uniform(random);
        for (int s = 0; s < count; ++s) {
            const auto [within, azimuth] = latticePoint(s, count, {shift, turn});
            const auto [bottom, share] = strata[static_cast<std::size_t>(s)];
            // At most 1 - 1e-9: at the pole, azimuths would say nothing.
            const double mu = std::clamp(bottom + (1 - within) * share, 1e-9, 1 - 1e-9);
            appendGroup(sample, ofHeight(mu, azimuth), share, options.incoming, random);
            sample.stratum.push_back(static_cast<std::size_t>(s));
            sample.replicate.resize(sample.size(), static_cast<unsigned char>(r));
        }
    }
    normalise(sample.weights);
    return sample;
}

PairSample pairsFrom(std::span<const Direction> wi, std::span<const Direction> wo,
                     std::span<const double> weights) {
    PairSample sample;
    sample.replicates = givenReplicates;
    for (std::size_t k = 0; k < wi.size(); ++k) {
        const double weight = weights.empty() ? 1 : weights[k];
        if (!(weight > 0)) {
            throw UsageError(fmt::format("pair {} has weight {}: weights are above 0", k, weight));
        }
        if (!(wi[k].z > 0) || !(wo[k].z > 0)) continue;
        const bool same = !sample.wo.empty() && sample.wo.back().x == wo[k].x &&
                          sample.wo.back().y == wo[k].y && sample.wo.back().z == wo[k].z;
        if (!same) {
            sample.wo.push_back(wo[k]);
            sample.first.push_back(sample.size());
        }
        sample.replicate.push_back(static_cast<unsigned char>(sample.size() % givenReplicates));
        sample.x.push_back(wi[k].x);
        sample.y.push_back(wi[k].y);
        sample.z.push_back(wi[k].z);
        sample.weights.push_back(weight);
    }
    if (sample.size() == 0) throw UsageError("no pair has both directions above the horizon");
    sample.first.push_back(sample.size());
    normalise(sample.weights);
    return sample;
}

std::vector<double> evaluateOn(const Brdf& brdf, const PairSample& pairs, bool serial) {
    const std::size_t channels = brdf.channels().count(), size = pairs.size();
    std::vector<double> values(channels * size);
    const auto one = [&](std::size_t g) {
        const DirectionBatch wi = pairs.group(g);
        std::vector<double> out(channels * wi.count);
        brdf.eval(pairs.wo[g], wi, out.data());
        for (std::size_t c = 0; c < channels; ++c) {
            std::copy_n(out.data() + c * wi.count, wi.count,
                        values.data() + c * size + pairs.first[g]);
        }
    };
    if (serial) {
        for (std::size_t g = 0; g < pairs.wo.size(); ++g) one(g);
    } else {
        tbb::parallel_for(std::size_t{0}, pairs.wo.size(), one);
    }
    return values;
}

}  // namespace hshfit::inline accuracy
