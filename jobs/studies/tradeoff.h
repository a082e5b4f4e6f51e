#pragma once

#include <jobs/common/inputs.h>
#include <jobs/common/listener.h>
#include <jobs/studies/sweep_options.h>

#include <hshfit/tradeoff/tradeoff.h>

#include <optional>
#include <string>
#include <vector>

namespace hshfit::jobs {

struct TradeoffOptions {
    /// Without what the members below state; its `progress` is not called: the listener is.
    tradeoff::TradeoffOptions measurement = {};
    SweepOptions sweep = {};
    std::optional<double> maxBytes = {};        ///< of a form
    std::optional<double> maxNanoseconds = {};  ///< of a pair
    double maxEvaluations = static_cast<double>(ProjectionOptions{}.maxEvaluations);
    bool gpu = false;         ///< time the shaders of the fronts' forms
    std::string device = {};  ///< any, gpu, software, or a part of its name; takes `gpu`
    std::vector<std::string> formulas = choice::usualFormulas;  ///< formulaCandidates
    std::string pairs = {};  ///< CSV of pairs (readPairSample); empty: spread pairs
    int pairCount = 32768;   ///< of spread pairs, about
    /// CSV to write: the pairs, their weights and the values of the one BRDF; empty: none.
    std::string writePairs = {};
    bool rgb = false;  ///< wavelengths as linear Rec. 709
    /// For all BRDFs; forms that are not reached are left out. None: as long as it takes.
    std::optional<double> seconds = {};
};
/// Without the options of the sweep.
OptionRows<TradeoffOptions> tradeoffOptions();

struct MeasuredTradeoffs {
    std::vector<std::string> specs;               ///< with folders expanded
    std::vector<tradeoff::Tradeoff> trades = {};  ///< of those that did not fail, in their order
    std::vector<InputFailure> failures = {};
};

/// The trade of bytes, time and error of each BRDF, with its files in the folder `output`
/// (tradeoff::writeTradeoffs) unless that is empty. BRDFs are measured one at a time, so that
/// times compare. The error of a single one is thrown; errors of several are in `failures`. Throws
/// UsageError, InputError, NumericError and OutputError.
MeasuredTradeoffs measureTradeoffs(const std::vector<std::string>& specs, const std::string& output,
                                   const TradeoffOptions& options, const Listener& listener = {});

}  // namespace hshfit::jobs
