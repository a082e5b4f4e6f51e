#include <hshfit/gpu/forms/library_table.h>

#include <hshfit/accuracy/pair_sample.h>
#include <hshfit/error.h>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <map>

namespace hshfit::gpu::inline forms {
namespace {

constexpr std::size_t coarsest = 2, triedFirst = 4, finest = 11;
constexpr std::size_t blockSize = 256;

/// Cosines for pairs that spreadPairs() has not: even ones, and down to the horizon.
constexpr int cosines = 64;
constexpr double leastCosine = 1e-3;

/// Pairs about the mirror direction down to the horizon, where tables are worst: the cosine of wo
/// from leastCosine on and the slope of the half vector from 1e-4 to 10, both evenly over the
/// logarithm, and its azimuth, by the additive recurrence of the root of x^4 = x + 1.
constexpr int grazing = 8192;

std::vector<DirectionPair> grazingPairs() {
    constexpr double root = 1.2207440846057596;
    std::vector<DirectionPair> pairs;
    for (int n = 1; n <= grazing; ++n) {
        const auto share = [&](double step) { return n * step - std::floor(n * step); };
        const double z = std::pow(leastCosine, share(1 / root));
        const Direction wo{std::sqrt(1 - z * z), 0, z};
        const double slope = 1e-4 * std::pow(1e5, share(1 / (root * root)));
        const Direction h =
            directionFromAngles(std::atan(slope), 2 * pi * share(1 / (root * root * root)));
        const double twice = 2 * dot(h, wo);
        const Direction wi{twice * h.x - wo.x, twice * h.y - wo.y, twice * h.z - wo.z};
        if (wi.z >= leastCosine) pairs.push_back({wi, wo});
    }
    return pairs;
}

std::vector<DirectionPair> pairsOfTables() {
    std::vector<DirectionPair> pairs = grazingPairs();
    const PairSample spread = spreadPairs({.seed = 2});
    for (std::size_t k = 0; k < spread.size(); ++k) {
        const DirectionPair pair{spread.incoming(k), spread.outgoing(k)};
        if (std::min(pair.wi.z, pair.wo.z) >= leastCosine) pairs.push_back(pair);
    }
    for (int n = 0; n < cosines; ++n) {
        const double share = static_cast<double>(n) / (cosines - 1);
        for (const double z :
             {leastCosine + (1 - leastCosine) * share, std::pow(leastCosine, share)}) {
            const Direction wo{std::sqrt(1 - z * z), 0, z};
            pairs.push_back({mirrored(wo), wo});
            pairs.push_back({{0, 0, 1}, wo});
        }
    }
    return pairs;
}

/// A channel of a material: factors of all functions, and the bound.
struct MaterialChannel {
    std::vector<double> factors;
    double top;

    /// ln(f + offset), `least` being ln(offset).
    double valueOf(const double* functions, double least) const {
        double sum = 0;
        for (std::size_t k = 0; k < factors.size(); ++k) sum += factors[k] * functions[k];
        return std::max(std::min(sum, top), least);
    }
};

MaterialChannel channelOf(const SharedSums& sums, std::size_t material, std::size_t c) {
    const double* const texels = &sums.materials[4 * sums.stride() * material];
    MaterialChannel channel{std::vector<double>(sums.functions.head.channels.count(), 0.0), 0};
    if (sums.table) {
        for (std::size_t k = 0; k < channel.factors.size(); ++k)
            channel.factors[k] = texels[4 * (1 + 3 * (k / 4) + c) + k % 4];
    } else {
        channel.factors[0] = 1;
        for (std::size_t p = 0; p < sums.parts.size(); ++p)
            channel.factors[sums.parts[p].function] += sums.parts[p].scale * texels[4 * p + c];
    }
    channel.top =
        sums.topFirst + sums.topStep * texels[(sums.table ? 0 : 4 * sums.parts.size()) + c];
    return channel;
}

std::vector<MaterialChannel> channelsOf(const SharedSums& sums) {
    std::vector<MaterialChannel> channels;
    for (std::size_t n = 0; n < 3 * sums.count(); ++n)
        channels.push_back(channelOf(sums, n / 3, n % 3));
    return channels;
}

}  // namespace

TableError tableError(const SharedSums& exact, const SharedSums& tabled) {
    assert(!exact.table && tabled.table && exact.count() == tabled.count());
    static const std::vector<DirectionPair> pairs = pairsOfTables();
    const HalfwayExpansion functions(exact.functions);
    const std::vector<MaterialChannel> ours = channelsOf(tabled), theirs = channelsOf(exact);
    const double least = std::log(exact.offset);
    std::vector<TableError> parts((pairs.size() + blockSize - 1) / blockSize);
    tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t n) {
        std::vector<double> found(4 * tabled.table->groups());
        const std::size_t end = std::min(pairs.size(), (n + 1) * blockSize);
        for (std::size_t k = n * blockSize; k < end; ++k) {
            const std::vector<double> right =
                sumsAt(functions, functions.axes().at(pairs[k].wi, pairs[k].wo));
            tabled.table->evaluate(pairs[k].wi, pairs[k].wo, FunctionTable::Weights::filtered,
                                   found.data());
            for (std::size_t c = 0; c < ours.size(); ++c) {
                const double error = std::abs(ours[c].valueOf(found.data(), least) -
                                              theirs[c].valueOf(right.data(), least));
                parts[n].largest = std::max(parts[n].largest, error);
                parts[n].mean += error;
            }
        }
    });
    TableError all;
    for (const TableError& part : parts) {
        all.largest = std::max(all.largest, part.largest);
        all.mean += part.mean / static_cast<double>(pairs.size() * ours.size());
    }
    return all;
}

TabledLibrary tabledWithin(const SharedSums& exact, double error) {
    std::map<std::size_t, TabledLibrary> tried;
    const auto with = [&](std::size_t s) -> const TabledLibrary& {
        auto& library = tried[s];
        if (!library.sums.table) {
            library.sums = tabledSums(exact, {8 * s, (9 * s + 1) / 2, (7 * s + 1) / 2});
            library.error = tableError(exact, library.sums);
        }
        return library;
    };
    // The error falls with the square of the number of nodes.
    const double guess =
        static_cast<double>(triedFirst) * std::sqrt(with(triedFirst).error.largest / error);
    auto s = static_cast<std::size_t>(std::clamp<double>(std::ceil(guess), coarsest, finest));
    while (s < finest && with(s).error.largest > error) ++s;
    while (s > coarsest && with(s - 1).error.largest <= error) --s;
    const TabledLibrary& chosen = with(s);
    if (chosen.error.largest <= error) return chosen;
    throw NumericError(fmt::format(
        "no table is within {:.3g} of the functions: that of {} bytes, the largest in 2048 rows, "
        "is off by {:.3g}; ask for that or more, or for 0: functions without a table",
        error, chosen.sums.table->texels().bytes.size(), chosen.error.largest));
}

TabledBrdf::TabledBrdf(const SharedSums& sums, std::size_t material)
    : sums_(sums), material_(material) {
    assert(sums.table && material < sums.count());
    laws_.nonNegative = laws_.isotropic = laws_.mirrorSymmetric = laws_.reciprocal = true;
}

void TabledBrdf::eval(const Direction& wo, DirectionBatch wi, double* out) const {
    std::fill_n(out, 3 * wi.count, 0.0);
    if (!(wo.z > 0)) return;
    const double least = std::log(sums_.offset);
    const MaterialChannel channels[] = {channelOf(sums_, material_, 0),
                                        channelOf(sums_, material_, 1),
                                        channelOf(sums_, material_, 2)};
    std::vector<double> functions(4 * sums_.table->groups());
    for (std::size_t k = 0; k < wi.count; ++k) {
        if (!(wi.z[k] > 0)) continue;
        sums_.table->evaluate({wi.x[k], wi.y[k], wi.z[k]}, wo, FunctionTable::Weights::exact,
                              functions.data());
        for (std::size_t c = 0; c < 3; ++c) {
            const double f = std::exp(channels[c].valueOf(functions.data(), least)) - sums_.offset;
            out[c * wi.count + k] = std::max(f, 0.0);
        }
    }
}

std::vector<Lobe> TabledBrdf::lobes(const Direction&) const {
    const HalfwayLobe& lobe = sums_.functions.as<HalfwayArray>()->lobe;
    return {{.about = Lobe::About::halfway, .width = lobe.along}};
}

}  // namespace hshfit::gpu::inline forms
