#pragma once

#include <hshfit/plan/scene.h>
#include <hshfit/representation/forms/form.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::plan {

/// One way to keep a material, as tried in the scene's light.
struct Choice {
    std::string spec;  ///< the material's specification, or one channel of it ("grey:…")
    Form form;
    double tolerance = 0;  ///< of the projection; 0 where the form has none
    std::size_t bytes = 0;
    double error = 0;                        ///< the budget's measure
    std::optional<double> nanoseconds = {};  ///< a pair; only where times were asked for
};

/// An accepted choice: with the numbers that go to the file, and what a second integration says.
struct Accepted {
    Choice choice;
    Representation representation;
    /// By lattice points instead of quadrature, at other views, from the representation itself.
    double verified = 0;
    std::vector<double> thetas = {}, errors = {};  ///< verified, by elevation (radians)
    std::size_t raised = 0;  ///< cheaper choices that passed but for this check
};

struct MaterialPlan {
    Material material;
    std::optional<Accepted> accepted;
    /// Cheaper ones nearest to it, each the best for its bytes; where there is no plan, the best.
    std::vector<Choice> cheaper;
    std::optional<Choice> dearer;      ///< the first with at most half the error
    std::string refused;               ///< why there is no plan; empty where there is one
    std::vector<std::string> instead;  ///< what to use then
    std::vector<std::string> rules;    ///< what the scene allowed to leave out
    std::vector<double> lightPower;    ///< [l]: share of cos-weighted light in HSH band l
    std::size_t rungs = 0, tried = 0;
    std::size_t lightSamples = 0, views = 0;
    double referenceError = 0;  ///< change of L over the last two levels of light sampling
};

struct Plan {
    Scene scene;
    std::vector<MaterialPlan> materials;
};

struct PlanOptions {
    std::vector<std::string> bases = {"hsh", "zernike", "makhotkin"};
    int maxOrder = 12;
    bool byTime = false;  ///< measure nanoseconds and take the fastest that fits
    std::function<void(std::size_t, std::size_t)> progress = {};
};

/// The cheapest way to keep every material within its budget in the light of its scene.
///
/// Choices are tried from few bytes to many (ladder.h) with outgoing radiance by quadrature that
/// follows the lights; the first within the budget is projected in full and
/// checked by `latticeSamples` at other views; if that fails, the search goes on. The same scene
/// gives the same plan, unless times are asked for. A material without a plan says why.
/// Throws UsageError for a basis that is not orthonormal or a spectral material, InputError for one
/// that cannot be opened.
Plan planScene(const Scene& scene, const BrdfOpener& open, const PlanOptions& options = {});

/// The call that makes the choice's file, as messages name it (wording.h).
std::string commandOf(const Choice& choice, const std::string& file);

/// What HSH of order 10 on a 32 x 32 map takes, RGB in float32.
constexpr std::size_t baselineBytes = std::size_t{32} * 32 * 3 * 100 * 4;

}  // namespace hshfit::plan
