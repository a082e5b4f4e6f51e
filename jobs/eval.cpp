#include "eval.h"

#include "pair_file.h"
#include "source.h"

#include <hshfit/files/atomic_file.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <iterator>

namespace hshfit::jobs {
namespace {

std::vector<double> valuesAt(const Brdf& brdf, const Direction& wi, const Direction& wo,
                             const EvalOptions& options) {
    std::vector<double> values = evaluate(brdf, wi, wo);
    for (double& value : values) value *= options.cosine ? wi.z : 1;
    return values;
}

std::vector<std::string> columnsOf(const Channels& channels) {
    if (channels.kind == Channels::Kind::spectral) return channels.names();
    return {"r", "g", "b"};
}

/// Pairs with one wo, evaluated in one call; buffers are kept between calls.
class PairBlock {
public:
    PairBlock(const Brdf& brdf, bool cosine)
        : brdf_(brdf), channels_(brdf.channels().count()), cosine_(cosine) {}

    void add(const Direction& wi) {
        x_.push_back(wi.x);
        y_.push_back(wi.y);
        z_.push_back(wi.z);
    }
    /// [pair][channel] to `out`; returns the place after them.
    double* flush(const Direction& wo, double* out) {
        const std::size_t count = x_.size();
        values_.resize(count * channels_);
        brdf_.eval(wo, {x_.data(), y_.data(), z_.data(), count}, values_.data());
        for (std::size_t k = 0; k < count; ++k)
            for (std::size_t c = 0; c < channels_; ++c)
                *out++ = values_[c * count + k] * (cosine_ ? z_[k] : 1);
        x_.clear(), y_.clear(), z_.clear();
        return out;
    }

private:
    const Brdf& brdf_;
    std::size_t channels_;
    bool cosine_;
    std::vector<double> x_, y_, z_, values_;
};

bool same(const Direction& a, const Direction& b) {
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

}  // namespace

void evaluateArrays(const Brdf& brdf, const VectorArray& wi, const VectorArray& wo,
                    std::size_t count, double* out, const EvalOptions& options) {
    const std::size_t channels = brdf.channels().count();
    const auto unit = [](const VectorArray& vectors, std::size_t k, const char* name) {
        return unitDirection(vectors.at(k), [&] { return fmt::format("{}[{}]", name, k); });
    };
    constexpr std::size_t grain = 4096;  // pairs, some 0.1 ms for the cheapest models
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, grain),
        [&](const tbb::blocked_range<std::size_t>& range) {
            PairBlock block(brdf, options.cosine);
            double* to = out + range.begin() * channels;
            for (std::size_t k = range.begin(); k < range.end();) {
                const Direction from = unit(wo, k, "wo");
                do {
                    block.add(unit(wi, k, "wi"));
                } while (++k < range.end() && same(from, unit(wo, k, "wo")));
                to = block.flush(from, to);
            }
        },
        tbb::simple_partitioner());
}

Evaluated evaluatePair(const std::string& source, const Direction& wi, const Direction& wo,
                       const EvalOptions& options) {
    const auto brdf = openSource(source, options.rgb);
    Evaluated result{brdf->name(), brdf->channels().names(), valuesAt(*brdf, wi, wo, options)};
    brdf->checkIntact();
    return result;
}

std::string evaluatePairs(const std::string& source, const std::string& pairs,
                          const std::string& output, const EvalOptions& options) {
    const auto brdf = openSource(source, options.rgb);
    const auto columns = columnsOf(brdf->channels());
    std::string csv = fmt::format("wi_x,wi_y,wi_z,wo_x,wo_y,wo_z,{}\n", fmt::join(columns, ","));
    readPairs(pairs, [&](const PairRow& row) {
        const auto values = valuesAt(*brdf, row.wi, row.wo, options);
        fmt::format_to(std::back_inserter(csv), "{}", fmt::join(row.cells, ","));
        for (std::size_t c = 0; c < columns.size(); ++c) {
            fmt::format_to(std::back_inserter(csv), ",{}", values[std::min(c, values.size() - 1)]);
        }
        csv += "\n";
    });
    brdf->checkIntact();
    if (!output.empty()) writeFile(output, csv);
    return csv;
}

}  // namespace hshfit::jobs
