#include "plan.h"
#include "plan_lighting.h"

#include <jobs/common/option_words.h>
#include <jobs/exports/formula_candidates.h>
#include <jobs/exports/projection_cache.h>
#include <jobs/lighting/lighting_models.h>

namespace hshfit::jobs {
namespace {

using options::at;
using plan::PlanOptions;

constexpr OptionRow planRows[] = {
    OptionRow{"bases", at<&PlanOptions::bases>, "Bases to try, orthonormal ones"}.takes(
        {basisLists, Syntax::list}),
    OptionRow{"max-order", at<&PlanOptions::maxOrder>, "Bands to try"}.within(bounds::planOrder),
    costsRow(at<&PlanOptions::costs>),
    formulasRow(at<&PlanOptions::formulas>),
    OptionRow{"by-time", at<&PlanOptions::byTime>,
              "Of the forms within the budget, the fastest instead of the smallest; what is "
              "measured may differ between runs"},
    OptionRow{
        "seconds", at<&PlanOptions::seconds>,
        "End the searches after that time; a material whose search has not ended takes a large "
        "halfway form; that form, the checks of all and --lighting come on top"}
        .within(bounds::seconds),
    cacheRow(at<&PlanOptions::folder, &tradeoff::ProjectionFolder::path>),
};

constexpr OptionRow planLightingRows[] = {
    OptionRow{"lighting", at<&PlanLightingOptions::models>,
              "Choose a model of lighting for each material too (hshfit tradeoff --lighting), "
              "within the number of its budget: all, or of coefficients, split-sum, ltc and "
              "prefiltered those named"}
        .takes({lightingWords, Syntax::list}),
};

}  // namespace

OptionRows<plan::PlanOptions> planOptions() {
    return {planRows};
}

OptionRows<PlanLightingOptions> planLightingOptions() {
    return {planLightingRows};
}

}  // namespace hshfit::jobs
