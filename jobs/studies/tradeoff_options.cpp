#include "choose.h"
#include "choose_renderers.h"
#include "stress.h"
#include "tradeoff.h"

#include <jobs/common/option_words.h>
#include <jobs/common/shared_options.h>
#include <jobs/exports/projection_cache.h>

namespace hshfit::jobs {
namespace {

using options::at;

std::vector<Word> rendererWords() {
    return wordsOf(renderers());
}

std::vector<Word> kindWords() {
    return wordsOf(candidateKinds());
}

constexpr OptionRow tradeoffRows[] = {
    OptionRow{"metric", at<&TradeoffOptions::measurement, &tradeoff::TradeoffOptions::metric>,
              "What the fronts weigh: hshfit list metrics, or picture (FLIP)"}
        .takes({.words = metricWords}),
    OptionRow{"max-bytes", at<&TradeoffOptions::maxBytes>, "Leave out forms that take more"}.within(
        Bounds<double>{1, 1e15}),
    OptionRow{"max-ns", at<&TradeoffOptions::maxNanoseconds>,
              "Leave out of the front over time what takes longer for a pair; with --by-time"}
        .within(Bounds<double>{1e-3, 1e12}),
    OptionRow{"timing", at<&TradeoffOptions::measurement, &tradeoff::TradeoffOptions::timing>,
              "Measure times; without, the rest has the same bits always"}
        .orWithout("Measure no times"),
    OptionRow{"gpu", at<&TradeoffOptions::gpu>,
              "Time the shaders of the fronts' forms on a Vulkan device"},
    OptionRow{"device", at<&TradeoffOptions::device>,
              "any (a GPU if there is one), gpu, software, or a part of its name; with --gpu"},
    costsRow(at<&TradeoffOptions::measurement, &tradeoff::TradeoffOptions::costs>),
    formulasRow(at<&TradeoffOptions::formulas>),
    OptionRow{"by-time", at<&TradeoffOptions::measurement, &tradeoff::TradeoffOptions::byTime>,
              "Print the front over time instead of that over bytes"},
    OptionRow{"pair-count", at<&TradeoffOptions::pairCount>,
              "Pairs of directions on which errors are measured, about"}
        .within(bounds::pairCount),
    OptionRow{"pairs", at<&TradeoffOptions::pairs>,
              "CSV of the pairs to measure on instead: columns wi_x … wo_z, and weight"}
        .takes({.files = Files::read, .dash = ""}),
    OptionRow{"write-pairs", at<&TradeoffOptions::writePairs>,
              "CSV to write: the pairs, their weights and the values of SPEC"}
        .takes({.files = Files::written, .dash = ".csv"}),
    OptionRow{"seconds", at<&TradeoffOptions::seconds>,
              "End the measurements after that time with the forms so far; a quarter of it is for "
              "times of evaluation, without --no-timing"}
        .within(bounds::seconds),
    cacheRow(at<&TradeoffOptions::measurement, &tradeoff::TradeoffOptions::folder,
                &tradeoff::ProjectionFolder::path>),
    OptionRow{"wavelets", at<&TradeoffOptions::measurement, &tradeoff::TradeoffOptions::wavelets>,
              "Measure the best terms of SOHO wavelets too, for comparison"},
    rgbRow(at<&TradeoffOptions::rgb>),
    toleranceRow(at<&TradeoffOptions::measurement, &tradeoff::TradeoffOptions::projection,
                    &ProjectionOptions::tolerance>),
    evaluationsRow(at<&TradeoffOptions::maxEvaluations>),
};

constexpr OptionRow chooseRows[] = {
    OptionRow{"for", at<&ChooseOptions::renderer>,
              "The renderer, format or shading language that takes the material"}
        .takes({.words = rendererWords})
        .inPython("renderer"),
    OptionRow{"kinds", at<&ChooseOptions::kinds>,
              "Kinds of candidates to try: of model, lobes, gltf, openpbr, halfway, coefficients, "
              "bsdf (default: all)"}
        .takes({kindWords, Syntax::list}),
    OptionRow{"bytes", at<&ChooseOptions::bytes>, "Recommend nothing that takes more"}.within(
        Bounds<double>{1, 1e15}),
    OptionRow{"cost", at<&ChooseOptions::cost>,
              "Recommend nothing whose shader takes more cycles of an AMD GPU for 64 threads, as "
              "Mesa's compiler states them without a card; a renderer's own shaders keep to it"}
        .within(Bounds<double>{1, 1e9}),
    OptionRow{"error", at<&ChooseOptions::error>,
              "Mean FLIP of a faithful material at most (default: 0.1); if it is stated, nothing "
              "else is recommended"}
        .within(Bounds<double>{0, 1}),
    OptionRow{"seconds", at<&ChooseOptions::seconds>,
              "Seconds of the processor for all candidates: one that would exceed them is left "
              "out, with that reason"}
        .within(bounds::seconds),
    cacheRow(at<&ChooseOptions::folder, &tradeoff::ProjectionFolder::path>),
};

constexpr OptionRow stressRows[] = {
    OptionRow{"bases", at<&StressOptions::bases>, "all, or names from hshfit list bases"}.takes(
        {basisLists, Syntax::list}),
    OptionRow{"max-order", at<&StressOptions::maxOrder>, "Bands to look at"}.within(
        Bounds<int>{2, 1000}),
    OptionRow{"trials", at<&StressOptions::trials>,
              "Random projections over the catalog whose stated errors are tried (default: 2000, "
              "or none if lobes are given)"},
    OptionRow{"seed", at<&StressOptions::seed>, "Of the random projections"},
    toleranceRow(at<&StressOptions::tolerance>),
    OptionRow{"of", at<&StressOptions::of>,
              "Models and formats whose random projections are tried, each as it is among all "
              "(default: all)"}
        .takes({.syntax = Syntax::list}),
};

}  // namespace

OptionRows<TradeoffOptions> tradeoffOptions() {
    return {tradeoffRows};
}

OptionRows<ChooseOptions> chooseOptions() {
    return {chooseRows};
}

OptionRows<StressOptions> stressOptions() {
    return {stressRows};
}

}  // namespace hshfit::jobs
