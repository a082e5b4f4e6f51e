#pragma once

#include <hshfit/choice/rows.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::choice {

struct ChoiceOptions {
    std::string renderer = "any";
    std::vector<std::string> kinds = {};  ///< that the renderer takes; empty: all
    std::optional<std::size_t> bytes = {};
    /// The mean FLIP that a faithful row has at most. Where it is stated, no other is recommended.
    std::optional<double> error = {};
    /// Cycles of an AMD GPU for a wave of 64 threads, at most (ShaderCost); a row whose cost is not
    /// known keeps to it.
    std::optional<std::uint64_t> cycles = {};
    /// Processor time of all candidates: one that would exceed it is left out.
    double cpuSeconds = 50;
    std::function<void(std::size_t, std::size_t)> progress = {};
    std::function<void(const Row&)> found = {};  ///< a faithful row that is the best so far
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

/// Makes and measures the candidates by the picture error, in their order, but slow fits of
/// formulas last where quick ones are far from faithful.
///
/// Recommended is, of the rows that the renderer takes within the bounds and that are not poor, the
/// one of fewest bytes, where `smallestBytes` and less count alike; of equal ones the one of the
/// least mean FLIP. Where all are poor and no error was stated: of the rows within a tenth of the
/// least mean FLIP the one of fewest bytes. Throws NumericError where no candidate could be made,
/// and where cycles are bounded and costs are not known.
Choice choose(const Brdf& source, std::vector<Candidate> candidates, const ChoiceOptions& options);

}  // namespace hshfit::choice
