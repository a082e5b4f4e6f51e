#include <brdfs/fit/dispersed_profile.h>

#include <brdfs/fit/dense.h>
#include <brdfs/fit/minimum_study.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hshfit::brdfs {
namespace {

/// A problem in coefficients of which one, the pivot, is replaced by a reported value of its curve.
class Exchanged {
public:
    Exchanged(const DispersedProblem& problem, const std::vector<double>& x, std::size_t curve,
              std::size_t reported)
        : problem_(problem),
          curve_(problem.model().curve(curve)),
          first_(problem.model().first(curve)),
          reported_(reported) {
        const Row row = rowAt(x);
        // Coefficients differ in what they may change: the share of the box counts.
        double most = -1;
        for (std::size_t k = 0; k < curve_.count(); ++k) {
            const double reach = std::abs(row.slopes[k]) * (curve_.upper()[k] - curve_.lower()[k]);
            if (!(reach > most)) continue;
            most = reach;
            own_ = k;
        }
        pivot_ = first_ + own_;
        exchanged_ = x;
        exchanged_[pivot_] = row.value;
        guess_ = x[pivot_];
    }

    std::size_t pivot() const { return pivot_; }
    const std::vector<double>& x() const { return exchanged_; }

    /// Bounds of the exchanged variables: the reported value has none of its own.
    Bounds bounds() const {
        Bounds bounds{problem_.model().lower(), problem_.model().upper()};
        bounds.lower[pivot_] = -std::numeric_limits<double>::max();
        bounds.upper[pivot_] = std::numeric_limits<double>::max();
        return bounds;
    }

    Equations joint(std::span<const double> exchanged, bool derivatives) const {
        std::vector<double> x(exchanged.begin(), exchanged.end());
        Equations equations;
        equations.cost = std::numeric_limits<double>::infinity();
        if (!solve(exchanged[pivot_], x)) return equations;
        equations = problem_.joint(x, derivatives);
        if (!derivatives) return equations;
        const Row row = rowAt(x);
        const std::size_t n = x.size();
        Matrix change = Matrix::Identity(at(n), at(n));  // of x by the exchanged variables
        for (std::size_t k = 0; k < curve_.count(); ++k)
            change(at(pivot_), at(first_ + k)) = -row.slopes[k] / row.slopes[own_];
        change(at(pivot_), at(pivot_)) = 1 / row.slopes[own_];
        const Vector gradient =
            change.transpose() * Eigen::Map<const Vector>(equations.gradient.data(), at(n));
        const Matrix hessian = change.transpose() *
                               Eigen::Map<const Matrix>(equations.hessian.data(), at(n), at(n)) *
                               change;
        equations.gradient.assign(gradient.data(), gradient.data() + n);
        equations.hessian.assign(hessian.data(), hessian.data() + n * n);
        return equations;
    }

private:
    /// The reported value, and its derivatives by the coefficients of the curve.
    struct Row {
        double value;
        std::vector<double> slopes;
    };
    Row rowAt(const std::vector<double>& x) const {
        const std::size_t count = curve_.count();
        const LawCurve::Reported all = curve_.reported({x.data() + first_, count});
        const auto begin = all.slopes.begin() + at(reported_ * count);
        return {all.values[reported_], {begin, begin + at(count)}};
    }
    /// The pivot at which the reported value is as stated; false where it would leave its bounds.
    bool solve(double value, std::vector<double>& x) const {
        constexpr int most = 50;
        const double lower = curve_.lower()[own_], upper = curve_.upper()[own_];
        const double reach = 1e-12 * (upper - lower);
        x[pivot_] = guess_;
        for (int k = 0; k < most; ++k) {
            const Row row = rowAt(x);
            const double step = (value - row.value) / row.slopes[own_];
            if (!std::isfinite(step)) return false;
            const double next = std::clamp(x[pivot_] + step, lower, upper);
            // Twice at the same bound: the value lies beyond it.
            if (next == x[pivot_] && std::abs(step) > reach) return false;
            x[pivot_] = next;
            if (std::abs(step) <= reach) return true;
        }
        return false;
    }

    const DispersedProblem& problem_;
    const LawCurve& curve_;
    std::size_t first_, reported_, own_ = 0, pivot_ = 0;
    std::vector<double> exchanged_;
    double guess_ = 0;
};

}  // namespace

void addProfiles(const DispersedProblem& problem, const std::vector<double>& x,
                 const std::vector<bool>& fixed, const UncertaintyOptions& options,
                 Uncertainty& study) {
    const DispersedModel& model = problem.model();
    const ParametricSum& sum = model.sum(0);
    for (std::size_t i = 0; i < model.parameterCount(); ++i)
        for (std::size_t k = 0; k < model.curve(i).count(); ++k) {
            const std::size_t place = model.first(i) + k;
            if (options.progress) options.progress(place, x.size());
            ParameterUncertainty& own = study.parameters[place];
            if (!own.normal || !(*own.normal > 0)) continue;
            const Exchanged exchanged(problem, x, i, k);
            // A coefficient that a bound holds stays there in the quadratic picture alone.
            std::vector<bool> held = fixed;
            held[exchanged.pivot()] = false;
            const bool scaled = i < sum.shapes().size() && !model.ofIndex(i);
            const auto valueOf = [&](std::size_t, double value) {
                return scaled ? sum.shapes()[i].toValue(value) : value;
            };
            std::vector<double> slope(x.size(), 1);
            const double value = exchanged.x()[exchanged.pivot()];
            if (scaled) slope[exchanged.pivot()] = sum.shapes()[i].slope(valueOf(0, value));
            own.profile = profileOf(
                {.joint = [&](std::span<const double> other,
                              bool derivatives) { return exchanged.joint(other, derivatives); },
                 .bounds = exchanged.bounds(),
                 .normalisation = problem.normalisation(),
                 .valueOf = valueOf,
                 .x = exchanged.x(),
                 .equations = exchanged.joint(exchanged.x(), true),
                 .fixed = held,
                 .slope = slope,
                 .constrained = true},
                exchanged.pivot(), *own.normal, study);
        }
    if (options.progress) options.progress(x.size(), x.size());
}

}  // namespace hshfit::brdfs
