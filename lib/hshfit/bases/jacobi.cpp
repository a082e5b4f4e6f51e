#include <hshfit/bases/jacobi.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace hshfit::bases {

namespace {

using Step = kernels::Step<double>;

/// Off-diagonal b_k, k >= 1, of the Jacobi matrix for (1-t)^alpha (1+t)^beta:
/// t p_k = b_{k+1} p_{k+1} + a_k p_k + b_k p_{k-1} (Szego 1939, 4.5.1, made orthonormal).
double offDiagonal(int k, int alpha, int beta) {
    const double a = alpha, b = beta, s = a + b, n = k, d = 2 * n + s;
    // (n + s) cancels (d - 1) at n = 1, where both may vanish.
    const double last = k == 1 ? 1 : (n + s) / (d - 1);
    return 2 / d * std::sqrt(n * (n + a) * (n + b) / (d + 1) * last);
}

/// a_k of the same.
double diagonal(int k, int alpha, int beta) {
    const double a = alpha, b = beta, d = 2.0 * k + a + b;
    return k == 0 ? (b - a) / (d + 2) : (b - a) * (b + a) / (d * (d + 2));
}

/// p_{k+1} / p_k at t = 1.
double endRatio(int k, int alpha, int beta) {
    const double a = alpha, b = beta, s = a + b, n = k;
    return std::sqrt((2 * n + s + 3) / (2 * n + s + 1) * ((n + s + 1) / (n + 1)) *
                     ((n + 1 + a) / (n + 1 + b)));
}

/// `count` steps from t = 1 (end = 1) or, with the exponents exchanged, from t = -1 (end = -1).
void appendSteps(int count, int alpha, int beta, int end, std::vector<Step>& steps) {
    if (end < 0) std::swap(alpha, beta);
    double previous = 1, b = 0;
    for (int k = 0; k < count; ++k) {
        const double bNext = offDiagonal(k + 1, alpha, beta);
        const double ratio = end * endRatio(k, alpha, beta);
        steps.push_back({1 / bNext, ratio, b / (previous * bNext)});
        previous = ratio;
        b = bNext;
    }
}

/// s p_k = up p_{k+1} + level p_k + down p_{k-1} for the functions that a basis has: s = t or, for
/// the even ones alone, t^2.
struct Relation {
    double up, level, down;
};

Relation relationOf(const JacobiFamily& family, int k, int m) {
    const int alpha = family.alpha.at(m), beta = family.beta.at(m);
    const auto b = [=](int i) { return i > 0 ? offDiagonal(i, alpha, beta) : 0; };
    if (!family.evenOnly) return {b(k + 1), diagonal(k, alpha, beta), b(k)};
    const int i = 2 * k;
    const double level = b(i + 1) * b(i + 1) + b(i) * b(i);
    return {b(i + 1) * b(i + 2), level, k > 0 ? b(i) * b(i - 1) : 0};
}

kernels::Front frontOf(const JacobiFamily& family) {
    using kernels::Front;
    if (family.argument == JacobiFamily::Argument::cosine)
        return family.evenOnly ? Front::sphereSquared : Front::sphere;
    if (family.factor == JacobiFamily::Factor::chord) return Front::chord;
    return family.timesRootCosine ? Front::rootHump : Front::hump;
}

/// `starts`: c_m. The azimuth's normalisation and sign go into the first function of a column.
kernels::ShortTable<double> shortTable(const JacobiFamily& family, int step, bool condonShortley,
                                       const std::vector<double>& starts) {
    kernels::ShortTable<double> table;
    const int rows = std::min(kernels::shortOrders, static_cast<int>(starts.size()));
    for (int m = 0; m < rows; ++m) {
        const auto column = static_cast<std::size_t>(m);
        const double first =
            starts[column] * azimuthSign(m, condonShortley) / std::sqrt(m == 0 ? 2 * pi : pi);
        table.first[column] = first;
        for (int k = 0; m + (k + 1) * step < rows; ++k) {
            const Relation r = relationOf(family, k, m);
            const int l = m + (k + 1) * step;
            const double scale = k == 0 ? first : 1, last = k == 1 ? first : 1;
            table.step[static_cast<std::size_t>(l * (l + 1) / 2 + m)] = {
                scale / r.up, -scale * r.level / r.up, -last * r.down / r.up};
        }
    }
    return table;
}

kernels::ShortTable<float> rounded(const kernels::ShortTable<double>& table) {
    kernels::ShortTable<float> result;
    const auto toFloat = [](double x) { return static_cast<float>(x); };
    std::transform(table.first.begin(), table.first.end(), result.first.begin(), toFloat);
    for (std::size_t i = 0; i < table.step.size(); ++i)
        std::transform(table.step[i].begin(), table.step[i].end(), result.step[i].begin(), toFloat);
    return result;
}

}  // namespace

JacobiBasis::JacobiBasis(const JacobiFamily& family, int order, BasisOptions options)
    : Basis(order, options), family_(family) {
    assert(order > 0);
    std::size_t total = 0;
    for (int m = 0; m < order; ++m) total += static_cast<std::size_t>(functions(m) - 1);
    for (std::vector<Step>& steps : steps_) steps.reserve(total);
    double squared = family.startSquared;
    for (int m = 0; m < order; ++m) {
        if (m > 0) squared *= family.startGrowth(m);
        starts_.push_back(std::sqrt(squared));
        offsets_.push_back(steps_[0].size());
        for (const int end : {1, -1})
            appendSteps(functions(m) - 1, family.alpha.at(m), family.beta.at(m), end,
                        steps_[end < 0]);
    }
    if (order <= kernels::shortOrders) {
        short_ = shortTable(family, shortStep(), options.condonShortley, starts_);
        shortFloat_ = rounded(short_);
    }
}

bool JacobiBasis::has(int l, int m) const {
    return Basis::has(l, m) && (l - std::abs(m)) % shortStep() == 0;
}

template <class Real>
kernels::Recurrences<Real> JacobiBasis::recurrences(
    const std::array<std::vector<kernels::Step<Real>>, 2>& steps) const {
    const bool sphere = family_.argument == JacobiFamily::Argument::cosine;
    const bool chord = family_.factor == JacobiFamily::Factor::chord;
    return {
        .domain = sphere  ? kernels::Domain::sphere
                  : chord ? kernels::Domain::chord
                          : kernels::Domain::hump,
        .symmetric = family_.alpha.slope == family_.beta.slope &&
                     family_.alpha.offset == family_.beta.offset,
        .timesRootCosine = family_.timesRootCosine,
        .bandStep = family_.bandStep,
        .evenOnly = family_.evenOnly,
        .condonShortley = condonShortley(),
        .order = order(),
        .starts = starts_.data(),
        .offsets = offsets_.data(),
        .steps = {steps[0].data(), steps[1].data()},
    };
}

const std::array<std::vector<kernels::Step<float>>, 2>& JacobiBasis::floatSteps() const {
    std::call_once(floatStepsOnce_, [this] {
        for (const std::size_t side : {0u, 1u})
            for (const Step& step : steps_[side])
                floatSteps_[side].push_back({static_cast<float>(step.slope),
                                             static_cast<float>(step.ratio),
                                             static_cast<float>(step.carry)});
    });
    return floatSteps_;
}

template <class Real>
void JacobiBasis::byRows(const kernels::LazyStepRows<Real>& tables,
                         const std::array<std::vector<kernels::Step<Real>>, 2>& steps,
                         DirectionBatch directions, Real* out) const {
    std::call_once(tables.once, [&] {
        const auto columns = recurrences(steps_);
        for (const std::size_t side : {0u, 1u})
            if (side == 0 || !columns.symmetric)
                tables.rows[side] = kernels::StepRows<Real>(columns, side);
    });
    auto recurrence = recurrences(steps);
    recurrence.rows = {&tables.rows[0], &tables.rows[1]};
    kernels::tabulateLong(recurrence, directions, out);
}

void JacobiBasis::tabulate(DirectionBatch directions, Layout layout, double* out) const {
    const bool bySlot = layout == Layout::bySlot;
    if (order() <= kernels::shortOrders)
        kernels::tabulateShort(
            {frontOf(family_), shortStep(), order(), &short_, directions, bySlot, out});
    else if (bySlot && directions.count > 1)
        kernels::tabulateLongBySlot(recurrences(steps_), directions, out);
    else
        byRows(rows_, steps_, directions, out);
}

void JacobiBasis::tabulate(DirectionBatch directions, Layout layout, float* out) const {
    const bool bySlot = layout == Layout::bySlot;
    if (order() <= kernels::shortOrders)
        kernels::tabulateShort(
            {frontOf(family_), shortStep(), order(), &shortFloat_, directions, bySlot, out});
    else if (bySlot && directions.count > 1)
        kernels::tabulateLongBySlot(recurrences(floatSteps()), directions, out);
    else
        byRows(floatRows_, floatSteps_, directions, out);
}

void JacobiBasis::theta(int m, std::span<const Elevation<double>> points, double* out) const {
    assert(m >= 0 && m < order());
    kernels::theta(recurrences(steps_), m, points, out);
}

void JacobiBasis::theta(int m, std::span<const Elevation<float>> points, float* out) const {
    assert(m >= 0 && m < order());
    kernels::theta(recurrences(floatSteps()), m, points, out);
}

}  // namespace hshfit::bases
