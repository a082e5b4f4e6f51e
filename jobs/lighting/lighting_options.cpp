#include "lighting.h"
#include "lighting_trade.h"

#include <jobs/common/option_words.h>
#include <jobs/exports/export.h>

namespace hshfit::jobs {
namespace {

using options::at;

std::vector<Word> engineWords() {
    return wordsOf(lighting::prefilters());
}

constexpr OptionRow lightingRows[] = {
    OptionRow{
        "lighting", at<&LightingExportOptions::models>,
        "Tables, light and shaders for environments and area lights in place of textures: all, or "
        "of coefficients, split-sum, ltc and prefiltered those named; with --light the light that "
        "is written; shaders of materials that are not isotropic take a tangent"}
        .takes({lightingWords, Syntax::list})
        .onlyFor(exports::lighting),
    OptionRow{"engine",
              at<&LightingExportOptions::errors, &LightingErrorOptions::tables,
                 &LightingTableOptions::engine>,
              "Of --lighting prefiltered, the engine whose environment is looked up"}
        .takes({.words = engineWords})
        .onlyFor(exports::lighting),
    OptionRow{"lobes",
              at<&LightingExportOptions::errors, &LightingErrorOptions::tables,
                 &LightingTableOptions::lobes>,
              "Of --lighting prefiltered, lookups besides the diffuse one"}
        .within(Bounds<int>{1, lighting::PrefilteredTable::mostLobes})
        .onlyFor(exports::lighting),
    OptionRow{"seconds", at<&LightingExportOptions::errors, &LightingErrorOptions::seconds>,
              "Of --lighting, end the measuring of errors after that time, with the lights that "
              "were tried by then"}
        .within(bounds::seconds)
        .onlyFor(exports::lighting),
};

constexpr OptionRow tradeRows[] = {
    OptionRow{"lighting", at<&LightingTradeOptions::models>,
              "Measure, in place of forms, the models of lighting of hshfit export: all, or of "
              "coefficients, split-sum, ltc and prefiltered those named"}
        .takes({lightingWords, Syntax::list}),
    OptionRow{"light", at<&LightingTradeOptions::errors, &LightingErrorOptions::lights>,
              "A light; repeated (default: an example of every kind without a file)"}
        .takes({.syntax = Syntax::light, .files = Files::read, .dash = ""})
        .with("lighting"),
};

}  // namespace

OptionRows<LightingTradeOptions> lightingTradeOptions() {
    return {tradeRows};
}

std::vector<Word> lightingWords() {
    return withAll(summariesOf(lightingModels()));
}

OptionRows<LightingExportOptions> lightingExportOptions() {
    return {lightingRows};
}

}  // namespace hshfit::jobs
