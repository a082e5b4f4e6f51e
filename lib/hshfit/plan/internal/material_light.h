#pragma once

#include <hshfit/light/light_samples.h>
#include <hshfit/light/radiance.h>
#include <hshfit/light/views.h>
#include <hshfit/scene/scene.h>
#include <hshfit/time_limit.h>

#include <map>
#include <string>
#include <vector>

namespace hshfit::plan {

using scene::Limits;
using scene::Material;
using scene::Scene;

/// The light on one material in all of its orientations, with samples refined until outgoing
/// radiance converges, and quantities that follow from it.
class MaterialLight {
public:
    /// Refines until two levels agree to a twentieth of the budget, in which case `converged`
    /// is true, a quarter of a million samples are reached, or the time is over, when a quarter of
    /// the budget does.
    MaterialLight(const Scene& scene, const Material& material, const Brdf& brdf,
                  const TimeLimit& limit = {});

    const Budget& budget() const { return budget_; }
    const Views& views() const { return views_; }
    const std::vector<Radiance>& truth() const { return truth_; }
    bool converged() const {
        return change_ <= budget_.error / (isEarly_ ? toleratedEarly : tolerated);
    }
    double change() const { return change_; }
    /// All light samples over all orientations.
    std::size_t samples() const;
    std::size_t orientations() const { return frames_.size(); }
    const std::vector<Frame>& frames() const { return frames_; }
    /// Flux across a surface, per R, G, B, over all orientations.
    Rgb flux() const;

    /// The light in a basis for each orientation, cached after the first call.
    const std::vector<BasisLight>& in(const std::string& basis, int order, Quantity quantity);
    /// Outgoing radiance of any BRDF, for each orientation.
    std::vector<Radiance> radianceOf(const Brdf& brdf) const;
    std::vector<Radiance> radianceOf(const PairEvaluator& evaluator, std::size_t channels) const;

    double errorOf(const std::vector<Radiance>& radiance) const {
        return light::errorOf(budget_, views_, truth_, radiance);
    }

private:
    static constexpr double tolerated = 20, toleratedEarly = 4;
    Budget budget_;
    Views views_;
    std::vector<Frame> frames_;
    std::vector<LightSamples> light_;
    std::vector<Radiance> truth_;
    double change_ = 1;
    bool isEarly_ = false;  ///< the time was over
    std::map<std::string, std::vector<BasisLight>> in_;
};

/// The orientations to try: the stated ones, each in 8 turns about the normal if the tangent is
/// free and turns matter.
std::vector<Frame> framesOf(const Scene& scene, const Material& material, const Brdf& brdf);

/// The outgoing radiance of a material by lattice points, at views that lie between the views of
/// MaterialLight.
class LatticeCheck {
public:
    struct Result {
        double error = 0;
        std::vector<double> thetas, byElevation;
    };

    LatticeCheck(const Scene& scene, const Material& material, const Brdf& brdf);

    /// The errors of another BRDF in the place of the material's.
    Result of(const Brdf& approximation) const;

private:
    Budget budget_;
    Views views_;
    std::vector<LightSamples> light_;
    std::vector<Radiance> expected_;
};

}  // namespace hshfit::plan
