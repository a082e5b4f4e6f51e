#include "tradeoff.h"

#include <jobs/common/pair_file.h>
#include <jobs/exports/formula_candidates.h>
#include <jobs/exports/projection_cache.h>
#include <jobs/source/source.h>

#include <hshfit/error.h>
#include <hshfit/files/file_set.h>
#include <hshfit/tradeoff/tradeoff_files.h>
#include <hshfit/wording.h>

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>

namespace hshfit::jobs {
namespace {

PairSample pairsFor(const TradeoffOptions& options) {
    if (!options.pairs.empty()) return readPairSample(options.pairs);
    SpreadOptions spread;
    spread.incoming = std::max(2, options.pairCount / (spread.replicates * spread.outgoing));
    return spreadPairs(spread);
}

/// The pairs, their weights and the values of one BRDF, for measurements of other models.
std::string pairsCsv(const PairSample& pairs, const Brdf& brdf) {
    const std::vector<double> values = evaluateOn(brdf, pairs);
    std::string csv = "wi_x,wi_y,wi_z,wo_x,wo_y,wo_z,weight";
    for (const std::string& name : brdf.channels().names()) csv += fmt::format(",{}", name);
    csv += "\n";
    for (std::size_t g = 0; g < pairs.wo.size(); ++g) {
        const Direction& wo = pairs.wo[g];
        for (std::size_t k = pairs.first[g]; k < pairs.first[g + 1]; ++k) {
            csv += fmt::format("{},{},{},{},{},{},{}", pairs.x[k], pairs.y[k], pairs.z[k], wo.x,
                               wo.y, wo.z, pairs.weights[k]);
            for (std::size_t at = k; at < values.size(); at += pairs.size()) {
                csv += fmt::format(",{}", values[at]);
            }
            csv += "\n";
        }
    }
    return csv;
}

gpu::DeviceChoice deviceFrom(const std::string& text) {
    using Device = gpu::DeviceChoice::Kind;
    if (text.empty() || text == "any") return {};
    if (text == "gpu") return {.kind = Device::gpu};
    if (text == "software") return {.kind = Device::software};
    return {.name = text};
}

tradeoff::TradeoffOptions measurementOf(const TradeoffOptions& options) {
    tradeoff::TradeoffOptions how = options.measurement;
    how.sweep = options.sweep.sweep();
    if (options.maxBytes) how.maxBytes = static_cast<std::size_t>(*options.maxBytes);
    if (options.maxNanoseconds) how.maxNanoseconds = *options.maxNanoseconds;
    how.projection.maxEvaluations = static_cast<std::size_t>(options.maxEvaluations);
    if (options.gpu) how.gpu = deviceFrom(options.device);
    if (!options.gpu && !options.device.empty())
        throw UsageError(fmt::format("{} names what {} runs on: add it",
                                     Setting{"TradeoffOptions::device"},
                                     Setting{"TradeoffOptions::gpu"}));
    return how;
}

void measureAll(MeasuredTradeoffs& result, const TradeoffOptions& options, FileSet* files,
                const Listener& listener) {
    const PairSample pairs = pairsFor(options);
    const auto open = [](const std::string& spec) { return openBrdf(spec); };
    const TimeLimit limit(options.seconds);
    tradeoff::ProjectionFolder folder = options.measurement.folder;
    useCache(folder, listener);
    for (const std::string& spec : result.specs) {
        try {
            const auto brdf = openBrdf(spec, options.rgb);
            if (!options.writePairs.empty()) {
                files->write(std::filesystem::absolute(options.writePairs).string(),
                             pairsCsv(pairs, *brdf));
            }
            tradeoff::TradeoffOptions how = measurementOf(options);
            how.folder = folder;
            const std::string named = options.rgb ? "rgb:" + spec : spec;
            how.formulas = formulaCandidates({*brdf, named, nameOf(spec)}, options.formulas);
            how.progress = listener.part(spec);
            how.limit = limit.share(static_cast<double>(&result.specs.back() - &spec + 1));
            result.trades.push_back(measure(*brdf, pairs, how, open));
        } catch (const OutputError&) {
            throw;
        } catch (const Error& error) {
            if (result.specs.size() == 1) throw;
            result.failures.push_back({spec, error.what(), error.code()});
        }
    }
}

}  // namespace

MeasuredTradeoffs measureTradeoffs(const std::vector<std::string>& specs, const std::string& output,
                                   const TradeoffOptions& options, const Listener& listener) {
    // Words that are none fail before any file is opened.
    measurementOf(options);
    requireFormulaKinds(options.formulas);
    MeasuredTradeoffs result{.specs = expandInputs(specs)};
    if (!options.writePairs.empty() && result.specs.size() > 1) {
        throw UsageError(fmt::format("{} holds the values of one BRDF: give one SPEC",
                                     Setting{"TradeoffOptions::writePairs"}));
    }
    std::optional<FileSet> files;
    if (!output.empty() || !options.writePairs.empty())
        files.emplace(output.empty() ? "." : output, true, FileSet::Above::require);
    measureAll(result, options, files ? &*files : nullptr, listener);
    if (!result.trades.empty() && !output.empty())
        tradeoff::writeTradeoffs(result.trades, *files);
    else if (!result.trades.empty() && files)
        files->commit();
    return result;
}

}  // namespace hshfit::jobs
