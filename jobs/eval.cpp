#include "eval.h"

#include "pair_file.h"
#include "source.h"

#include <hshfit/files/atomic_file.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

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

}  // namespace

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
