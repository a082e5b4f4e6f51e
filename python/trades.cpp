#include "arrays.h"
#include "watched.h"

#include <hshfit/bases/catalog.h>
#include <hshfit/coefficients/outgoing.h>
#include <hshfit/tradeoff/tradeoff_files.h>

#include <jobs/tradeoff.h>

#include <pybind11/stl.h>
#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace hshfit::python {
namespace {

using Names = std::optional<std::vector<std::string>>;

/// Replaces the sweep's default values with those given, if there are any.
template <class Value, class Parse>
void choose(const Names& names, std::vector<Value>& into, Parse parse) {
    if (!names) return;
    into.clear();
    for (const std::string& name : *names) into.push_back(parse(name));
}

struct SweepArguments {
    Names forms, bases, outgoing, halfway, precisions, splits, windows, constraints;
    std::optional<std::vector<int>> orders, ranks;
    std::optional<std::vector<std::size_t>> keep;
    bool cosine = false;
};

tradeoff::Sweep sweepOf(const SweepArguments& arguments) {
    tradeoff::Sweep sweep;
    choose(arguments.forms, sweep.kinds, parseKind);
    choose(arguments.outgoing, sweep.outgoing,
           [](const std::string& text) { return OutgoingSet::parse(text).spec(); });
    choose(arguments.halfway, sweep.halfway, parseHalfway);
    choose(arguments.precisions, sweep.precisions, parsePrecision);
    choose(arguments.splits, sweep.splits,
           [](const std::string& text) { return text == "none" ? std::string() : text; });
    choose(arguments.windows, sweep.windows, parseWindow);
    choose(arguments.constraints, sweep.constraints, tradeoff::parseConstraint);
    if (arguments.bases) {
        sweep.bases.clear();
        for (const std::string& name : *arguments.bases)
            for (const bases::Entry* entry : bases::select(name))
                sweep.bases.emplace_back(entry->name);
    }
    if (arguments.orders) sweep.orders = *arguments.orders;
    if (arguments.ranks) sweep.ranks = *arguments.ranks;
    if (arguments.keep) sweep.keep = *arguments.keep;
    for (const int order : sweep.orders) requireWithin("orders", order, jobs::bounds::tradeOrders);
    for (const int rank : sweep.ranks) requireWithin("ranks", rank, jobs::bounds::tradeRanks);
    sweep.quantity = arguments.cosine ? Quantity::brdfCosine : Quantity::brdf;
    return sweep;
}

py::object traded(const py::object& specs, const py::object& folder, const Names& forms,
                  const Names& bases, const std::optional<std::vector<int>>& orders,
                  const Names& outgoing, const Names& halfway,
                  const std::optional<std::vector<int>>& ranks, const Names& precisions,
                  const std::optional<std::vector<std::size_t>>& keep, const Names& splits,
                  const Names& windows, const Names& constraints, bool cosine,
                  const std::string& metric, const std::optional<std::size_t>& maxBytes,
                  const std::optional<double>& maxNanoseconds, bool timing, bool byTime,
                  int pairCount, const py::object& pairs, const py::object& writePairs,
                  bool wavelets, bool rgb, double tolerance, double maxEvaluations,
                  const py::object& progress) {
    requireQuadrature(tolerance, maxEvaluations);
    requireWithin("pair_count", pairCount, jobs::bounds::pairCount);
    jobs::TradeoffOptions options{.pairCount = pairCount, .rgb = rgb};
    options.measurement.sweep = sweepOf({forms, bases, outgoing, halfway, precisions, splits,
                                         windows, constraints, orders, ranks, keep, cosine});
    options.measurement.metric = metric;
    if (maxBytes) options.measurement.maxBytes = *maxBytes;
    if (maxNanoseconds) options.measurement.maxNanoseconds = *maxNanoseconds;
    options.measurement.timing = timing;
    options.measurement.byTime = byTime;
    options.measurement.wavelets = wavelets;
    options.measurement.projection.tolerance = tolerance;
    options.measurement.projection.maxEvaluations = static_cast<std::size_t>(maxEvaluations);
    if (!pairs.is_none()) options.pairs = pathOf(pairs, "pairs");
    if (!writePairs.is_none()) options.writePairs = pathOf(writePairs, "write_pairs");
    const bool one = py::isinstance<py::str>(specs) || py::hasattr(specs, "__fspath__");
    std::vector<std::string> sources;
    for (const py::handle spec : one ? py::object(py::make_tuple(specs)) : specs)
        sources.push_back(pathOf(py::reinterpret_borrow<py::object>(spec), "specs"));
    const std::string output = folder.is_none() ? std::string() : pathOf(folder, "folder");
    nlohmann::ordered_json answer;
    watched(progress, {}, [&](const jobs::Listener& listener) {
        const auto measured = jobs::measureTradeoffs(sources, output, options, listener);
        for (const jobs::InputFailure& failure : measured.failures)
            listener.say(failure.spec + ": " + failure.reason);
        answer = nlohmann::ordered_json::parse(tradeoff::tradeoffJson(measured.trades, true));
    });
    return fromJson(answer);
}

}  // namespace

void bindTrades(py::module_& module) {
    const jobs::TradeoffOptions options;
    const tradeoff::TradeoffOptions& measured = options.measurement;
    const py::none none;
    module.def("tradeoff", traded, py::arg("specs"), py::arg("folder") = none, py::kw_only(),
               py::arg("forms") = none, py::arg("bases") = none, py::arg("orders") = none,
               py::arg("outgoing") = none, py::arg("halfway") = none, py::arg("ranks") = none,
               py::arg("precisions") = none, py::arg("keep") = none, py::arg("splits") = none,
               py::arg("windows") = none, py::arg("constraints") = none, py::arg("cosine") = false,
               py::arg("metric") = measured.metric, py::arg("max_bytes") = none,
               py::arg("max_ns") = none, py::arg("timing") = measured.timing,
               py::arg("by_time") = measured.byTime, py::arg("pair_count") = options.pairCount,
               py::arg("pairs") = none, py::arg("write_pairs") = none,
               py::arg("wavelets") = measured.wavelets, py::arg("rgb") = options.rgb,
               py::arg("tolerance") = measured.projection.tolerance,
               py::arg("max_evaluations") = static_cast<double>(measured.projection.maxEvaluations),
               py::arg("progress") = none,
               R"(Bytes, time and error of every form of BRDFs: what accuracy costs.

specs   specifications or paths, one or a sequence; folder takes pages and tables
forms   of "outgoing", "basis", "halfway"; with bases, orders, outgoing sets ("16", "8x8"), halfway
        orders ("8,4,2"), ranks, precisions, numbers to keep, splits, windows and constraints:
        sequences of what is tried, None for the program's own
metric  of catalog("metrics"), what the fronts weigh; max_bytes and max_ns (nanoseconds a pair, with
        by_time) leave forms out. timing=False measures no times: the rest has the same bits always

Returns the answer of the command: of each BRDF its forms, fronts and the choice. A BRDF of several
that fails is left out, with a warning.)");
}

}  // namespace hshfit::python
