#include <hshfit/choice/choice.h>

#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <utility>

namespace hshfit::choice {
namespace {

/// Rows this close to the least mean FLIP are as good as the best where all are poor.
constexpr double nearBest = 1.1;

/// Processor time of all threads of this process.
double processorSeconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// Seconds of a formula's fit that is slow, and of any candidate whose long part is done.
constexpr double slowFit = 10, halfMade = 1;
/// The FLIP of the quick formulas, in bounds of faithful ones, beyond which a slow one is tried
/// last, and how many times as long its fit goes on there.
constexpr double farOff = 2, longer = 4;

/// The candidates that are left, and the next of them.
class Queue {
public:
    Queue(std::vector<Candidate> candidates, double bound)
        : left_(std::move(candidates)), bound_(bound) {}

    bool isEmpty() const { return left_.empty(); }
    /// Takes the candidates in their order, but slow fits of formulas last where the best so far is
    /// far off.
    Candidate next() {
        const bool areFar = std::isfinite(nearest_) && nearest_ > farOff * bound_;
        const auto waits = [&](const Candidate& candidate) {
            return areFar && candidate.isFormula && candidate.seconds >= slowFit;
        };
        auto place = std::ranges::find_if_not(left_, waits);
        if (place == left_.end()) place = left_.begin();
        Candidate candidate = std::move(*place);
        left_.erase(place);
        if (waits(candidate)) candidate.seconds *= longer;
        return candidate;
    }
    void measured(const Candidate& candidate, double flip) {
        if (candidate.isFormula) nearest_ = std::min(nearest_, flip);
    }

private:
    std::vector<Candidate> left_;
    double bound_;
    double nearest_ = std::numeric_limits<double>::infinity();  ///< FLIP of formulas
};

double secondsFor(const Candidate& candidate) {
    return candidate.isHalfMade && candidate.isHalfMade() ? halfMade : candidate.seconds;
}

/// Why the renderer or the bounds do not take a row; empty: they do.
std::string unfitReason(const Row& row, const ChoiceOptions& options) {
    const std::vector<std::string>& kinds = options.kinds;
    if (!kinds.empty() && std::ranges::find(kinds, row.kind) == kinds.end())
        return fmt::format("not for {}", options.renderer);
    if (options.bytes && row.made.bytes > *options.bytes)
        return fmt::format("more than {} bytes", *options.bytes);
    if (options.cycles && row.cost && row.cost->cycles > *options.cycles)
        return fmt::format("more than {} cycles", *options.cycles);
    return "";
}

std::size_t countedBytes(const Row& row) {
    return std::max(row.made.bytes, smallestBytes);
}

bool isBetter(const Row& a, const Row& b) {
    return std::pair(countedBytes(a), a.picture.flip.mean) <
           std::pair(countedBytes(b), b.picture.flip.mean);
}

/// The best of the rows that `counts` takes.
template <class Counts>
std::optional<std::size_t> bestOf(const std::vector<Row>& rows, const Counts& counts) {
    std::optional<std::size_t> best;
    for (std::size_t k = 0; k < rows.size(); ++k)
        if (counts(rows[k]) && (!best || isBetter(rows[k], rows[*best]))) best = k;
    return best;
}

bool isFaithful(const Row& row) {
    return row.unfit.empty() && !row.poor;
}

void recommend(Choice& choice, bool errorStated) {
    choice.recommended = bestOf(choice.rows, isFaithful);
    choice.faithful = choice.recommended.has_value();
    if (choice.faithful) {
        choice.why = "the fewest bytes of those that look like the source";
        return;
    }
    double least = std::numeric_limits<double>::infinity();
    for (const Row& row : choice.rows)
        if (row.unfit.empty()) least = std::min(least, row.picture.flip.mean);
    if (!std::isfinite(least)) {
        choice.why = "no candidate is within the bounds";
    } else if (errorStated) {
        choice.why = fmt::format(
            "none keeps to FLIP {:g} without a false dip or peak; the least "
            "FLIP is {:.3f}",
            choice.error, least);
    } else {
        choice.recommended = bestOf(choice.rows, [&](const Row& row) {
            return row.unfit.empty() && row.picture.flip.mean <= nearBest * least;
        });
        choice.why = fmt::format("none is faithful, this is the nearest: {}",
                                 *choice.rows[*choice.recommended].poor);
    }
}

}  // namespace

Choice choose(const Brdf& source, std::vector<Candidate> candidates, const ChoiceOptions& options) {
    const double begin = processorSeconds();
    PoorBounds bounds;
    if (options.error) bounds.flip = *options.error;
    std::optional<gpu::ShaderCosts> costs;
    std::string noCosts;
    try {
        costs.emplace();
    } catch (const NumericError& error) {
        if (options.cycles) throw;
        noCosts = error.what();
    }
    const RowMeasurement measurement(source, bounds, costs ? &*costs : nullptr);
    Choice choice{.source = source.name(),
                  .renderer = options.renderer,
                  .maxBytes = options.bytes,
                  .error = bounds.flip,
                  .maxCycles = options.cycles,
                  .noCosts = noCosts};
    if (costs) choice.costs = {costs->device(), costs->ggx()};
    std::optional<Row*> best;
    const std::size_t count = candidates.size();
    choice.rows.reserve(count);
    Queue queue(std::move(candidates), bounds.flip);
    for (std::size_t k = 0; !queue.isEmpty(); ++k) {
        const Candidate candidate = queue.next();
        if (options.progress) options.progress(k, count);
        const double spent = processorSeconds() - begin, seconds = secondsFor(candidate);
        if (spent + seconds > options.cpuSeconds) {
            choice.leftOut.push_back(
                {candidate.kind, candidate.name,
                 fmt::format("about {:.2g} seconds of the processor; {:.0f} of {:g} are spent",
                             seconds, spent, options.cpuSeconds)});
            continue;
        }
        try {
            Row& row = choice.rows.emplace_back(measurement.rowOf(candidate));
            queue.measured(candidate, row.picture.flip.mean);
            row.unfit = unfitReason(row, options);
            if (!isFaithful(row) || (best && !isBetter(row, **best))) continue;
            best = &row;
            if (options.found) options.found(row);
        } catch (const OutputError&) {
            throw;
        } catch (const Error& error) {
            choice.leftOut.push_back({candidate.kind, candidate.name, error.what()});
        }
    }
    source.checkIntact();
    if (choice.rows.empty()) {
        throw NumericError(
            fmt::format("{}: there is no candidate: {}", source.name(),
                        choice.leftOut.empty() ? "none was asked for" : choice.leftOut[0].reason));
    }
    std::ranges::stable_sort(choice.rows, std::less{},
                             [](const Row& row) { return row.made.bytes; });
    recommend(choice, options.error.has_value());
    return choice;
}

}  // namespace hshfit::choice
