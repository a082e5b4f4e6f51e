#include <brdfs/analytic/eon.h>

#include <brdfs/analytic/eon_shape.h>
#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/term_brdf.h>
#include <hshfit/brdf/kink_curve.h>

#include <algorithm>
#include <cmath>

#define HWY_TARGET_INCLUDE "brdfs/analytic/eon_terms.h"
#include <brdfs/lanes/each_target.h>

namespace hshfit::brdfs {
namespace {

using namespace HWY_NAMESPACE;

HWY_EXPORT(evalEon);
HWY_EXPORT(eonColumns);
HWY_EXPORT(openpbrDiffuseColumns);

constexpr Laws claims{
    .nonNegative = true, .reciprocal = true, .isotropic = true, .mirrorSymmetric = true};

/// The polynomial's albedo exceeds kd by up to 1.5e-4 of kd.
Laws lawsOf(const Colour& kd, const EonSettings<double>& settings) {
    Laws laws = claims;
    laws.energyConserving = settings.exact || largest(kd) <= 0.9998 || settings.roughness == 0;
    return laws;
}

void evalByVectors(const EonShape<double>& shape, const TermBatch& batch) {
    HWY_DYNAMIC_DISPATCH(evalEon)(shape, batch);
}

class Eon final : public ShapedBrdf<EonShape<double>, evalByVectors,
                                    evalAll<double, EonTerms, EonShape<double>>>,
                  public HasKinkCurves {
public:
    Eon(const Model& model, const Parameters& p, const Colour& kd,
        const EonSettings<double>& settings, const TermWeights& weights)
        : ShapedBrdf(model, p, lawsOf(kd, settings), weights, settings.shape()) {}

    /// The kink at equal heights, where max(cos_i, cos_o) changes branches.
    std::vector<double> kinks(const Direction& wo) const override { return {wo.z}; }

    /// s changes its sign.
    std::vector<KinkCurve> kinkCurves(const Direction& wo) const override {
        if (shape_.roughness == 0) return {};
        return {circleAbout({wo.x, wo.y, 0}, 0)};
    }
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    return std::make_unique<Eon>(eonModel(), p, p.colour("kd"),
                                 EonFormula::settings(Values<double>(p, 0)),
                                 channelWeights<EonFormula>(p));
}

std::unique_ptr<Brdf> makeOpenpbr(const Parameters& p) {
    const double weight = p.number("base_weight");
    const Colour kd =
        mapped(p.colour("base_color"), [&](double colour) { return weight * colour; });
    return std::make_unique<Eon>(openpbrDiffuseModel(), p, kd,
                                 OpenpbrDiffuseFormula::settings(Values<double>(p, 0)),
                                 channelWeights<OpenpbrDiffuseFormula>(p));
}

std::unique_ptr<ModelColumns> eonColumnsOf(const ColumnRequest& request) {
    return HWY_DYNAMIC_DISPATCH(eonColumns)(request);
}

std::unique_ptr<ModelColumns> openpbrColumnsOf(const ColumnRequest& request) {
    return HWY_DYNAMIC_DISPATCH(openpbrDiffuseColumns)(request);
}

/// Light that is reflected several times is not linear in the albedo.
bool neverLinear(const Parameters&) {
    return false;
}

Parameter unitParameter(std::string_view name, std::string_view help, double fallback) {
    return {.name = name, .help = help, .fallback = fallback, .min = 0, .max = 1};
}

}  // namespace

const Model& eonModel() {
    static const Model model{
        .name = "eon",
        .help = "rough diffuse surface that loses no energy (energy-preserving Oren-Nayar)",
        .source = "Portsmouth, Kutz & Hill 2025, JCGT 14(1), arXiv 2410.18026",
        .parameters = {linearIf(fitted(kdParameter(1, 1), {{.low = 0.05, .high = 0.9}}),
                                neverLinear),
                       {.name = "roughness",
                        .help = "0 is Lambert",
                        .min = 0,
                        .max = 1,
                        .fit = {{.low = 0.1, .high = 0.9}}},
                       {.name = "albedo",
                        .help = "of one bounce: in closed form, or the paper's polynomial",
                        .kind = Parameter::Kind::choice,
                        .choices = {"exact", "approximate"}}},
        .laws = claims,
        .make = make,
        .columns = eonColumnsOf};
    return model;
}

const Model& openpbrDiffuseModel() {
    static const Model model{
        .name = "openpbr-diffuse",
        .help = "eon under OpenPBR Surface's names and defaults",
        .source = "OpenPBR Surface 1.1, Academy Software Foundation; Portsmouth, Kutz & Hill 2025",
        .parameters = {unitParameter("base_weight", "scale of base_color", 1),
                       {.name = "base_color",
                        .help = "albedo of the facets, linear",
                        .kind = Parameter::Kind::colour,
                        .fallback = 0.8,
                        .min = 0,
                        .max = 1,
                        .fit = {{.low = 0.05, .high = 0.9}},
                        .linear = neverLinear},
                       fitted(unitParameter("base_diffuse_roughness", "0 is Lambert", 0),
                              {{.low = 0.1, .high = 0.9}})},
        .laws = {.nonNegative = true,
                 .reciprocal = true,
                 .isotropic = true,
                 .mirrorSymmetric = true,
                 .energyConserving = true},
        .make = makeOpenpbr,
        .columns = openpbrColumnsOf};
    return model;
}

}  // namespace hshfit::brdfs
