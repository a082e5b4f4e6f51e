#include "sweep_options.h"

#include <hshfit/bases/catalog.h>
#include <hshfit/coefficients/outgoing.h>
#include <hshfit/representation/forms/form.h>

#include <jobs/common/option_words.h>

namespace hshfit::jobs {
namespace {

using options::at;

std::vector<Word> constraintWords() {
    return {{"none"}, {"non-negative"}, {"energy-preserving"}, {"both"}};
}

constexpr OptionRow sweepRows[] = {
    OptionRow{"forms", at<&SweepOptions::forms>, "Of outgoing, basis, halfway (default: all)"}
        .takes({formWords, Syntax::list}),
    OptionRow{"bases", at<&SweepOptions::bases>,
              "all, or names from hshfit list bases (default: three)"}
        .takes({basisLists, Syntax::list}),
    OptionRow{"orders", at<&SweepOptions::orders>, "Orders (default: 3,5,7,10)"}
        .within(bounds::tradeOrders)
        .takes({.syntax = Syntax::list}),
    OptionRow{"ranks", at<&SweepOptions::ranks>, "Ranks of factors, 0 for none (default: 0,2,4)"}
        .within(bounds::tradeRanks)
        .takes({.syntax = Syntax::list}),
    OptionRow{"precisions", at<&SweepOptions::precisions>,
              "Of float64, float32, half, unorm16, unorm8 (default: all but float64)"}
        .takes({precisionWords, Syntax::list}),
    OptionRow{"keep", at<&SweepOptions::keep>,
              "Numbers of each array to keep, 0 for all (default: 0)"}
        .takes({.syntax = Syntax::list}),
    OptionRow{"windows", at<&SweepOptions::windows>,
              "Of none, hann, lanczos, bending (default: none)"}
        .takes({windowWords, Syntax::list}),
    OptionRow{"constraints", at<&SweepOptions::constraints>,
              "Of none, non-negative, energy-preserving, both (default: none)"}
        .takes({constraintWords, Syntax::list}),
    OptionRow{"outgoing", at<&SweepOptions::outgoing>,
              "WxH, N or THETA,PHI; give it once for each (default: 8, 16, 32; 8x8, 16x16 if "
              "anisotropic)"}
        .takes({.syntax = Syntax::outgoing}),
    OptionRow{"halfway", at<&SweepOptions::halfway>,
              "Orders H,D,A of --form halfway; give it once for each (default: four)"},
    OptionRow{"split", at<&SweepOptions::splits>,
              "none, diffuse or a BRDF to take out; give it once for each (default: none)"}
        .takes({splitWords, Syntax::brdf, Files::read, ""})
        .inPython("splits"),
    OptionRow{"cosine", at<&SweepOptions::cosine>, "Project f cos(theta_i) instead of f"},
};

/// Replaces default values with those that are given, if there are any.
template <class Value, class Parse>
void choose(const std::vector<std::string>& names, std::vector<Value>& into, Parse parse) {
    if (names.empty()) return;
    into.clear();
    for (const std::string& name : names) into.push_back(parse(name));
}

std::vector<std::string> basisNames(const std::vector<std::string>& asked) {
    std::vector<std::string> names;
    for (const std::string& text : asked)
        for (const bases::Entry* entry : bases::select(text)) names.emplace_back(entry->name);
    return names;
}

}  // namespace

OptionRows<SweepOptions> sweepOptions() {
    return {sweepRows};
}

tradeoff::Sweep SweepOptions::sweep() const {
    tradeoff::Sweep made;
    choose(forms, made.kinds, parseKind);
    if (!bases.empty()) made.bases = basisNames(bases);
    if (!orders.empty()) made.orders = orders;
    choose(outgoing, made.outgoing,
           [](const std::string& text) { return OutgoingSet::parse(text).spec(); });
    choose(halfway, made.halfway, parseHalfway);
    if (!ranks.empty()) made.ranks = ranks;
    choose(precisions, made.precisions, parsePrecision);
    if (!keep.empty()) made.keep = keep;
    choose(splits, made.splits,
           [](const std::string& text) { return text == "none" ? std::string() : text; });
    choose(windows, made.windows, parseWindow);
    choose(constraints, made.constraints, tradeoff::parseConstraint);
    made.quantity = cosine ? Quantity::brdfCosine : Quantity::brdf;
    return made;
}

}  // namespace hshfit::jobs
