#include <brdfs/fit/fit.h>

#include <brdfs/fit/covariance.h>
#include <brdfs/fit/minimise.h>
#include <brdfs/fit/normal_equations.h>
#include <brdfs/fit/parametric_sum.h>
#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace hshfit::brdfs {
namespace {

constexpr std::size_t coarseCount = 4096;
/// Above this number of samples, a second and third search on all costs more than it finds.
constexpr std::size_t manySamples = 200'000, middleCount = 50'000;

struct Bounds {
    std::vector<double> lower, upper;
};

Bounds shapeBounds(const ParametricSum& sum) {
    Bounds bounds;
    for (const ShapeParameter& shape : sum.shapes()) {
        bounds.lower.push_back(shape.lower());
        bounds.upper.push_back(shape.upper());
    }
    return bounds;
}

Bounds jointBounds(const ParametricSum& sum, std::size_t channels) {
    Bounds bounds = shapeBounds(sum);
    for (const LinearParameter& linear : sum.linears())
        for (std::size_t c = 0; c < channels; ++c) {
            bounds.lower.push_back(linear.min);
            bounds.upper.push_back(linear.max);
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
std::vector<double> joined(std::vector<double> u, const std::vector<double>& linear) {
    u.insert(u.end(), linear.begin(), linear.end());
    return u;
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

    /// From shapes: eliminated if that is the loss itself, else jointly, from the linear parameters
    /// that elimination gives and from those at its minimum, whichever leads further.
    Minimum fromShapes(const std::vector<double>& u, const MinimiseOptions& options) const {
        Minimum minimum = eliminated(u, options);
        if (linear_) return minimum;
        minimum = fromAll(minimum, options);
        Minimum direct;
        std::vector<double> best;
        problem_.eliminated(u, false, best);
        direct.x = joined(u, best);
        direct = fromAll(direct, options);
        return byCost(direct, minimum) ? direct : minimum;
    }

    Minimum eliminated(const std::vector<double>& u, const MinimiseOptions& options) const {
        std::vector<double> linear;
        Minimum minimum =
            minimise([&](std::span<const double> at,
                         bool derivatives) { return problem_.eliminated(at, derivatives, linear); },
                     u, shapes_.lower, shapes_.upper, options);
        problem_.eliminated(minimum.x, false, linear);
        minimum.x = joined(std::move(minimum.x), linear);
        return minimum;
    }

    Minimum fromAll(const Minimum& start, const MinimiseOptions& options) const {
        Minimum minimum =
            minimise([&](std::span<const double> at,
                         bool derivatives) { return problem_.joint(at, derivatives); },
                     start.x, joint_.lower, joint_.upper, options);
        minimum.iterations += start.iterations;
        minimum.evaluations += start.evaluations;
        return minimum;
    }

private:
    const FitProblem& problem_;
    bool linear_;
    Bounds shapes_, joint_;
};

/// Minima of the problem on few samples, from the best of many starts, best first.
std::vector<Minimum> coarseMinima(const FitProblem& problem, bool linear,
                                  const FitOptions& options) {
    const std::size_t shapes = problem.shapeCount();
    const std::size_t starts = shapes == 0 ? 1 : static_cast<std::size_t>(options.starts);
    std::vector<Minimum> candidates;
    for (std::vector<double>& u :
         startsOf(problem.sum(), shapes == 0 ? 1 : 4 * starts, options.seed)) {
        std::vector<double> best;
        Minimum candidate;
        candidate.cost = problem.eliminated(u, false, best).cost;
        if (!linear) candidate.cost = problem.joint(joined(u, best), false).cost;
        candidate.x = std::move(u);
        candidates.push_back(std::move(candidate));
    }
    std::ranges::stable_sort(candidates, byCost);
    candidates.resize(std::min(candidates.size(), starts));
    const Search search(problem, linear);
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        candidates[i] = search.fromShapes(
            candidates[i].x,
            {.iterations = 60, .costTolerance = 1e-8, .stepTolerance = 1e-7, .curvature = false});
        if (options.progress) options.progress(i + 1, candidates.size() + 1);
    }
    std::ranges::stable_sort(candidates, byCost);
    return candidates;
}

/// The first few that differ by more than a search leaves undecided.
std::vector<Minimum> distinct(const std::vector<Minimum>& minima, std::size_t most) {
    std::vector<Minimum> chosen;
    for (const Minimum& minimum : minima) {
        if (chosen.size() >= most) break;
        if (chosen.empty() || minimum.cost > chosen.back().cost * (1 + 1e-4))
            chosen.push_back(minimum);
    }
    return chosen;
}

double medianSize(std::vector<double> residuals) {
    for (double& r : residuals) r = std::abs(r);
    const auto middle = residuals.begin() + static_cast<std::ptrdiff_t>(residuals.size() / 2);
    std::ranges::nth_element(residuals, middle);
    return *middle;
}

/// A search that goes on from another one's minimum.
Minimum refined(const FitProblem& problem, bool linear, const Minimum& start,
                const MinimiseOptions& options) {
    const Search search(problem, linear);
    if (!linear) return search.fromAll(start, options);
    const auto shapes = static_cast<std::ptrdiff_t>(problem.shapeCount());
    return search.eliminated({start.x.begin(), start.x.begin() + shapes}, options);
}

struct Fitted {
    Minimum minimum;
    double robustScale = 0;
};

Fitted search(FitProblem& problem, const FitOptions& options) {
    const bool linear = options.loss == Loss::Kind::l2 || options.loss == Loss::Kind::cosine;
    const FitSamples& samples = problem.samples();
    const bool few = samples.size() <= coarseCount;
    const FitSamples coarse = samples.drawn(coarseCount, options.seed);
    const FitProblem small(coarse, problem.sum(), options.loss);
    const std::vector<Minimum> minima = coarseMinima(few ? problem : small, linear, options);
    const Search search(problem, linear);
    const MinimiseOptions last{.iterations = options.iterations};
    Fitted best;
    int iterations = 0, evaluations = 0;
    const bool many = samples.size() > manySamples;
    const FitSamples middle = samples.drawn(many ? middleCount : 1, options.seed);
    const FitProblem between(middle, problem.sum(), options.loss);
    for (Minimum start : distinct(minima, many ? 1 : 3)) {
        if (many)
            start = refined(between, linear, start, {.costTolerance = 1e-9, .stepTolerance = 1e-8});
        Minimum minimum = refined(problem, linear, start, last);
        iterations += minimum.iterations, evaluations += minimum.evaluations;
        if (best.minimum.x.empty() || byCost(minimum, best.minimum))
            best.minimum = std::move(minimum);
    }
    if (options.robust != Robust::none) {
        best.robustScale = options.robustScale;
        if (!(best.robustScale > 0)) {
            const double factor = options.robust == Robust::huber ? 1.345 : 2.385;
            best.robustScale =
                std::max(factor * 1.4826 * medianSize(problem.residuals(best.minimum.x)), 1e-12);
        }
        problem.setRobust(options.robust, best.robustScale);
        best.minimum = search.fromAll(best.minimum, last);
        iterations += best.minimum.iterations, evaluations += best.minimum.evaluations;
    }
    best.minimum.iterations = iterations;
    best.minimum.evaluations = evaluations;
    return best;
}

/// A fit of channels that share their shapes.
struct Part {
    FitResult result;  ///< without spec
    std::vector<double> shapes, linear;
    double squares = 0, weights = 0;
};

/// Shapes of what a linear parameter scales are not determined where that is not told from 0, and
/// errors by derivatives mean nothing there, its own included (Davies 1977,
/// 10.1093/biomet/64.2.247).
void reportUnseenLobes(const FitProblem& problem, const std::vector<double>& x,
                       const Equations& equations, const std::vector<bool>& fixed,
                       Covariance& covariance) {
    const std::size_t shapes = problem.shapeCount(), channels = problem.channels(), n = x.size();
    for (std::size_t first = shapes; first < n; first += channels) {
        std::vector<std::size_t> concerned;
        std::vector<double> without = x;
        bool seen = false;
        for (std::size_t i = first; i < first + channels; ++i) {
            without[i] = 0;
            if (fixed[i]) {
                seen = seen || x[i] > 0;
                continue;
            }
            seen =
                seen || covariance.variance[i] < 0 || x[i] > 2 * std::sqrt(covariance.variance[i]);
            concerned.push_back(i);
        }
        if (seen || shapes == 0) continue;
        const Equations rest = problem.joint(without, true);
        const std::size_t linears = concerned.size();
        for (std::size_t j = 0; j < shapes; ++j)
            if (!fixed[j] && covariance.variance[j] >= 0 &&
                rest.hessian[j * n + j] <= 1e-12 * equations.hessian[j * n + j])
                concerned.push_back(j);
        if (concerned.size() == linears) continue;
        for (const std::size_t i : concerned) {
            covariance.variance[i] = -1;
            for (std::size_t j = 0; j < n; ++j)
                covariance.correlations[i * n + j] = covariance.correlations[j * n + i] = 0;
        }
        covariance.ambiguous.push_back(std::move(concerned));
    }
}

void describe(const FitProblem& problem, const std::vector<double>& x, Part& part) {
    const ParametricSum& sum = problem.sum();
    const std::size_t shapes = problem.shapeCount(), channels = problem.channels();
    const Bounds bounds = jointBounds(sum, channels);
    Equations equations = problem.joint(x, true);
    std::vector<bool> fixed;
    std::vector<double> slope;  // of the value by x
    std::vector<FittedParameter>& parameters = part.result.parameters;
    const std::vector<std::string> names = problem.samples().channels.names();
    for (std::size_t i = 0; i < x.size(); ++i) {
        const double reach = 1e-9 * (1 + std::abs(x[i]));
        FittedParameter parameter;
        // Resting at a bound, and not a minimum that happens to lie there.
        const double pull = equations.gradient[i];
        if (x[i] <= bounds.lower[i] + reach && pull >= 0) parameter.bound = "lower";
        if (x[i] >= bounds.upper[i] - reach && pull <= 0) parameter.bound = "upper";
        // Without a pull worth the name it could as well leave the bound: what the data say of it
        // is then for the covariance to tell.
        const double scale = std::sqrt(std::max(equations.hessian[i * x.size() + i], 0.0));
        const double negligible = 1e-6 * std::sqrt(2 * equations.cost) + 1e-12;
        fixed.push_back(!parameter.bound.empty() && std::abs(pull) > negligible * scale);
        if (i < shapes) {
            const ShapeParameter& shape = sum.shapes()[i];
            parameter.name = shape.name;
            parameter.value = shape.toValue(x[i]);
            slope.push_back(shape.slope(parameter.value));
            part.shapes.push_back(parameter.value);
        } else {
            const std::size_t k = (i - shapes) / channels, c = (i - shapes) % channels;
            parameter.name = sum.linears()[k].name;
            parameter.channel = names.size() > 1 ? names[c] : "";
            parameter.value = x[i];
            parameter.linear = true;
            slope.push_back(1);
            part.linear.push_back(x[i]);
        }
        if (!fixed[i] && scale > 0)
            part.result.projectedGradient =
                std::max(part.result.projectedGradient, std::abs(pull) / scale);
        parameters.push_back(std::move(parameter));
    }
    equations.spread = problem.joint(x, true, inverseOf(equations, fixed)).spread;
    Covariance covariance = covarianceOf(equations, fixed);
    reportUnseenLobes(problem, x, equations, fixed, covariance);
    for (std::size_t i = 0; i < x.size(); ++i)
        if (covariance.variance[i] >= 0)
            parameters[i].standardError = std::sqrt(covariance.variance[i]) * slope[i];
    part.result.correlations = covariance.correlations;
    for (const auto& set : covariance.ambiguous) {
        part.result.ambiguous.emplace_back();
        for (const std::size_t i : set)
            part.result.ambiguous.back().push_back(
                parameters[i].channel.empty()
                    ? parameters[i].name
                    : fmt::format("{} {}", parameters[i].name, parameters[i].channel));
    }
}

Part fitShared(const FitSamples& samples, const ParametricSum& sum, const FitOptions& options) {
    FitProblem problem(samples, sum, options.loss);
    const std::size_t parameters = problem.shapeCount() + problem.linearCount();
    const std::size_t values = samples.size() * problem.channels();
    if (values < parameters)
        throw NumericError(
            fmt::format("'{}': {} values cannot determine {} free parameters; give some of them, "
                        "or more samples",
                        sum.spec(), values, parameters));
    const Fitted fitted = search(problem, options);
    Part part;
    describe(problem, fitted.minimum.x, part);
    FitResult& result = part.result;
    result.converged = fitted.minimum.converged;
    result.message = fitted.minimum.message;
    result.iterations = fitted.minimum.iterations;
    result.evaluations = fitted.minimum.evaluations;
    result.robustScale = fitted.robustScale;
    const std::vector<double> residuals = problem.residuals(fitted.minimum.x);
    for (std::size_t k = 0; k < residuals.size(); ++k) {
        const double weight = samples.weights[k % samples.size()];
        part.squares += weight * residuals[k] * residuals[k];
        part.weights += weight;
    }
    return part;
}

/// Puts the fits of single channels together.
FitResult merged(std::vector<Part>& parts, const std::vector<std::string>& names) {
    FitResult result;
    result.converged = true;
    std::size_t n = 0;
    for (const Part& part : parts) n += part.result.parameters.size();
    result.correlations.assign(n * n, 0);
    std::size_t first = 0;
    for (std::size_t c = 0; c < parts.size(); ++c) {
        FitResult& own = parts[c].result;
        const std::size_t count = own.parameters.size();
        for (FittedParameter& parameter : own.parameters) {
            if (parts.size() > 1) parameter.channel = names[c];
            result.parameters.push_back(parameter);
        }
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t j = 0; j < count; ++j)
                result.correlations[(first + i) * n + first + j] = own.correlations[i * count + j];
        for (auto& set : own.ambiguous) {
            if (parts.size() > 1)
                for (std::string& name : set) name += " " + names[c];
            result.ambiguous.push_back(set);
        }
        if (result.converged) result.message = own.message;
        result.converged = result.converged && own.converged;
        result.iterations += own.iterations;
        result.evaluations += own.evaluations;
        result.projectedGradient = std::max(result.projectedGradient, own.projectedGradient);
        result.robustScale = std::max(result.robustScale, own.robustScale);
        first += count;
    }
    return result;
}

}  // namespace

FitResult fit(const FitSamples& samples, const FitOptions& options) {
    const ParametricSum sum(options.model, samples.isotropic);
    const std::size_t channels = samples.channels.count();
    const bool apart = options.perChannel && channels > 1;
    std::vector<Part> parts;
    for (std::size_t c = 0; c < (apart ? channels : 1); ++c)
        parts.push_back(fitShared(apart ? samples.channel(c) : samples, sum, options));
    FitResult result = merged(parts, samples.channels.names());

    std::vector<std::vector<double>> shapes;
    for (const Part& part : parts) shapes.push_back(part.shapes);
    std::vector<double> linear = parts.front().linear;
    if (apart) {
        linear.assign(sum.linears().size() * channels, 0);
        for (std::size_t k = 0; k < sum.linears().size(); ++k)
            for (std::size_t c = 0; c < channels; ++c)
                linear[k * channels + c] = parts[c].linear[k];
    }
    result.model = sum.spec();
    result.spec = sum.filledIn(shapes, linear, channels);
    result.startCount = options.starts;
    result.seed = options.seed;
    result.samples = samples.size();
    result.values = samples.size() * channels;
    double squares = 0, weights = 0;
    for (const Part& part : parts) squares += part.squares, weights += part.weights;
    result.loss = std::sqrt(squares / weights);
    // The variance of the residuals is a parameter, too.
    const double count = static_cast<double>(result.values),
                 parameters = static_cast<double>(result.parameters.size() + 1);
    const double likelihood = count * std::log(std::max(squares / weights, 1e-300));
    result.aic = likelihood + 2 * parameters;
    result.bic = likelihood + parameters * std::log(count);
    return result;
}

std::vector<double> valuesOf(const Brdf& brdf, const FitSamples& samples) {
    const std::size_t count = samples.size(), channels = samples.channels.count();
    const std::size_t own = brdf.channels().count();
    std::vector<double> values(count * channels), buffer(own);
    for (std::size_t k = 0; k < count; ++k) {
        brdf.eval(samples.wo[k], {&samples.wiX[k], &samples.wiY[k], &samples.wiZ[k], 1},
                  buffer.data());
        for (std::size_t c = 0; c < channels; ++c) values[c * count + k] = buffer[own == 1 ? 0 : c];
    }
    return values;
}

double lossOf(const Brdf& brdf, const FitSamples& samples, Loss::Kind loss) {
    const std::vector<double> values = valuesOf(brdf, samples);
    double squares = 0, weights = 0;
    for (std::size_t c = 0; c < samples.channels.count(); ++c)
        for (std::size_t k = 0; k < samples.size(); ++k) {
            const double r = mapValue(loss, values[c * samples.size() + k], samples.wiZ[k]).value -
                             mapValue(loss, samples.value(c, k), samples.wiZ[k]).value;
            squares += samples.weights[k] * r * r;
            weights += samples.weights[k];
        }
    return std::sqrt(squares / weights);
}

}  // namespace hshfit::brdfs
