#include "arrays.h"
#include "watched.h"

#include <hshfit/bases/catalog.h>
#include <hshfit/choice/choice_files.h>
#include <hshfit/coefficients/outgoing.h>
#include <hshfit/tradeoff/tradeoff_files.h>

#include <jobs/fits/gaussians.h>
#include <jobs/fits/ltc.h>
#include <jobs/studies/choose.h>
#include <jobs/studies/stress.h>
#include <jobs/studies/tradeoff.h>

#include <pybind11/stl.h>
#include <nlohmann/json.hpp>

#include <cstdint>
#include <optional>
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

py::object chosen(const std::string& spec, const py::object& folder, const std::string& renderer,
                  const py::object& kinds, const std::optional<std::size_t>& bytes,
                  const std::optional<double>& error, const py::object& progress) {
    if (bytes) requireWithin("bytes", static_cast<double>(*bytes), 1, 1e15);
    if (error) requireWithin("error", *error, 0, 1);
    jobs::ChooseOptions options{.renderer = renderer, .bytes = bytes, .error = error};
    if (!kinds.is_none())
        for (const py::handle kind : kinds) options.kinds.push_back(kind.cast<std::string>());
    const std::string output = folder.is_none() ? std::string() : pathOf(folder, "folder");
    std::string answer;
    watched(progress, {}, [&](const jobs::Listener& listener) {
        answer = choice::choiceJson(jobs::choose(spec, output, options, listener));
    });
    return fromJson(nlohmann::ordered_json::parse(answer));
}

py::object cosines(const std::string& model, const py::object& files, int size,
                   const std::string& parameter, const std::string& mapping,
                   const py::object& progress) {
    requireWithin("size", size, 2, 1024);
    const bool one = py::isinstance<py::str>(files) || py::hasattr(files, "__fspath__");
    std::vector<std::string> outputs;
    for (const py::handle file : one ? py::object(py::make_tuple(files)) : files)
        outputs.push_back(pathOf(py::reinterpret_borrow<py::object>(file), "files"));
    nlohmann::ordered_json answer;
    watched(progress, {}, [&](const jobs::Listener& listener) {
        answer = jobs::ltcJson(jobs::fitLtc(
            model, outputs,
            {.size = size, .parameter = parameter, .mapping = jobs::parseMapping(mapping)},
            listener));
    });
    return fromJson(answer);
}

py::object mixed(const std::string& spec, const py::object& file, int lobes,
                 const std::string& kind, const py::object& outgoing, const std::string& weight,
                 bool keepEnergy, const py::object& metrics, bool rgb, const py::object& progress) {
    requireWithin("lobes", lobes, 1, 16);
    jobs::GaussianOptions options{.rgb = rgb};
    options.fit.lobes = lobes;
    options.fit.keepEnergy = keepEnergy;
    if (!outgoing.is_none()) options.outgoing = outgoingText(outgoing);
    if (!metrics.is_none()) options.metrics = listText(metrics);
    jobs::parseGaussians(kind, weight, options.fit);
    const std::string output = pathOf(file, "file");
    nlohmann::ordered_json answer;
    watched(progress, {}, [&](const jobs::Listener& listener) {
        answer = jobs::gaussiansJson(jobs::fitGaussians(spec, output, options, listener), output,
                                     options.fit);
    });
    return fromJson(answer);
}

py::object stressed(const py::object& specs, const py::object& folder, const py::object& bases,
                    int maxOrder, const std::optional<std::size_t>& trials, std::uint64_t seed,
                    const py::object& of, const py::object& progress) {
    requireWithin("max_order", maxOrder, 2, 1000);
    jobs::StressOptions options{.maxOrder = maxOrder, .trials = trials, .seed = seed};
    if (!bases.is_none()) options.bases = listText(bases);
    for (const py::handle spec : specs) options.lobes.push_back(spec.cast<std::string>());
    for (const py::handle name : of) options.of.push_back(name.cast<std::string>());
    const std::string output = folder.is_none() ? std::string() : pathOf(folder, "folder");
    std::string answer;
    watched(progress, {}, [&](const jobs::Listener& listener) {
        answer = stability::stressJson(jobs::stress(output, options, listener));
    });
    return fromJson(nlohmann::ordered_json::parse(answer));
}

/// Studies that answer with the document of their command.
void bindAnswers(py::module_& module) {
    const py::none none;
    module.def("choose", chosen, py::arg("spec"), py::arg("folder") = none, py::kw_only(),
               py::arg("renderer") = jobs::ChooseOptions{}.renderer, py::arg("kinds") = none,
               py::arg("bytes") = none, py::arg("error") = none, py::arg("progress") = none,
               R"(The smallest faithful material for a renderer, and what every candidate loses.

renderer  a row of `hshfit help choose --for`, such as "three", "gltf" or "any"; kinds limits the
          candidates; bytes and error (mean FLIP) are the most that is recommended
folder    takes a page with strips of spheres, choice.json and the files of what is taken

Returns the answer of the command; "recommended" is None where nothing is.)");
    const brdfs::LtcTableOptions table;
    module.def("ltc", cosines, py::arg("model"), py::arg("files"), py::kw_only(),
               py::arg("size") = table.size, py::arg("parameter") = table.parameter,
               py::arg("mapping") = "square", py::arg("progress") = none,
               R"(Linearly transformed cosines of a model over roughness and elevation.

files    .json, or NAME.exr or NAME.dds for NAME_1 and NAME_2; one or a sequence
mapping  the parameter's value for the roughness r of a column: "square" (r^2), "linear" (r) or
         "exponent" (2 / r^4 - 2)

Returns the answer of the command: errors of the lobes, mean and largest.)");
    const jobs::GaussianOptions mixture;
    module.def("gaussians", mixed, py::arg("spec"), py::arg("file"), py::kw_only(),
               py::arg("lobes") = mixture.fit.lobes, py::arg("kind") = "sg",
               py::arg("outgoing") = none, py::arg("weight") = "cosine",
               py::arg("keep_energy") = mixture.fit.keepEnergy, py::arg("metrics") = none,
               py::arg("rgb") = mixture.rgb, py::arg("progress") = none,
               R"(Spherical ("sg") or anisotropic ("asg") Gaussians over wi for every outgoing
direction of an isotropic BRDF, written to a .json that open() reads.

outgoing  elevations, or one direction; None: 16. weight: least squares of f cos(theta_i)
          ("cosine") or of f ("none"). keep_energy scales amplitudes so that albedos are kept

Returns the answer of the command.)");
    const jobs::StressOptions stress;
    module.def("stress", stressed, py::arg("specs") = py::tuple(), py::arg("folder") = none,
               py::kw_only(), py::arg("bases") = none, py::arg("max_order") = stress.maxOrder,
               py::arg("trials") = none, py::arg("seed") = stress.seed, py::arg("of") = py::tuple(),
               py::arg("progress") = none,
               R"(The accuracy of each computation by degree, order and width of the lobe.

specs   lobes to project; none: Lambert, and Phong, GGX and Ward from broad to a mirror
trials  random projections over the catalog whose stated errors are tried, with seed, of the models
        and formats `of`

Returns the answer of the command; folder takes stress.json, stress.md and stress.csv.)");
}

}  // namespace

void bindTrades(py::module_& module) {
    const jobs::TradeoffOptions options;
    const tradeoff::TradeoffOptions& measured = options.measurement;
    const py::none none;
    bindAnswers(module);
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
