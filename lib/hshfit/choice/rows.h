#pragma once

#include <hshfit/accuracy/pair_errors.h>
#include <hshfit/brdf/brdf.h>
#include <hshfit/files/file_set.h>
#include <hshfit/gpu/timing/shader_costs.h>
#include <hshfit/pictures/picture_error.h>
#include <hshfit/pictures/poor.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace hshfit::choice {

/// A candidate that has been made: f in place of the source.
struct Made {
    std::unique_ptr<Brdf> brdf;  ///< null: the source itself
    std::string spec;            ///< of the BRDF, or of a coefficient file the options
    /// The bytes that a renderer holds: the numbers, scales and masks of a coefficient file, four
    /// bytes for each parameter of a formula, the whole of a measured file.
    std::size_t bytes = 0;
    std::vector<std::string> commands = {};  ///< that write it, in this order; none: no file
    std::function<void(FileSet&)> write = {};
    /// Its shader, whose cost is stated; none: a renderer has its own.
    std::function<gpu::TimedShader()> shader = {};
};

/// The kinds of formulas that studies measure beside coefficients, unless others are asked for.
inline const std::vector<std::string> usualFormulas = {"model", "lobes"};

/// A way to have a material in a renderer, before it is made.
struct Candidate {
    std::string kind;            ///< one of those that a renderer takes
    std::string name;            ///< for people: "halfway 7,6,5 in half"
    std::function<Made()> make;  ///< may throw an Error: the candidate is then left out
    double seconds = 3;          ///< of the processor that it takes, about
    /// Whether its long part is done, for another candidate; empty: it is not.
    std::function<bool()> isHalfMade = {};
    bool isFormula = false;  ///< a fit of a formula: far off where others of these are
};

/// A candidate and its distance from the source to the eye.
struct Row {
    std::string kind, name;
    Made made;
    PictureError picture = {};
    /// The share of the energy of f cos(theta_i) cos(theta_o); none where that does not exist.
    std::optional<double> captured = {};
    std::optional<std::string> poor = {};      ///< pictures/poor.h, with the error asked for
    std::string lost = {};                     ///< a sentence without its point
    std::optional<gpu::ShaderCost> cost = {};  ///< none: not known (Made::shader)
    std::string unfit = {};  ///< why this renderer and these bounds do not take it
};

/// A candidate that was not measured, and why: an error, or no time left.
struct LeftOut {
    std::string kind, name, reason;
};

/// The device whose costs are stated, and a cost to see them by.
struct CostScale {
    std::string device;
    gpu::ShaderCost ggx = {};  ///< of Lambert with a lobe of GGX
};

/// Measures candidates against one source, which outlives it.
class RowMeasurement {
public:
    /// Costs are stated where there are `costs`, which outlive it too.
    explicit RowMeasurement(const Brdf& source, const PoorBounds& bounds = {},
                            const gpu::ShaderCosts* costs = nullptr);

    /// Makes and measures it; throws what Candidate::make throws.
    Row rowOf(const Candidate& candidate) const;

    const PictureReference& pictures() const { return pictures_; }
    /// The source on spreadPairs(); none where its energy is not finite.
    const std::optional<PairReference>& pairs() const { return pairs_; }

private:
    std::optional<double> capturedBy(const Brdf& g) const;

    const Brdf& source_;
    PoorBounds bounds_;
    const gpu::ShaderCosts* costs_;
    PictureReference pictures_;
    std::optional<PairReference> pairs_;
};

/// The rows of candidates, and the candidates that could not be had.
struct MeasuredRows {
    std::vector<Row> rows;  ///< by rising bytes
    std::vector<LeftOut> leftOut;
};
MeasuredRows measureRows(const RowMeasurement& measurement, std::span<const Candidate> candidates);

/// The losses that an eye sees, for people: "7 % too bright in B; a false dip of 12 % in the
/// highlight". The three largest, by how far each is above what is just seen; without a point.
std::string lossSentence(const PictureError& error);

}  // namespace hshfit::choice
