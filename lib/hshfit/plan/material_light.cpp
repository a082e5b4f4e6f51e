#include <hshfit/plan/internal/material_light.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/light/light_above.h>

#include <fmt/format.h>

namespace hshfit::plan {
namespace {

constexpr int lastLevel = 9;
constexpr std::size_t mostSamples = 250000;
/// Degrees between views of the search and of the check, and the turn of the latter.
constexpr double searchStep = 7, checkStep = 11, checkShift = 0.37;
/// Lattice points of the check, over all lights of one orientation.
constexpr std::size_t checkPoints = 32768;
constexpr int turns = 8;

std::vector<Radiance> radianceIn(const std::vector<LightSamples>& light, const Brdf& brdf,
                                 const Views& views) {
    std::vector<Radiance> result;
    for (const LightSamples& each : light) result.push_back(outgoingRadiance(brdf, each, views));
    return result;
}

std::size_t countOf(const std::vector<LightSamples>& light) {
    std::size_t count = 0;
    for (const LightSamples& each : light) count += each.count();
    return count;
}

}  // namespace

std::vector<Frame> framesOf(const Scene& scene, const Material& material, const Brdf& brdf) {
    const bool allAround = scene.views.phiMax - scene.views.phiMin > 2 * pi - 1e-9;
    const bool turnsMatter = scene.views.anyTangent && !(brdf.laws().isotropic && allAround);
    std::vector<Frame> frames;
    for (Orientation orientation : material.orientations) {
        const double first = orientation.turn;
        for (int k = 0; k < (turnsMatter ? turns : 1); ++k) {
            orientation.turn = first + 2 * pi * k / turns;
            frames.emplace_back(orientation);
        }
    }
    return frames;
}

MaterialLight::MaterialLight(const Scene& scene, const Material& material, const Brdf& brdf,
                             const TimeLimit& limit)
    : budget_(material.budget),
      views_(viewsOf(scene.views, searchStep, 0)),
      frames_(framesOf(scene, material, brdf)) {
    for (int level = 0; level <= lastLevel; ++level) {
        const LightAbove above(scene.lights, level);
        std::vector<LightSamples> light;
        std::size_t count = 0;
        for (const Frame& frame : frames_) {
            light.push_back(above.at(frame));
            count += light.back().count();
            if (level > 0 && count > mostSamples) return;
        }
        std::vector<Radiance> truth = radianceIn(light, brdf, views_);
        if (level > 0) change_ = light::errorOf(budget_, views_, truth, truth_);
        light_ = std::move(light);
        truth_ = std::move(truth);
        isEarly_ = level > 0 && limit.isOver();
        if (isEarly_ || (level > 0 && converged())) return;
    }
}

std::size_t MaterialLight::samples() const {
    return countOf(light_);
}

Rgb MaterialLight::flux() const {
    Rgb sum{};
    for (const LightSamples& each : light_) {
        for (std::size_t c = 0; c < 3; ++c) {
            for (std::size_t k = 0; k < each.count(); ++k) sum[c] += each.flux[c][k] * each.z[k];
        }
    }
    return sum;
}

const std::vector<BasisLight>& MaterialLight::in(const std::string& basis, int order,
                                                 Quantity quantity) {
    const std::string key = fmt::format("{} {} {}", basis, order, quantityName(quantity));
    auto& kept = in_[key];
    if (kept.empty()) {
        const auto made = bases::make(basis, order);
        for (const LightSamples& each : light_) kept.emplace_back(*made, quantity, each);
    }
    return kept;
}

std::vector<Radiance> MaterialLight::radianceOf(const Brdf& brdf) const {
    return radianceIn(light_, brdf, views_);
}

std::vector<Radiance> MaterialLight::radianceOf(const PairEvaluator& evaluator,
                                                std::size_t channels) const {
    std::vector<Radiance> result;
    for (const LightSamples& each : light_) {
        result.push_back(outgoingRadiance(evaluator, channels, each, views_));
    }
    return result;
}

LatticeCheck::LatticeCheck(const Scene& scene, const Material& material, const Brdf& brdf)
    : budget_(material.budget), views_(viewsOf(scene.views, checkStep, checkShift)) {
    const std::size_t points = checkPoints / scene.lights.size() + 1;
    for (const Frame& frame : framesOf(scene, material, brdf))
        light_.push_back(latticeSamples(scene.lights, frame, points));
    expected_ = radianceIn(light_, brdf, views_);
}

LatticeCheck::Result LatticeCheck::of(const Brdf& approximation) const {
    const std::vector<Radiance> actual = radianceIn(light_, approximation, views_);
    return {.error = light::errorOf(budget_, views_, expected_, actual),
            .thetas = views_.thetas,
            .byElevation = errorsByElevation(budget_, views_, expected_, actual)};
}

}  // namespace hshfit::plan
