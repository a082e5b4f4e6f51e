#include <brdfs/analytic/charlie.h>

#include <brdfs/analytic/half_vector.h>
#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/term_brdf.h>

#include <cmath>

namespace hshfit::brdfs {
namespace {

constexpr Laws claims{.nonNegative = true, .isotropic = true, .mirrorSymmetric = true};

bool isSoft(const Parameters& p) {
    return p.choice("terminator") == "soft";
}

Laws lawsOf(const Parameters& p) {
    Laws result = claims;
    result.reciprocal = !isSoft(p);
    return result;
}

/// The authors' fit of Lambda over cos theta and r; their table, r = 0 and r = 1.
class SheenMasking {
public:
    explicit SheenMasking(double r) {
        constexpr double smooth[] = {25.3245, 3.32435, 0.16801, -1.27393, -4.85967};
        constexpr double rough[] = {21.5473, 3.82987, 0.19823, -1.97760, -4.32054};
        const double share = (1 - r) * (1 - r);
        double* const mixed[] = {&a_, &b_, &c_, &d_, &e_};
        for (int i = 0; i < 5; ++i) *mixed[i] = share * smooth[i] + (1 - share) * rough[i];
        half_ = curve(0.5);
    }

    double lambda(double cosine) const {
        return std::exp(cosine < 0.5 ? curve(cosine) : 2 * half_ - curve(1 - cosine));
    }

private:
    double curve(double x) const { return a_ / (1 + b_ * std::pow(x, c_)) + d_ * x + e_; }

    double a_, b_, c_, d_, e_, half_;
};

class Charlie final : public TermBrdf {
public:
    explicit Charlie(const Parameters& p)
        : TermBrdf(charlieModel(), p, lawsOf(p), {0.0}, {p.colour("ks")}),
          power_(1 / p.number("r")),
          scale_((2 + power_) / (2 * pi)),
          masking_(p.number("r")),
          soft_(isSoft(p)) {}

    /// sin^(1/r) is singular at the normal, and levels off within one unit of slope.
    std::vector<Lobe> lobes(const Direction&) const override {
        return {{Lobe::About::halfway, 0.5, {}}};
    }

    /// The fit has a kink at 60 degrees, and no closed form to be accurate against.
    std::vector<double> kinks(const Direction&) const override { return {0.5}; }
    double defaultTolerance() const override { return 1e-5; }

protected:
    void terms(const Direction& wo, DirectionBatch wi, double* out) const override {
        const double outgoing = masking_.lambda(wo.z);
        for (std::size_t k = 0; k < wi.count; ++k) {
            const double z = std::max(wi.z[k], 0.0);
            double incoming = masking_.lambda(z);
            if (soft_) incoming = std::pow(incoming, 1 + 2 * std::pow(1 - z, 8));
            const double visible = 0.25 / (1 + incoming + outgoing) / z / wo.z;
            out[k] = density(HalfVector(wo, wi.x[k], wi.y[k], wi.z[k])) * bounded(visible);
        }
    }

private:
    double density(const HalfVector& h) const {
        const double squaredSlope = h.squaredSlope();
        const double squaredSine = squaredSlope / (1 + squaredSlope);
        return scale_ * std::pow(squaredSine, power_ / 2);
    }

    double power_, scale_;
    SheenMasking masking_;
    bool soft_;
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    return std::make_unique<Charlie>(p);
}

}  // namespace

const Model& charlieModel() {
    static const Model model{
        .name = "charlie",
        .help = "sheen of cloth: facets that stand up, bright towards grazing angles",
        .source = "Estevez & Kulla 2017, Production friendly microfacet sheen BRDF",
        .parameters = {ksParameter("sheen colour", 1),
                       {.name = "r",
                        .help = "roughness of the fibres",
                        .min = 0.01,
                        .max = 1,
                        .fit = {{.low = 0.05, .high = 0.95}}},
                       {.name = "terminator",
                        .help = "masking as fitted, or softened for the light (not reciprocal)",
                        .kind = Parameter::Kind::choice,
                        .choices = {"fitted", "soft"}}},
        .laws = claims,
        .make = make};
    return model;
}

}  // namespace hshfit::brdfs
