#include <brdfs/fit/fit_search.h>

#include <hshfit/stop_request.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>
#include <random>

namespace hshfit::brdfs {
namespace {

constexpr std::size_t coarseCount = 4096;
/// Above this number of samples, a second and third search on all costs more than it finds.
constexpr std::size_t manySamples = 200'000, middleCount = 50'000;

Bounds shapeBounds(const ParametricSum& sum) {
    Bounds bounds;
    for (const ShapeParameter& shape : sum.shapes()) {
        bounds.lower.push_back(shape.lower());
        bounds.upper.push_back(shape.upper());
    }
    return bounds;
}

/// Element `index` of van der Corput's sequence in a base.
double radicalInverse(std::size_t index, int base) {
    double value = 0, digit = 1;
    for (; index > 0; index /= static_cast<std::size_t>(base)) {
        digit /= base;
        value += digit * static_cast<double>(index % static_cast<std::size_t>(base));
    }
    return value;
}

std::vector<std::vector<double>> startsOf(const ParametricSum& sum, std::size_t count,
                                          std::uint64_t seed) {
    constexpr int primes[] = {2,  3,  5,  7,  11, 13, 17, 19, 23, 29, 31, 37,
                              41, 43, 47, 53, 59, 61, 67, 71, 73, 79, 83, 89};
    std::mt19937_64 random(seed);
    std::vector<double> shift;
    for (std::size_t j = 0; j < sum.shapes().size(); ++j)
        shift.push_back(static_cast<double>(random() >> 11) * 0x1p-53);
    std::vector<std::vector<double>> starts;
    for (std::size_t i = 0; i < count; ++i) {
        starts.emplace_back();
        for (std::size_t j = 0; j < sum.shapes().size(); ++j) {
            const ShapeParameter& shape = sum.shapes()[j];
            const double share =
                std::fmod(radicalInverse(i + 1, primes[j % std::size(primes)]) + shift[j], 1.0);
            const double low = shape.toScale(shape.free.startLow),
                         high = shape.toScale(shape.free.startHigh);
            starts.back().push_back(low + share * (high - low));
        }
    }
    return starts;
}

/// x = u followed by linear parameters.
std::vector<double> withLinear(std::vector<double> u, const std::vector<double>& linear) {
    u.insert(u.end(), linear.begin(), linear.end());
    return u;
}

bool isNan(double value) {
    return std::isnan(value);
}

bool byCost(const Minimum& a, const Minimum& b) {
    return (std::isfinite(a.cost) ? a.cost : 1e300) < (std::isfinite(b.cost) ? b.cost : 1e300);
}

/// Searches of one problem; `linear`: what is minimised over the shapes alone.
class Search {
public:
    Search(const FitProblem& problem, bool linear)
        : problem_(problem),
          linear_(linear),
          shapes_(shapeBounds(problem.sum())),
          joint_(jointBounds(problem.sum(), problem.channels())) {}

    /// From shapes, with the linear parameters eliminated if that is the loss itself. Else jointly,
    /// from the linear parameters that elimination gives for these shapes and from the minimum of
    /// the eliminated problem, whichever leads further.
    Minimum fromShapes(const std::vector<double>& u, const MinimiseOptions& options) const {
        if (linear_) return eliminated(u, options);
        Minimum direct;
        std::vector<double> best;
        problem_.eliminated(u, false, best);
        direct.x = withLinear(u, best);
        direct = fromAll(direct, options);
        // Functions of each channel are not linear in what elimination removes.
        if (problem_.sum().channelwise()) return direct;
        Minimum minimum = fromAll(eliminated(u, options), options);
        return byCost(direct, minimum) ? direct : minimum;
    }

    /// Goes on from shapes with the linear parameters of a minimum, except that parameters which
    /// vanish in every channel start at `lifted`: a minimum without a lobe may be only local if the
    /// loss is not linear. Nothing if no parameter vanishes.
    std::optional<Minimum> lifted(const std::vector<double>& u, const Minimum& minimum,
                                  const MinimiseOptions& options) const {
        constexpr double lifted = 0.2;
        const std::size_t shapes = problem_.shapeCount(), channels = problem_.channels();
        Minimum start = minimum;
        std::ranges::copy(u, start.x.begin());
        bool any = false;
        for (std::size_t first = shapes; first < start.x.size(); first += channels) {
            bool vanishes = true;
            for (std::size_t i = first; i < first + channels; ++i)
                vanishes = vanishes && minimum.x[i] <= joint_.lower[i] + 1e-9;
            if (!vanishes) continue;
            any = true;
            for (std::size_t i = first; i < first + channels; ++i)
                start.x[i] = std::clamp(lifted, joint_.lower[i], joint_.upper[i]);
        }
        if (!any) return std::nullopt;
        return fromAll(start, options);
    }

    Minimum eliminated(const std::vector<double>& u, const MinimiseOptions& options) const {
        std::vector<double> linear;
        Minimum minimum =
            minimise(eliminatedEquations(linear), u, shapes_.lower, shapes_.upper, options);
        problem_.eliminated(minimum.x, false, linear);
        minimum.x = withLinear(std::move(minimum.x), linear);
        return minimum;
    }

    Minimum fromAll(const Minimum& start, const MinimiseOptions& options) const {
        Minimum minimum = minimise(jointEquations(), start.x, joint_.lower, joint_.upper, options);
        minimum.iterations += start.iterations;
        minimum.evaluations += start.evaluations;
        return minimum;
    }

    /// Goes on from a minimum, in the variables of the loss: shapes, or all.
    Minimum from(const Minimum& start, const MinimiseOptions& options) const {
        if (!linear_) return fromAll(start, options);
        return eliminated(variables(start), options);
    }

    /// The sum that `from` minimises; `linear` receives eliminated parameters and has to outlive
    /// it.
    SumOfSquares equations(std::vector<double>& linear) const {
        return linear_ ? eliminatedEquations(linear) : jointEquations();
    }

private:
    SumOfSquares eliminatedEquations(std::vector<double>& linear) const {
        return [this, &linear](std::span<const double> at, bool derivatives) {
            return problem_.eliminated(at, derivatives, linear);
        };
    }
    SumOfSquares jointEquations() const {
        return [this](std::span<const double> at, bool derivatives) {
            return problem_.joint(at, derivatives);
        };
    }
    std::vector<double> variables(const Minimum& at) const {
        const auto shapes = static_cast<std::ptrdiff_t>(problem_.shapeCount());
        return linear_ ? std::vector<double>(at.x.begin(), at.x.begin() + shapes) : at.x;
    }

    const FitProblem& problem_;
    bool linear_;
    Bounds shapes_, joint_;
};

/// Goes on from the minimum on fewer samples, whose second derivatives stand for those on all: a
/// few iterations suffice then, for the price of about one evaluation each.
Minimum onMore(const FitProblem& fewer, const FitProblem& more, bool linear, const Minimum& start,
               const MinimiseOptions& last) {
    std::vector<double> found;
    const Search before(fewer, linear);
    const SumOfSquares part = before.equations(found);
    MinimiseOptions options = last;
    options.fewer = &part;
    return Search(more, linear).from(start, options);
}

/// Moves a start to known values of shapes (FitOptions::from).
void moveTo(const std::vector<double>& values, const ParametricSum& sum, std::vector<double>& u) {
    for (std::size_t j = 0; j < values.size(); ++j)
        if (!std::isnan(values[j])) u[j] = sum.shapes()[j].toScale(values[j]);
}

/// For pixels: the first iterations of a search, and the searches that go on after them.
constexpr int heatIterations = 25;
constexpr std::size_t heatWinners = 8;

/// Minima of the problem on few samples, from the best of many starts, best first.
std::vector<Minimum> coarseMinima(const FitProblem& problem, bool linear,
                                  const FitOptions& options) {
    const std::size_t shapes = problem.shapeCount();
    const bool known = !options.from.empty() && std::ranges::none_of(options.from, isNan);
    const bool one = shapes == 0 || known;
    // The loss goes up and down with the thickness of a film.
    const std::size_t more = problem.sum().hasColouredModel() && options.from.empty() ? 4 : 1;
    const std::size_t starts = one ? 1 : more * static_cast<std::size_t>(options.starts);
    std::vector<std::vector<double>> places =
        startsOf(problem.sum(), one ? 1 : 4 * starts, options.seed);
    for (std::vector<double>& u : places) moveTo(options.from, problem.sum(), u);
    // Starts go their ways side by side: each on few samples, which leave cores idle.
    std::vector<Minimum> candidates(places.size());
    tbb::parallel_for(std::size_t{0}, places.size(), [&](std::size_t i) {
        stopIfRequested();
        std::vector<double> best;
        Minimum& candidate = candidates[i];
        candidate.cost = problem.eliminated(places[i], false, best).cost;
        if (!linear) candidate.cost = problem.joint(withLinear(places[i], best), false).cost;
        candidate.x = std::move(places[i]);
    });
    std::ranges::stable_sort(candidates, byCost);
    candidates.resize(std::min(candidates.size(), starts));
    // Fits to measured samples and cells keep the minima that they had in earlier versions.
    const SampleOrigin origin = problem.samples().origin;
    const bool pixels = origin == SampleOrigin::pixels;
    const bool lifts = !linear && (origin == SampleOrigin::nodes || pixels);
    constexpr int most = 60;
    MinimiseOptions few{.iterations = pixels ? heatIterations : most,
                        .costTolerance = 1e-8,
                        .stepTolerance = 1e-7,
                        .curvature = false,
                        .limit = options.limit};
    const Search search(problem, linear);
    std::mutex mutex;
    std::size_t done = 0;
    tbb::parallel_for(std::size_t{0}, candidates.size(), [&](std::size_t i) {
        const std::vector<double> u = candidates[i].x;
        candidates[i] = search.fromShapes(u, few);
        if (lifts) {
            auto lifted = search.lifted(u, candidates[i], few);
            if (lifted && byCost(*lifted, candidates[i])) candidates[i] = std::move(*lifted);
        }
        const std::scoped_lock lock(mutex);
        if (options.progress) options.progress(++done, candidates.size() + 1);
    });
    if (pixels) {
        std::ranges::stable_sort(candidates, byCost);
        candidates.resize(std::min(candidates.size(), heatWinners));
        few.iterations = most - heatIterations;
        tbb::parallel_for(std::size_t{0}, candidates.size(), [&](std::size_t i) {
            if (!candidates[i].converged) candidates[i] = search.from(candidates[i], few);
        });
    }
    std::ranges::stable_sort(candidates, byCost);
    return candidates;
}

/// Relative differences of costs that searches on few samples leave undecided. Along a level
/// valley, searches on pixels end with costs up to 3e-4 apart, and each of them would be followed
/// to the same minimum.
constexpr double undecidedOfCells = 1e-4, undecidedOfPixels = 1e-3;

/// The first few that differ by more than a search leaves undecided.
std::vector<Minimum> distinct(const std::vector<Minimum>& minima, std::size_t most,
                              double difference) {
    std::vector<Minimum> chosen;
    for (const Minimum& minimum : minima) {
        if (chosen.size() >= most) break;
        if (chosen.empty() || minimum.cost > chosen.back().cost * (1 + difference))
            chosen.push_back(minimum);
    }
    return chosen;
}

/// The way of a search from few samples to all: at once; with second derivatives from the few; or
/// by a number of samples in between.
enum class Route { direct, byPart, byTwoParts };

Route routeOf(const FitSamples& samples) {
    if (samples.size() > manySamples) return Route::byTwoParts;
    // Fits to measured samples and cells keep the minima that they had in earlier versions.
    const bool nodes = samples.origin == SampleOrigin::nodes && samples.size() > 4 * coarseCount;
    return samples.fewer || nodes ? Route::byPart : Route::direct;
}

MinimiseOptions partOf(MinimiseOptions options, const FitSamples& samples) {
    options.costTolerance = samples.fewer ? 1e-7 : 1e-9;
    options.stepTolerance = 1e-8;
    return options;
}

/// Follows starts on few samples to their minima, which those samples rank to some per cent.
void rank(const FitProblem& small, bool linear, const MinimiseOptions& options, double difference,
          std::vector<Minimum>& starts) {
    for (Minimum& start : starts) start = refined(small, linear, start, options);
    std::ranges::stable_sort(starts, byCost);
    const double most = 1.05 * starts.front().cost;
    std::erase_if(starts, [&](const Minimum& start) { return start.cost > most; });
    starts = distinct(starts, starts.size(), difference);
}

/// Goes on from a minimum on fewer samples; to the end only if the cost is below `most` after the
/// first iterations.
Minimum raced(const FitProblem& fewer, const FitProblem& all, bool linear, const Minimum& start,
              const MinimiseOptions& last, double most) {
    MinimiseOptions heat = last;
    heat.iterations = std::min(heatIterations, last.iterations);
    Minimum minimum = onMore(fewer, all, linear, start, heat);
    if (minimum.converged || minimum.cost >= most || heat.iterations == last.iterations)
        return minimum;
    MinimiseOptions rest = last;
    rest.iterations -= heat.iterations;
    return onMore(fewer, all, linear, minimum, rest);
}

double medianSize(std::vector<double> residuals) {
    for (double& r : residuals) r = std::abs(r);
    const auto middle = residuals.begin() + static_cast<std::ptrdiff_t>(residuals.size() / 2);
    std::ranges::nth_element(residuals, middle);
    return *middle;
}

/// Goes to the minimum of the problem that is linear about x, within the bounds, while the cost
/// falls. Ceres stops at a relative change e of the cost, where x may still be off by root(e).
/// Throws NumericError as solveBounded does.
void settle(const FitProblem& problem, Minimum& minimum) {
    constexpr int most = 3;
    const Bounds bounds = jointBounds(problem.sum(), problem.channels());
    const std::size_t n = minimum.x.size();
    for (int step = 0; step < most; ++step) {
        const Equations about = problem.joint(minimum.x, true);
        std::vector<double> right(n);
        for (std::size_t i = 0; i < n; ++i) {
            right[i] = -about.gradient[i];
            for (std::size_t j = 0; j < n; ++j) right[i] += about.hessian[i * n + j] * minimum.x[j];
        }
        const std::vector<double> next =
            solveBounded(about.hessian, right, bounds.lower, bounds.upper);
        const double cost = problem.joint(next, false).cost;
        ++minimum.evaluations;
        if (!(cost < minimum.cost)) return;
        minimum.x = next, minimum.cost = cost;
    }
}

}  // namespace

Bounds jointBounds(const ParametricSum& sum, std::size_t channels) {
    Bounds bounds = shapeBounds(sum);
    for (const LinearParameter& linear : sum.linears())
        for (std::size_t c = 0; c < channels; ++c) {
            bounds.lower.push_back(linear.min);
            bounds.upper.push_back(linear.max);
        }
    return bounds;
}

double robustScaleOf(Robust robust, std::vector<double> residuals) {
    const double factor = robust == Robust::huber ? 1.345 : 2.385;
    return std::max(factor * 1.4826 * medianSize(std::move(residuals)), 1e-12);
}

Minimum refined(const FitProblem& problem, bool linear, const Minimum& start,
                const MinimiseOptions& options) {
    return Search(problem, linear).from(start, options);
}

Fitted searchMinimum(FitProblem& problem, const FitOptions& options) {
    const bool linear = problem.isLinear();
    const FitSamples& samples = problem.samples();
    const bool few = !samples.fewer && samples.size() <= coarseCount;
    const FitSamples coarse =
        samples.fewer ? *samples.fewer : samples.drawn(coarseCount, options.seed);
    const FitProblem small(coarse, problem.sum(), options.loss);
    const std::vector<Minimum> minima = coarseMinima(few ? problem : small, linear, options);
    const Search search(problem, linear);
    const MinimiseOptions last{
        .iterations = options.iterations, .curvature = !options.brief, .limit = options.limit};
    const Route route = routeOf(samples);
    const bool many = route == Route::byTwoParts;
    const FitSamples middle = samples.drawn(many ? middleCount : 1, options.seed);
    const FitProblem between(middle, problem.sum(), options.loss);
    const double difference = samples.fewer ? undecidedOfPixels : undecidedOfCells;
    std::vector<Minimum> starts = distinct(minima, many || options.brief ? 1 : 3, difference);
    if (route != Route::direct) rank(small, linear, partOf(last, samples), difference, starts);
    Fitted best;
    int iterations = 0, evaluations = 0;
    for (const Minimum& start : starts) {
        Minimum minimum;
        if (many)
            minimum = onMore(between, problem, linear,
                             onMore(small, between, linear, start, partOf(last, samples)), last);
        else if (route == Route::direct)
            minimum = refined(problem, linear, start, last);
        else
            minimum =
                raced(small, problem, linear, start, last,
                      (1 + difference) * (best.minimum.x.empty() ? 1e300 : best.minimum.cost));
        iterations += minimum.iterations, evaluations += minimum.evaluations;
        if (best.minimum.x.empty() || byCost(minimum, best.minimum))
            best.minimum = std::move(minimum);
    }
    if (options.robust != Robust::none) {
        best.robustScale = options.robustScale;
        if (!(best.robustScale > 0))
            best.robustScale = robustScaleOf(options.robust, problem.residuals(best.minimum.x));
        problem.setRobust(options.robust, best.robustScale);
        best.minimum = search.fromAll(best.minimum, last);
        iterations += best.minimum.iterations, evaluations += best.minimum.evaluations;
    }
    best.minimum.iterations = iterations;
    best.minimum.evaluations = evaluations;
    if (problem.whitening()) settle(problem, best.minimum);
    return best;
}

}  // namespace hshfit::brdfs
