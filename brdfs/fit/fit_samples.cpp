#include <brdfs/fit/fit_samples.h>

#include <brdfs/fit/sample_source.h>
#include <brdfs/measured/own_samples.h>
#include <hshfit/accuracy/metrics.h>
#include <hshfit/brdf/channel_view.h>
#include <hshfit/each_in_parallel.h>
#include <hshfit/error.h>
#include <hshfit/quadrature/quadrature.h>
#include <hshfit/quadrature/ring_points.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <random>
#include <span>

namespace hshfit::brdfs {
namespace {

/// Takes samples one by one and counts those left out.
class Gatherer {
public:
    Gatherer(const Brdf& data, const SampleOptions& options)
        : options_(options), channelCount_(data.channels().count()) {
        samples_.channels = data.channels();
        samples_.isotropic = data.laws().isotropic;
        lowest_ = options.grazingCut < 90 ? std::cos(radians(options.grazingCut)) : 0;
        for (auto* view = dynamic_cast<const ChannelView*>(&data); view;
             view = dynamic_cast<const ChannelView*>(&view->seen()))
            views_.insert(views_.begin(), view);
    }

    /// The BRDF that has the samples.
    const Brdf& source(const Brdf& data) const {
        return views_.empty() ? data : views_.front()->seen();
    }

    void belowHorizon() { ++samples_.masked.belowHorizon; }
    void invalid() { ++samples_.masked.invalid; }

    /// `values`: one per channel of the source; `place`: of a measured sample in it.
    void add(const DirectionPair& pair, std::span<const double> values, double weight,
             std::optional<std::size_t> place = {}) {
        const double* f = converted(values);
        Masked& masked = samples_.masked;
        const double lower = std::min(pair.wi.z, pair.wo.z);
        if (!(lower > 0)) {
            ++masked.belowHorizon;
        } else if (!std::all_of(f, f + channelCount_, [](double v) { return std::isfinite(v); })) {
            ++masked.notFinite;
        } else if (lower < lowest_) {
            ++masked.grazing;
        } else {
            samples_.wiX.push_back(pair.wi.x);
            samples_.wiY.push_back(pair.wi.y);
            samples_.wiZ.push_back(pair.wi.z);
            samples_.wo.push_back(pair.wo);
            samples_.weights.push_back(weight);
            if (place) places_.push_back(*place);
            interleaved_.insert(interleaved_.end(), f, f + channelCount_);
        }
    }

    void reserve(std::size_t count) {
        for (auto* list : {&samples_.wiX, &samples_.wiY, &samples_.wiZ, &samples_.weights})
            list->reserve(count);
        samples_.wo.reserve(count);
        interleaved_.reserve(count * channelCount_);
    }

    FitSamples finish(const Brdf& data, bool solidAngles) {
        const std::size_t count = samples_.size();
        const Masked& m = samples_.masked;
        if (count == 0)
            throw NumericError(fmt::format(
                "{}: no sample is left to fit: {} below the horizon, {} invalid or not covered, "
                "{} not finite, {} beyond the grazing cut",
                data.name(), m.belowHorizon, m.invalid, m.notFinite, m.grazing));
        samples_.values.resize(interleaved_.size());
        for (std::size_t c = 0; c < channelCount_; ++c)
            for (std::size_t k = 0; k < count; ++k)
                samples_.values[c * count + k] = interleaved_[k * channelCount_ + c];
        interleaved_ = {};
        samples_.solidAngles = options_.weights == SampleWeights::solidAngle ||
                               (options_.weights == SampleWeights::automatic && solidAngles);
        if (!samples_.solidAngles) std::ranges::fill(samples_.weights, 1.0);
        const double sum = std::accumulate(samples_.weights.begin(), samples_.weights.end(), 0.0);
        for (double& weight : samples_.weights) weight *= static_cast<double>(count) / sum;
        return std::move(samples_);
    }

    /// The place in the source of each measured sample that was taken.
    const std::vector<std::size_t>& places() const { return places_; }
    bool hasViews() const { return !views_.empty(); }

private:
    /// Values of the source as the views show them.
    const double* converted(std::span<const double> values) {
        if (views_.empty()) return values.data();
        now_.assign(values.begin(), values.end());
        for (const ChannelView* view : views_) {
            next_.resize(view->channels().count());
            view->convert(now_, next_);
            std::swap(now_, next_);
        }
        return now_.data();
    }

    std::vector<const ChannelView*> views_;  ///< from the source outwards
    std::vector<double> now_, next_;
    std::vector<std::size_t> places_;
    SampleOptions options_;
    std::size_t channelCount_;
    double lowest_;
    FitSamples samples_;
    std::vector<double> interleaved_;
};

/// Hands cells of a table on to a Gatherer.
class CellsOf : public CellReceiver {
public:
    explicit CellsOf(Gatherer& gatherer) : gatherer_(gatherer) {}
    void reserve(std::size_t cells) override { gatherer_.reserve(cells); }
    void belowHorizon() override { gatherer_.belowHorizon(); }
    void invalid() override { gatherer_.invalid(); }
    void add(const DirectionPair& pair, std::span<const double> f, double measure) override {
        gatherer_.add(pair, f, measure);
    }

private:
    Gatherer& gatherer_;
};

void gatherPairs(const Samples& samples, Gatherer& gatherer) {
    const std::size_t channels = samples.channels.count();
    for (std::size_t k = 0; k < samples.size(); ++k)
        gatherer.add({samples.wi[k], samples.wo[k]},
                     {samples.values.data() + k * channels, channels}, 1, k);
}

/// f at the nodes of wi for one outgoing direction.
struct NodesOfOne {
    std::vector<Direction> wi;
    std::vector<double> weights;
    std::vector<double> values;  ///< [node * channels + channel]
    std::vector<unsigned char> covered;
};

NodesOfOne nodesOfOne(const Brdf& data, const Direction& wo, double solidAngle, int level,
                      bool everywhere) {
    NodesOfOne nodes;
    const std::size_t channels = data.channels().count();
    const HemisphereGrid grid = gridFor(data.lobes(wo), wo, {.level = level, .squeezed = true});
    RingPoints points(grid);
    std::vector<double> f;
    while (points.next()) {
        const std::size_t count = points.count(), first = nodes.covered.size();
        f.resize(channels * count);
        data.eval(wo, points.directions(), f.data());
        nodes.covered.resize(first + count, 1);
        if (!everywhere) data.coverage(wo, points.directions(), nodes.covered.data() + first);
        for (std::size_t j = 0; j < count; ++j) {
            nodes.wi.push_back(points.direction(j));
            nodes.weights.push_back(solidAngle * points.weight(j));
            for (std::size_t c = 0; c < channels; ++c) nodes.values.push_back(f[c * count + j]);
        }
    }
    return nodes;
}

/// At the nodes at which BRDFs are compared. `everywhere`: also where f rests on no sample.
void gatherNodes(const Brdf& data, bool everywhere, Gatherer& gatherer) {
    // Anisotropic data have 16 times as many outgoing directions.
    const int level = data.laws().isotropic ? 0 : -1;
    const OutgoingSet outgoing = comparedOutgoing(data.laws().isotropic);
    const std::size_t channels = data.channels().count();
    std::vector<NodesOfOne> all(outgoing.size());
    eachInParallel(outgoing.size(), [&](std::size_t k) {
        if (outgoing.solidAngles[k] > 0)
            all[k] = nodesOfOne(data, outgoing.directions[k], outgoing.solidAngles[k], level,
                                everywhere);
    });
    for (std::size_t k = 0; k < all.size(); ++k) {
        NodesOfOne& own = all[k];
        for (std::size_t j = 0; j < own.wi.size(); ++j) {
            if (!own.covered[j])
                gatherer.invalid();
            else
                gatherer.add({own.wi[j], outgoing.directions[k]},
                             {own.values.data() + j * channels, channels}, own.weights[j]);
        }
        own = {};
    }
}

}  // namespace

SampleWeights findSampleWeights(std::string_view name) {
    if (name == "auto") return SampleWeights::automatic;
    if (name == "equal") return SampleWeights::equal;
    if (name == "solid-angle") return SampleWeights::solidAngle;
    throw UsageError(fmt::format("unknown weights '{}'; known: auto, equal, solid-angle", name));
}

SamplePlaces findSamplePlaces(std::string_view name) {
    if (name == "auto") return SamplePlaces::automatic;
    if (name == "cells") return SamplePlaces::cells;
    if (name == "nodes") return SamplePlaces::nodes;
    throw UsageError(fmt::format("unknown places '{}'; known: auto, cells, nodes", name));
}

std::string_view nameOf(SampleOrigin origin) {
    constexpr std::string_view names[] = {"cells", "measured", "nodes", "pixels"};
    return names[static_cast<std::size_t>(origin)];
}

FitSamples FitSamples::subset(const std::vector<std::size_t>& indices) const {
    FitSamples result;
    result.channels = channels;
    result.isotropic = isotropic;
    result.solidAngles = solidAngles;
    result.origin = origin;
    result.masked = masked;
    result.correlation = correlation;
    result.sums = sums;
    double sum = 0;
    for (const std::size_t k : indices) {
        if (sums) result.sumRows.push_back(sumRows[k]);
        result.wiX.push_back(wiX[k]);
        result.wiY.push_back(wiY[k]);
        result.wiZ.push_back(wiZ[k]);
        result.wo.push_back(wo[k]);
        result.weights.push_back(weights[k]);
        sum += weights[k];
    }
    for (std::size_t c = 0; c < channels.count(); ++c)
        for (const std::size_t k : indices) {
            result.values.push_back(value(c, k));
            if (!sigmas.empty()) result.sigmas.push_back(sigmas[c * size() + k]);
            if (!rows.empty()) result.rows.push_back(rows[c * size() + k]);
        }
    if (!scans.empty()) {
        // Numbers again from 0 on, because others count scans by their largest number.
        std::map<std::size_t, std::size_t> numbers;
        if (!scanPlaces.empty())
            for (const std::size_t k : indices) result.scanPlaces.push_back(scanPlaces[k]);
        for (const std::size_t k : indices)
            result.scans.push_back(numbers.try_emplace(scans[k], numbers.size()).first->second);
    }
    const double count = static_cast<double>(indices.size());
    if (sum > 0)
        for (double& weight : result.weights) weight *= count / sum;
    return result;
}

FitSamples FitSamples::drawn(std::size_t count, std::uint64_t seed) const {
    if (count >= size()) return *this;
    std::mt19937_64 random(seed);
    std::vector<std::size_t> indices;
    for (std::size_t k = 0; k < count; ++k) {
        const std::size_t first = k * size() / count, next = (k + 1) * size() / count;
        indices.push_back(first + random() % (next - first));
    }
    return subset(indices);
}

FitSamples FitSamples::channel(std::size_t c) const {
    FitSamples result = *this;
    result.channels = Channels::grey();
    const auto own = [&]<class Value>(const std::vector<Value>& all) {
        if (all.empty()) return all;
        const auto first = all.begin() + static_cast<std::ptrdiff_t>(c * size());
        return std::vector<Value>(first, first + static_cast<std::ptrdiff_t>(size()));
    };
    result.values = own(values);
    result.sigmas = own(sigmas);
    result.rows = own(rows);
    if (fewer) result.fewer = std::make_shared<const FitSamples>(fewer->channel(c));
    return result;
}

FitSamples unmeasuredSamples(std::span<const DirectionPair> pairs, const Channels& channels,
                             bool isotropic) {
    FitSamples samples;
    samples.channels = channels;
    samples.isotropic = isotropic;
    for (const DirectionPair& pair : pairs) {
        samples.wiX.push_back(pair.wi.x);
        samples.wiY.push_back(pair.wi.y);
        samples.wiZ.push_back(pair.wi.z);
        samples.wo.push_back(pair.wo);
    }
    samples.values.assign(pairs.size() * channels.count(), 0);
    samples.weights.assign(pairs.size(), 1);
    return samples;
}

bool areMeasured(const Brdf& data) {
    const Brdf* source = &data;
    while (const auto* view = dynamic_cast<const ChannelView*>(source)) source = &view->seen();
    return dynamic_cast<const HasMeasuredPairs*>(source) != nullptr;
}

FitSamples gatherSamples(const Brdf& data, const SampleOptions& options) {
    Gatherer gatherer(data, options);
    const Brdf& source = gatherer.source(data);
    SampleOrigin origin = SampleOrigin::nodes;
    const bool nodes = options.places == SamplePlaces::nodes;
    const auto* cells = dynamic_cast<const HasCells*>(&source);
    const auto* pairs = nodes ? nullptr : dynamic_cast<const HasMeasuredPairs*>(&source);
    if (options.places == SamplePlaces::cells && !cells)
        throw UsageError(
            fmt::format("{}: is no table with cells in half and difference angles", data.name()));
    if (pairs) {
        gatherPairs(pairs->samples(), gatherer);
        origin = SampleOrigin::measured;
    } else if (cells && !nodes &&
               (cells->cellsAreDefault() || options.places == SamplePlaces::cells)) {
        CellsOf receiver(gatherer);
        cells->giveCells(receiver);
        origin = SampleOrigin::cells;
    } else {
        gatherNodes(source, cells && cells->holdsBeyondCoverage(), gatherer);
    }
    FitSamples samples = gatherer.finish(data, origin != SampleOrigin::measured);
    samples.origin = origin;
    const SampleSource from{.samples = pairs ? &pairs->samples() : nullptr,
                            .places = gatherer.places(),
                            .converted = gatherer.hasViews(),
                            .name = data.name()};
    numberRows(from, samples);
    stateScans(options.scans, options.sigma, from, samples);
    std::vector<std::size_t> counts(samples.scans.size());
    for (const std::size_t scan : samples.scans) samples.scanPlaces.push_back(counts[scan]++);
    stateSigmas(options.sigma, from, samples);
    if (options.most == 0 || options.most >= samples.size()) return samples;
    FitSamples drawn = samples.drawn(options.most, options.seed);
    drawn.masked.notDrawn = samples.size() - drawn.size();
    return drawn;
}

}  // namespace hshfit::brdfs
