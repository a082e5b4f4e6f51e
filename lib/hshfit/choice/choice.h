#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/files/file_set.h>
#include <hshfit/gpu/timing/shader_costs.h>
#include <hshfit/pictures/picture_error.h>
#include <hshfit/pictures/poor.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::choice {

/// A candidate that has been made: f in place of the source.
struct Made {
    std::unique_ptr<Brdf> brdf;  ///< null: the source itself
    std::string spec;            ///< of the BRDF, or of a coefficient file the options
    /// The numbers that a renderer holds: those of a coefficient file with scales and masks, four
    /// for each parameter of a formula, the whole of a measured file.
    std::size_t bytes = 0;
    std::vector<std::string> commands = {};  ///< that write it, in this order; none: no file
    std::function<void(FileSet&)> write = {};
    /// Its shader, whose cost is stated; none: a renderer has its own.
    std::function<gpu::TimedShader()> shader = {};
};

/// A way to have a material in a renderer, before it is made.
struct Candidate {
    std::string kind;            ///< one of those that a renderer takes
    std::string name;            ///< for people: "halfway 7,6,5 in half"
    std::function<Made()> make;  ///< may throw an Error: the candidate is then left out
    double seconds = 3;          ///< of the processor that it takes, about
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

struct ChoiceOptions {
    std::string renderer = "any";
    std::vector<std::string> kinds = {};  ///< that the renderer takes; empty: all
    std::optional<std::size_t> bytes = {};
    /// The mean FLIP that a faithful row has at most. Where it is stated, no other is recommended.
    std::optional<double> error = {};
    /// Cycles of an AMD GPU for a wave of 64 threads, at most (ShaderCost); rows of which none are
    /// known keep to it.
    std::optional<std::uint64_t> cycles = {};
    /// Processor time of all candidates: one that would exceed it is left out.
    double cpuSeconds = 50;
    std::function<void(std::size_t, std::size_t)> progress = {};
    std::function<void(const Row&)> found = {};  ///< a faithful row that is the best so far
};

/// The device whose costs are stated, and a cost to see them by.
struct CostScale {
    std::string device;
    gpu::ShaderCost ggx = {};  ///< of Lambert with a lobe of GGX
};

/// The materials that a source can be, by rising bytes, and the one to take.
struct Choice {
    std::string source;
    std::string renderer;
    std::optional<std::size_t> maxBytes = {};
    double error = 0;  ///< the mean FLIP that counts as faithful
    std::optional<std::uint64_t> maxCycles = {};
    std::optional<CostScale> costs = {};
    std::string noCosts = {};  ///< why costs are not stated
    std::vector<Row> rows = {};
    std::vector<LeftOut> leftOut = {};
    std::optional<std::size_t> recommended = {};  ///< into `rows`
    bool faithful = false;                        ///< whether that row is
    std::string why = {};                         ///< a sentence without its point
};

/// Fewer bytes than that are as good as none: a line of a processor's cache.
inline constexpr std::size_t smallestBytes = 128;

/// Makes and measures the candidates in their order, by the picture error.
///
/// Recommended is, of the rows that the renderer takes within the bounds and that are not poor, the
/// one of fewest bytes, where `smallestBytes` and less count alike; of equal ones that of the least
/// mean FLIP. Where all are poor and no error was stated: of the rows within a tenth of the least
/// mean FLIP that of fewest bytes. Throws NumericError where no candidate could be made, and where
/// cycles are bounded and costs are not known.
Choice choose(const Brdf& source, std::vector<Candidate> candidates, const ChoiceOptions& options);

/// The losses that an eye sees, for people: "7 % too bright in B; a false dip of 12 % in the
/// highlight". The three largest, by how far each is above what is just seen; without a point.
std::string lossSentence(const PictureError& error);

}  // namespace hshfit::choice
