#include <brdfs/fit/distributions.h>
#include <brdfs/fit/minimum_study.h>
#include <hshfit/error.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hshfit::brdfs {
namespace {

/// The least chi-square with one parameter held, in roots of its excess over the minimum.
class ProfileOf {
public:
    ProfileOf(const ProfiledProblem& problem, std::size_t parameter, double lowest)
        : problem_(problem),
          parameter_(parameter),
          lowest_(lowest),
          bounds_(problem.bounds),
          direction_(directionOf(problem, parameter)) {}

    double lower() const { return bounds_.lower[parameter_]; }
    double upper() const { return bounds_.upper[parameter_]; }

    double rootAt(double held) const {
        std::vector<double> start = problem_.x;
        const double step = held - problem_.x[parameter_];
        for (std::size_t j = 0; j < start.size(); ++j)
            start[j] =
                std::clamp(start[j] + step * direction_[j], bounds_.lower[j], bounds_.upper[j]);
        const auto equations = [&](std::span<const double> others, bool derivatives) {
            std::vector<double> x(others.begin(), others.end());
            x.insert(x.begin() + static_cast<std::ptrdiff_t>(parameter_), held);
            return ofOthers(problem_.joint(x, derivatives), derivatives);
        };
        const Minimum found =
            minimise(equations, withoutParameter(start), withoutParameter(bounds_.lower),
                     withoutParameter(bounds_.upper), {.iterations = 50});
        const double excess = 2 * problem_.normalisation * found.cost - lowest_;
        if (problem_.constrained && (!std::isfinite(excess) || found.cost < 0))
            return std::numeric_limits<double>::infinity();
        if (!std::isfinite(excess) || found.cost < 0)
            throw NumericError("profile likelihood: the cost is not finite beside the minimum");
        return std::sqrt(std::max(0.0, excess));
    }

    /// The value beyond the minimum at which the root reaches `level`, by false position from the
    /// quadratic guess; none where the bound, or the end of what is feasible, comes first.
    std::optional<double> crossing(double level, double guess) const {
        const double from = problem_.x[parameter_];
        const double end = guess < from ? lower() : upper();
        double inner = from, innerRoot = 0;
        double outer = guess < from ? std::max(guess, end) : std::min(guess, end);
        double outerRoot = rootAt(outer);
        constexpr int most = 40;
        for (int k = 0; outerRoot < level; ++k) {
            if (outer == end || k == most) return std::nullopt;
            inner = outer, innerRoot = outerRoot;
            outer = from + 1.6 * (outer - from);
            outer = guess < from ? std::max(outer, end) : std::min(outer, end);
            outerRoot = rootAt(outer);
        }
        constexpr double close = 1e-4;
        double at = outer;
        for (int k = 0; k < most; ++k) {
            const double share =
                std::clamp((level - innerRoot) / (outerRoot - innerRoot), 0.05, 0.95);
            at = outerRoot - level < close * level ? outer : inner + share * (outer - inner);
            if (at == outer) break;
            const double root = rootAt(at);
            if (std::abs(root - level) < close * level) break;
            (root < level ? inner : outer) = at;
            (root < level ? innerRoot : outerRoot) = root;
        }
        if (!std::isfinite(outerRoot)) return std::nullopt;
        return at;
    }

private:
    std::vector<double> withoutParameter(std::vector<double> all) const {
        all.erase(all.begin() + static_cast<std::ptrdiff_t>(parameter_));
        return all;
    }
    /// The equations of the other parameters.
    Equations ofOthers(Equations all, bool derivatives) const {
        if (!derivatives || all.gradient.empty()) return all;
        const std::size_t n = all.gradient.size();
        Equations result;
        result.cost = all.cost;
        result.gradient = withoutParameter(std::move(all.gradient));
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t j = 0; j < n; ++j)
                if (i != parameter_ && j != parameter_)
                    result.hessian.push_back(all.hessian[i * n + j]);
        return result;
    }
    /// The way of the other parameters in the quadratic picture, per unit of this one.
    static std::vector<double> directionOf(const ProfiledProblem& problem, std::size_t parameter) {
        const std::size_t n = problem.x.size();
        const std::vector<double> inverse = inverseOf(problem.equations, problem.fixed);
        std::vector<double> direction(n, 0);
        for (std::size_t j = 0; j < n; ++j)
            direction[j] = inverse[parameter * n + j] / inverse[parameter * n + parameter];
        return direction;
    }

    const ProfiledProblem& problem_;
    std::size_t parameter_;
    double lowest_;
    Bounds bounds_;
    std::vector<double> direction_;
};

}  // namespace

ParameterUncertainty::Profile profileOf(const ProfiledProblem& problem, std::size_t i,
                                        double normal, const Uncertainty& study) {
    const double scale = study.stated ? 1 : study.reducedChiSquare();
    const double degrees = study.stated ? std::numeric_limits<double>::infinity()
                                        : static_cast<double>(study.degreesOfFreedom);
    const double outside = std::erfc(std::sqrt(0.5));  // of one standard deviation
    const double levels[] = {studentBound(outside, degrees), studentBound(0.05, degrees)};
    const ProfileOf profile(problem, i, study.chiSquare);
    const double error = normal / problem.slope[i], value = problem.valueOf(i, problem.x[i]);
    ParameterUncertainty::Profile found;
    for (std::size_t k = 0; k < 2; ++k) {
        Interval& interval = k == 0 ? found.within68 : found.within95;
        for (const double side : {-1.0, 1.0}) {
            const auto end = profile.crossing(levels[k] * std::sqrt(scale),
                                              problem.x[i] + side * levels[k] * error);
            std::optional<double>& to = side < 0 ? interval.low : interval.high;
            if (end) to = problem.valueOf(i, *end);
            constexpr double agreement = 0.1;
            const double expected = levels[k] * normal;
            if (!end || std::abs(std::abs(*to - value) - expected) > agreement * expected)
                found.quadratic = false;
        }
    }
    return found;
}

void addProfiles(const ProfiledProblem& problem, const UncertaintyOptions& options,
                 Uncertainty& result) {
    const std::size_t n = problem.x.size();
    for (std::size_t i = 0; i < n; ++i) {
        if (options.progress) options.progress(i, n);
        ParameterUncertainty& own = result.parameters[i];
        if (own.normal && *own.normal > 0) own.profile = profileOf(problem, i, *own.normal, result);
    }
    if (options.progress) options.progress(n, n);
}

void addProfiles(const StudiedMinimum& minimum, const UncertaintyOptions& options,
                 Uncertainty& result) {
    const FitProblem& problem = minimum.problem;
    const auto joint = [&](std::span<const double> x, bool derivatives) {
        return problem.joint(x, derivatives);
    };
    const auto valueOf = [&](std::size_t i, double x) {
        return i < problem.shapeCount() ? problem.sum().shapes()[i].toValue(x) : x;
    };
    addProfiles({.joint = joint,
                 .bounds = jointBounds(problem.sum(), problem.channels()),
                 .normalisation = problem.normalisation(),
                 .valueOf = valueOf,
                 .x = minimum.x,
                 .equations = minimum.equations,
                 .fixed = minimum.fixed,
                 .slope = minimum.slope},
                options, result);
}

}  // namespace hshfit::brdfs
