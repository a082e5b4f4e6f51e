#pragma once

#include <hshfit/accuracy/pair_errors.h>
#include <hshfit/choice/rows.h>
#include <hshfit/pictures/picture_error.h>
#include <hshfit/plan/seen_surfaces.h>
#include <hshfit/representation/forms/form.h>
#include <hshfit/scene/scene.h>
#include <hshfit/tradeoff/projection_folder.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::plan {

/// One form of a material and its error in the scene's light.
struct Choice {
    std::string spec;  ///< the material's specification, or one channel of it ("grey:…")
    Form form;
    double tolerance = 0;  ///< of the projection; 0 where the form has none
    std::size_t bytes = 0;
    double error = 0;                        ///< the budget's measure
    std::optional<OverLights> flip = {};     ///< if the budget bounds it; not of Accepted
    std::optional<double> nanoseconds = {};  ///< per pair; only if times are measured
};

/// An accepted choice with the numbers of its file, verified by a second integration.
struct Accepted {
    Choice choice;
    Representation representation;
    /// The error by lattice points instead of quadrature, at other views, of the representation.
    double verified = 0;
    std::vector<double> thetas = {}, errors = {};  ///< verified, by elevation (radians)
    /// Against the material over both hemispheres, whatever the light.
    PairSummary pairs = {};
    PictureError picture = {};                 ///< of the file against the material
    std::size_t raised = 0;                    ///< cheaper choices that only these checks refused
    std::optional<gpu::ShaderCost> cost = {};  ///< if asked for, and it has a shader
};

/// A material that is no coefficient file, in the scene's light.
struct PlannedFormula {
    choice::Row row;
    double error = 0;     ///< the budget's measure
    double verified = 0;  ///< as of Accepted
    bool within = false;  ///< both, and the picture, keep to the budget
};

struct MaterialPlan {
    Material material;
    std::optional<SeenMaterial> seen = {};  ///< by the scene's cameras
    std::optional<Accepted> accepted;
    /// The nearest cheaper choices, each the best for its bytes; without a plan, the best ones.
    std::vector<Choice> cheaper;
    std::optional<Choice> dearer;  ///< the first with at most half the error
    /// By rising bytes; none where samples do not resolve the light.
    std::vector<PlannedFormula> formulas = {};
    std::string refused;               ///< reason why there is no plan; empty if there is one
    std::vector<std::string> instead;  ///< suggestions without a plan
    std::vector<std::string> rules;    ///< simplifications that the scene allows
    std::vector<double> lightPower;    ///< [l]: share of cos-weighted light in HSH band l
    std::size_t rungs = 0, tried = 0;
    bool cut = false;  ///< the time was over before all cheaper forms had been tried
    std::size_t lightSamples = 0, views = 0;
    double referenceError = 0;  ///< change of L over the last two levels of light sampling
};

/// A scene with the cheapest form found for each of its materials.
struct Plan {
    Scene scene;
    std::vector<MaterialPlan> materials;
    std::optional<choice::CostScale> costs = {};  ///< if asked for
};

/// The candidates of some kinds that are no coefficient files, for a material and its BRDF, which
/// outlives them.
using FormulaMaker = std::function<std::vector<choice::Candidate>(
    const Brdf& brdf, const Material& material, const std::vector<std::string>& kinds)>;

struct PlanOptions {
    std::vector<std::string> bases = {"hsh", "zernike", "makhotkin"};
    int maxOrder = 12;
    /// Each material as cameras see it (seenMaterials), in the place of orientations and views that
    /// the scene does not state. Empty: nothing is known.
    std::vector<SeenMaterial> seen = {};
    bool costs = false;  ///< state what shaders cost on an AMD GPU (gpu::ShaderCosts)
    std::vector<std::string> formulas = choice::usualFormulas;  ///< kinds to measure beside forms
    FormulaMaker makeFormulas = {};                             ///< none: no formulas
    tradeoff::ProjectionFolder folder = {};                     ///< projections of earlier runs
    bool byTime = false;  ///< measure nanoseconds and choose the fastest form within the budget
    /// For the searches together. A large halfway form is made after it where none was found.
    std::optional<double> seconds = {};
    std::function<void(std::size_t, std::size_t)> progress = {};
    /// Called for a material before its search, with a halfway form that keeps to the budget, where
    /// one of the three smallest does.
    std::function<void(const Material&, const Choice&)> found = {};
};

/// The cheapest form of every material within its error budget in the light of its scene.
///
/// Choices are tried from few bytes to many (ladder.h) with outgoing radiance by quadrature
/// that follows the lights. The first within the budget is projected in full and verified by
/// `latticeSamples` at other views; if that fails, the search goes on. Where the budget bounds
/// FLIP too, pictures of forms within the other bound are drawn until it is certain that they
/// exceed it (PictureReference::flipWithin). The same scene gives the
/// same plan, unless times are measured. A material without a plan has a reason.
/// Throws UsageError for a basis that is not orthonormal or a spectral material, InputError for one
/// that cannot be opened.
Plan planScene(const Scene& scene, const BrdfOpener& open, const PlanOptions& options = {});

/// The call that writes the choice's file, as messages name it (wording.h).
std::string commandOf(const Choice& choice, const std::string& file);

/// The size of HSH of order 10 on a 32 x 32 map, RGB in float32.
constexpr std::size_t baselineBytes = std::size_t{32} * 32 * 3 * 100 * 4;

}  // namespace hshfit::plan
