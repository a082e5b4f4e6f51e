// Disney's lobes: formulas and source are those of brdfs/analytic/disney.cpp; isotropic.
// Tints come last and do not matter: baseColor is linear without them alone.
#include <brdfs/fit/lobe_row.h>

namespace hshfit::brdfs {
namespace {

template <class T>
class DisneyLobe {
public:
    DisneyLobe(const T* values, const LobeWords& words)
        : subsurface_(values[0]),
          metallic_(values[1]),
          specular_(values[2]),
          roughness_(values[3]),
          sheen_(values[4]),
          coat_(0.25 * values[5]) {
        using std::log;
        const T alpha = roughness_ * roughness_;
        squared_ = alpha > T(0.001) ? alpha * alpha : T(1e-6);
        const T half = 0.5 + 0.5 * roughness_, old = half * half;
        masking_ = words.at("masking") == "2014" ? squared_ : old * old;
        const T gloss = 0.1 - 0.099 * values[6];
        coatSquared_ = gloss * gloss;
        coatPeak_ = (coatSquared_ - 1.0) / (pi * log(coatSquared_));
    }

    /// What baseColor multiplies; `base`: sheen, Schlick's edge, the clear coat.
    T operator()(const PairGeometry& g, T& base) const {
        const double rise = g.schlick();
        const T ratio = (1 + g.squaredSlope) / (squared_ + g.squaredSlope);
        const T lobe = ratio * ratio * squared_ * (1 / pi) * visible(masking_, g.cosI) *
                       visible(masking_, g.cosO);
        const T dielectric = 1.0 - metallic_;
        base += dielectric * sheen_ * rise + dielectric * specular_ * lobe * (0.08 * (1 - rise)) +
                lobe * rise;
        const double fresnel = 0.04 + 0.96 * rise;
        base +=
            coat_ * coatPeak_ / (coatSquared_ + g.squaredSlope) *
            (fresnel * (1 + g.squaredSlope) * visible(0.0625, g.cosI) * visible(0.0625, g.cosO));
        return dielectric * diffuse(g) * (1 / pi) + metallic_ * lobe * (1 - rise);
    }

private:
    template <class S>
    static S visible(const S& squared, double z) {
        using std::sqrt;
        return 1.0 / (z + sqrt(z * z + squared * std::max(0.0, (1 - z) * (1 + z))));
    }

    T diffuse(const PairGeometry& g) const {
        const double in = PairGeometry::schlickOf(g.cosI), out = PairGeometry::schlickOf(g.cosO);
        const T retro = roughness_ * (g.dot * g.dot);
        const auto both = [&](const T& edge) {
            return (1.0 + (edge - 1.0) * in) * (1.0 + (edge - 1.0) * out);
        };
        const T flat = 1.25 * (both(retro) * (1 / (g.cosI + g.cosO) - 0.5) + 0.5);
        const T round = both(0.5 + 2.0 * retro);
        return round + (flat - round) * subsurface_;
    }

    T subsurface_, metallic_, specular_, roughness_, sheen_, coat_;
    T squared_, masking_, coatSquared_, coatPeak_;
};

}  // namespace

std::span<const LobeRow> disneyLobes() {
    static const std::vector<LobeRow> table{
        {"disney",
         {"subsurface", "metallic", "specular", "roughness", "sheen", "clearcoat", "clearcoatGloss",
          "specularTint", "sheenTint"},
         "baseColor",
         "",
         makeLobe<DisneyLobe, 7>}};
    return table;
}

}  // namespace hshfit::brdfs
