#include "eval.h"

#include <jobs/common/pair_file.h>
#include <jobs/common/shared_options.h>
#include <jobs/source/source.h>

#include <hshfit/brdf/transmission.h>
#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>
#include <hshfit/stop_request.h>
#include <hshfit/wording.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>

namespace hshfit::jobs {
namespace {

/// The outgoing direction that `eval` takes for this one: of a transmission, that below the
/// surface, mirrored. Throws InputError for one above.
Direction outgoingFor(bool through, const Direction& wo,
                      const std::function<std::string()>& where) {
    if (!through) return wo;
    if (wo.z > 0)
        throw InputError(
            fmt::format("{} is above the surface; a transmission leaves below it, expected theta_o "
                        "from 90 to 180 degrees (wo_z at most 0)",
                        where()));
    return throughSurface(wo);
}

Angles incomingIn(const std::string& text) {
    return anglesIn(text, "EvalOptions::wi", 90);
}
Angles outgoingIn(const std::string& text, double mostTheta) {
    return anglesIn(text, "EvalOptions::wo", mostTheta);
}
Angles anyOutgoingIn(const std::string& text) {
    return outgoingIn(text, 180);
}

constexpr OptionRow evalRows[] = {
    OptionRow{"wi", options::spelled<incomingIn, anglesText, &EvalOptions::wi>,
              "Incoming direction THETA,PHI, degrees"}
        .takes({.syntax = Syntax::numbers})
        .with("wo")
        .notWith("pairs"),
    OptionRow{"wo", options::spelled<anyOutgoingIn, anglesText, &EvalOptions::wo>,
              "Outgoing direction THETA,PHI, degrees; of a transmission, theta from 90 to 180"}
        .takes({.syntax = Syntax::numbers})
        .with("wi")
        .notWith("pairs"),
    OptionRow{
        "pairs", options::at<&EvalOptions::pairs>,
        "CSV of direction pairs: columns wi_x, wi_y, wi_z, wo_x, wo_y, wo_z, or theta_i, phi_i, "
        "theta_o, phi_o in degrees; others are ignored"}
        .takes({.files = Files::read, .dash = ""}),
    rgbRow(options::at<&EvalOptions::rgb>),
    OptionRow{"cosine", options::at<&EvalOptions::cosine>, "Print f cos(theta_i) instead of f"},
};

std::vector<double> valuesAt(const Brdf& brdf, const Direction& wi, const Direction& wo,
                             const EvalOptions& options) {
    std::vector<double> values = evaluate(brdf, wi, wo);
    for (double& value : values) value *= options.cosine ? wi.z : 1;
    return values;
}

void requireFinite(const std::vector<double>& values, const std::string& brdf, const Direction& wi,
                   const Direction& wo) {
    for (const double value : values) {
        if (std::isfinite(value)) continue;
        throw NumericError(
            fmt::format("{}: f is not finite at wi = {:.4g},{:.4g} and wo = {:.4g},{:.4g} degrees",
                        brdf, degrees(polarAngle(wi)), degrees(azimuth(wi)),
                        degrees(polarAngle(wo)), degrees(azimuth(wo))));
    }
}

bool isZero(const std::vector<double>& values) {
    return std::ranges::all_of(values, [](double value) { return value == 0; });
}

/// Pairs below the surface are more likely angles from the surface, or columns that are exchanged,
/// than meant.
void remarkBelow(std::size_t below, std::size_t pairs, bool through, const EvalOptions& options,
                 const Listener& listener) {
    if (below == 0) return;
    listener.say(
        fmt::format("{}: {} of {} pairs have {} below the surface, where f is 0; polar angles are "
                    "from the normal, 0 to 90 degrees",
                    options.pairs, below, pairs, through ? "wi" : "a direction"));
}

void remark(const Brdf& brdf, const Listener& listener) {
    if (const std::string why = whyZero(brdf); !why.empty()) listener.say(why);
}

std::vector<std::string> columnsOf(const Channels& channels) {
    const bool colours =
        channels.kind == Channels::Kind::grey || channels.kind == Channels::Kind::rgb;
    return colours ? std::vector<std::string>{"r", "g", "b"} : channels.names();
}

Evaluated factsOf(const Brdf& brdf) {
    const std::string name = brdf.name();
    return {.brdf = name,
            .side = std::string(transmissionSide(name)),
            .channels = brdf.channels().names()};
}

/// Unit vectors of some pairs, made 1 in length.
class UnitVectors {
public:
    static constexpr std::size_t most = 128;

    /// Takes the pairs first to first + count - 1. Throws InputError at the first that is none.
    void take(const VectorArray& vectors, const char* name, std::size_t first, std::size_t count) {
        count_ = count;
        for (std::size_t k = 0; k < count; ++k) {
            const Direction d = vectors.at(first + k);
            x[k] = d.x, y[k] = d.y, z[k] = d.z;
        }
        for (std::size_t k = 0; k < count; ++k) lengths[k] = lengthOf(x[k], y[k], z[k]);
        for (std::size_t k = 0; k < count; ++k) {
            const double scale = 1 / lengths[k];
            x[k] *= scale, y[k] *= scale, z[k] *= scale;
        }
        const bool all = std::all_of(lengths.begin(), lengths.begin() + count, isUnit);
        for (std::size_t k = 0; k < count && !all; ++k)
            unitDirection(vectors.at(first + k),
                          [&] { return fmt::format("{}[{}]", name, first + k); });
    }
    /// Mirrors the taken ones at the surface, as `outgoingFor` does; `first` is the first's number.
    void goThrough(std::size_t first) {
        for (std::size_t k = 0; k < count_; ++k)
            z[k] = outgoingFor(true, at(k), [&] { return fmt::format("wo[{}]", first + k); }).z;
    }
    Direction at(std::size_t k) const { return {x[k], y[k], z[k]}; }
    DirectionBatch from(std::size_t k, std::size_t count) const {
        return {x.data() + k, y.data() + k, z.data() + k, count};
    }

    std::array<double, most> x, y, z, lengths;

private:
    std::size_t count_ = 0;
};

/// [pair][channel] from [channel][pair].
void interleave(const double* values, std::size_t count, std::size_t channels, double* out) {
    for (std::size_t k = 0; k < count; ++k)
        for (std::size_t c = 0; c < channels; ++c) *out++ = values[c * count + k];
}

/// The values of some pairs, those with one wo in one call.
class PairBlock {
public:
    explicit PairBlock(const Brdf& brdf)
        : brdf_(brdf), channels_(brdf.channels().count()), values_(channels_ * UnitVectors::most) {}

    void evaluate(const UnitVectors& wi, const UnitVectors& wo, std::size_t count, double* out) {
        for (std::size_t k = 0; k < count;) {
            std::size_t end = k + 1;
            while (end < count && same(wo, k, end)) ++end;
            const std::size_t run = end - k;
            double* const values = run > 1 && channels_ > 1 ? values_.data() : out;
            brdf_.eval(wo.at(k), wi.from(k, run), values);
            if (values != out) interleave(values, run, channels_, out);
            out += run * channels_;
            k = end;
        }
    }

private:
    static bool same(const UnitVectors& v, std::size_t a, std::size_t b) {
        return v.x[a] == v.x[b] && v.y[a] == v.y[b] && v.z[a] == v.z[b];
    }

    const Brdf& brdf_;
    std::size_t channels_;
    std::vector<double> values_;
};

}  // namespace

OptionRows<EvalOptions> evalOptions() {
    return {evalRows};
}

void evaluateArrays(const Brdf& brdf, const VectorArray& wi, const VectorArray& wo,
                    std::size_t count, double* out, const EvalOptions& options) {
    const std::size_t channels = brdf.channels().count();
    const bool through = transmits(brdf);
    const auto work = [&](const tbb::blocked_range<std::size_t>& range) {
        PairBlock block(brdf);
        UnitVectors in, from;
        stopIfRequested();
        for (std::size_t k = range.begin(); k < range.end(); k += UnitVectors::most) {
            const std::size_t some = std::min(UnitVectors::most, range.end() - k);
            double* const values = out + k * channels;
            in.take(wi, "wi", k, some);
            from.take(wo, "wo", k, some);
            if (through) from.goThrough(k);
            block.evaluate(in, from, some, values);
            for (std::size_t j = 0; options.cosine && j < some * channels; ++j)
                values[j] *= in.z[j / channels];
        }
    };
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, pairsAtOnce), work,
                      tbb::simple_partitioner());
}

Evaluated evaluatePair(const std::string& source, const EvalOptions& options,
                       const Listener& listener) {
    if (!options.wi || !options.wo)
        throw UsageError(fmt::format("give {} and {}, or {}", Setting{"EvalOptions::wi"},
                                     Setting{"EvalOptions::wo"}, Setting{"EvalOptions::pairs"}));
    const auto brdf = openSource(source, options.rgb, Sides::eitherAndNamed);
    Evaluated result = factsOf(*brdf);
    if (result.side.empty()) outgoingIn(anglesText(*options.wo), 90);
    const Direction wi = options.wi->direction(), wo = options.wo->direction();
    const Direction leaving = outgoingFor(!result.side.empty(), wo, [&] {
        return fmt::format("{}: wo = {:.4g},{:.4g} degrees", source, degrees(polarAngle(wo)),
                           degrees(azimuth(wo)));
    });
    result.values = valuesAt(*brdf, wi, leaving, options);
    brdf->checkIntact();
    requireFinite(result.values, source, wi, wo);
    if (isZero(result.values)) remark(*brdf, listener);
    return result;
}

EvaluatedPairs evaluatePairs(const std::string& source, const std::string& output,
                             const EvalOptions& options, const Listener& listener) {
    const auto brdf = openSource(source, options.rgb, Sides::eitherAndNamed);
    const bool through = transmits(*brdf);
    EvaluatedPairs result{.facts = factsOf(*brdf), .csv = {}};
    const auto columns = columnsOf(brdf->channels());
    std::string& csv = result.csv;
    csv = fmt::format("wi_x,wi_y,wi_z,wo_x,wo_y,wo_z,{}\n", fmt::join(columns, ","));
    std::size_t below = 0;
    readPairs(options.pairs, [&](const PairRow& row) {
        ++result.count;
        if (row.wi.z < 0 || (!through && row.wo.z < 0)) ++below;
        const Direction wo = outgoingFor(through, row.wo, [&] {
            return fmt::format("{}: pair {}: wo_z = {}", options.pairs, result.count, row.cells[5]);
        });
        const auto values = valuesAt(*brdf, row.wi, wo, options);
        requireFinite(values, source, row.wi, row.wo);
        result.facts.values.insert(result.facts.values.end(), values.begin(), values.end());
        fmt::format_to(std::back_inserter(csv), "{}", fmt::join(row.cells, ","));
        for (std::size_t c = 0; c < columns.size(); ++c) {
            fmt::format_to(std::back_inserter(csv), ",{}", values[std::min(c, values.size() - 1)]);
        }
        csv += "\n";
    });
    brdf->checkIntact();
    remarkBelow(below, result.count, through, options, listener);
    if (isZero(result.facts.values)) remark(*brdf, listener);
    if (!output.empty()) writeFile(output, csv);
    return result;
}

}  // namespace hshfit::jobs
