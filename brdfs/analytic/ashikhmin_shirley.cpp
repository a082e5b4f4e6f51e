#include <brdfs/analytic/ashikhmin_shirley.h>

#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/term_brdf.h>
#include <hshfit/error.h>
#include <hshfit/sampling/visible_normals.h>

#include <cmath>

namespace hshfit::brdfs {

template <class N>
struct AshikhminShirleyShape {
    N nu, nv;
    N ior;  ///< 0: Schlick's approximation from Rs
};

}  // namespace hshfit::brdfs

#define HWY_TARGET_INCLUDE "brdfs/analytic/ashikhmin_shirley_terms.h"
#include <brdfs/lanes/each_target.h>

namespace hshfit::brdfs {
namespace {

using namespace HWY_NAMESPACE;

HWY_EXPORT(evalAshikhminShirley);
HWY_EXPORT(ashikhminShirleyColumns);

constexpr Laws claims{.nonNegative = true, .reciprocal = true, .mirrorSymmetric = true};

Laws lawsOf(const Parameters& p) {
    Laws result = claims;
    result.isotropic = p.number("nu") == p.number("nv");
    result.energyConserving = largest(p.colour("kd")) == 0 && largest(p.colour("ks")) <= 1;
    return result;
}

void checkKeys(const Parameters& p) {
    if (p.number("ior") != 0 && p.colour("Rs") != Colour{1.0})
        throw UsageError("ashikhmin-shirley: give either Rs or ior, not both");
}

void evalByVectors(const AshikhminShirleyShape<double>& shape, const TermBatch& batch) {
    HWY_DYNAMIC_DISPATCH(evalAshikhminShirley)(shape, batch);
}

class AshikhminShirley final
    : public ShapedBrdf<AshikhminShirleyShape<double>, evalByVectors,
                        evalAll<double, AshikhminShirleyTerms, AshikhminShirleyShape<double>>> {
public:
    explicit AshikhminShirley(const Parameters& p)
        : ShapedBrdf(ashikhminShirleyModel(), p, lawsOf(p),
                     channelWeights<AshikhminShirleyFormula>(p),
                     AshikhminShirleyFormula::shape(Values<double>(p, 0))) {}

    std::vector<Lobe> lobes(const Direction&) const override {
        const auto width = [](double n) { return std::min(1.0, 2.5 / std::sqrt(n + 1)); };
        return {halfwayLobe(width(shape_.nu), width(shape_.nv))};
    }

    /// max(cos theta_i, cos theta_o).
    std::vector<double> kinks(const Direction& wo) const override { return {wo.z}; }
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    checkKeys(p);
    return std::make_unique<AshikhminShirley>(p);
}

std::unique_ptr<ModelColumns> columns(const ColumnRequest& request) {
    return HWY_DYNAMIC_DISPATCH(ashikhminShirleyColumns)(request);
}

/// The diffuse term is linear in Rd (1 - Rs): in one of them for each value of the other.
bool linearBesideStatedRd(const Parameters& stated) {
    return linearUnderStatedScale(stated) && stated.given("Rd");
}

Parameter reflectance(std::string_view name, std::string_view help, double fallback) {
    return {.name = name,
            .help = help,
            .kind = Parameter::Kind::colour,
            .fallback = fallback,
            .min = 0,
            .max = 1};
}

/// Half vectors of section 4 of the paper. The exponents are 1 higher, for the projected area.
HasSamplers::Known sampling(const Parameters& p) {
    return {.all = true,
            .samplers = {grooveSampler(powerNormals(p.number("nu") + 1, p.number("nv") + 1))}};
}

}  // namespace

const Model& ashikhminShirleyModel() {
    static const Model model{
        .name = "ashikhmin-shirley",
        .help = "anisotropic Phong lobe with Fresnel reflectance over a coupled diffuse term",
        .source = "Ashikhmin & Shirley 2000, 10.1080/10867651.2000.10487522",
        .parameters = {linearIf(
                           fitted(reflectance("Rs", "specular reflectance at normal incidence", 1),
                                  {{.low = 0.01, .high = 0.9, .unless = "ior"}}),
                           linearBesideStatedRd),
                       linearIf(fitted(reflectance("Rd", "diffuse reflectance of the substrate", 0),
                                       {{.low = 0, .high = 1}}),
                                alwaysLinear),
                       exponentParameter("nu", "exponent along x", {.low = 1, .high = 1e5}),
                       exponentParameter("nv", "exponent along y",
                                         {.low = 1, .high = 1e5, .follows = "nu"}),
                       {.name = "ior",
                        .help = "index of refraction, instead of Rs: exact Fresnel reflectance",
                        .fallback = 0,
                        .min = 1,
                        .max = 1000},
                       kdParameter(0, 1e6),
                       ksParameter("scale of the lobe")},
        .laws = claims,
        .make = make,
        .columns = columns,
        .sampling = sampling};
    return model;
}

}  // namespace hshfit::brdfs
