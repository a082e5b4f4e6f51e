// A BRDF of one's own, projected with the part `math` of the library alone: f = (1 + 3 wi.z wo.z)
// / 4 pi. Prints the energy of f cos(theta_i) for wo along the normal, and the share of it that
// hemispherical harmonics of order 3 capture.
#include <hshfit/hshfit.h>

#include <cstdio>
#include <numbers>

class Brightening : public hshfit::Brdf {
public:
    std::string name() const override { return "brightening"; }
    const hshfit::Channels& channels() const override { return channels_; }
    const hshfit::Laws& laws() const override { return laws_; }
    void eval(const hshfit::Direction& wo, hshfit::DirectionBatch wi, double* out) const override {
        for (std::size_t k = 0; k < wi.count; ++k) {
            const bool above = wo.z > 0 && wi.z[k] > 0;
            out[k] = above ? (1 + 3 * wi.z[k] * wo.z) / (4 * std::numbers::pi) : 0;
        }
    }

private:
    hshfit::Channels channels_ = hshfit::Channels::grey();
    hshfit::Laws laws_ = {.nonNegative = true,
                          .reciprocal = true,
                          .isotropic = true,
                          .mirrorSymmetric = true,
                          .energyConserving = true};
};

int main() try {
    const auto basis = hshfit::bases::make("hsh", 3);
    const auto outgoing = hshfit::OutgoingSet::direction(0, 0);
    const auto result = hshfit::project(Brightening(), *basis, outgoing,
                                        {.quantity = hshfit::Quantity::brdfCosine});
    std::printf("%.12f %.6f\n", result.coefficients.energy.value,
                hshfit::capturedShare(result).value_or(0));
} catch (const hshfit::Error& error) {
    std::fprintf(stderr, "own_brdf: %s\n", error.what());
    return static_cast<int>(error.code());
}
