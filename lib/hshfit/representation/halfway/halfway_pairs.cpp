#include <hshfit/representation/halfway/halfway.h>
#include <hshfit/representation/halfway/internal/halfway_kernel.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline representation::inline halfway {
namespace {

/// The kernel's Legendre polynomials are those of value 1 at 1; the factors that make them
/// orthonormal go into the coefficients.
double norm(const HalfwayTerm& t) {
    const double harmonic = t.q > 0 ? 2 : 1, third = t.lobe ? 1 : 2.0 * t.k + 1;
    return std::sqrt((2.0 * t.i + 1) * (2.0 * t.j + 1) * third * harmonic);
}

HalfwayRows rowsOf(const HalfwayTerms& terms, int powers) {
    int next = terms.counts().mean;
    const auto take = [&](int count) {
        const int first = next;
        next += count;
        return static_cast<std::uint16_t>(first);
    };
    HalfwayRows rows{};
    rows.x = take(terms.counts().x);
    rows.v = take(terms.counts().v);
    rows.product = take(terms.counts().product);
    rows.powers = take(powers);
    rows.harmonics = take(2 * terms.harmonics());
    rows.gap = take(1);
    rows.handed = take(1);
    rows.above = take(1);
    rows.weight = take(1);
    rows.count = static_cast<std::uint16_t>(next);
    return rows;
}

HalfwayRunLayout runOf(const HalfwayRun& run, const HalfwayRows& rows) {
    const HalfwayTerm& t = run.term;
    HalfwayRunLayout out{.first = t.lobe ? rows.x : std::uint16_t{0},
                         .length = static_cast<std::uint16_t>(run.length),
                         .factors = {},
                         .factorCount = 0};
    const auto times = [&](int row) {
        out.factors[out.factorCount++] = static_cast<std::uint16_t>(row);
    };
    times(rows.v + t.j);
    if (t.power() > 0) times(rows.powers + t.power() - 1);
    // The rest of a smooth term: p_0 of the product is 1.
    if (!t.lobe && t.k > 0) times(rows.product + t.k);
    if (!t.lobe && t.exchange) times(rows.gap);
    if (t.mirror) times(rows.handed);
    if (t.q > 0) times(rows.harmonics + 2 * (t.q - 1) + (t.sine ? 1 : 0));
    return out;
}

/// The place of a row of a block in the table of one pair.
std::uint16_t onePlace(std::uint16_t row, const HalfwayRows& rows, std::size_t functions) {
    if (row >= rows.powers) return static_cast<std::uint16_t>(4 * functions + row - rows.powers);
    std::uint16_t axis = 0, first = 0;
    for (const std::uint16_t start : {rows.x, rows.v, rows.product}) {
        if (row < start) break;
        first = start;
        ++axis;
    }
    return static_cast<std::uint16_t>(4 * (row - first) + axis);
}

class HalfwayPairs final : public PairEvaluator {
public:
    explicit HalfwayPairs(const Representation& r)
        : layout_(halfwayLayoutOf<float>(HalfwayExpansion(r))) {}

    void evaluate(DirectionBatch wi, DirectionBatch wo, float* out) const override {
        evaluateHalfwayPairs(layout_, wi, wo, wi.count, out);
    }

private:
    HalfwayLayout<float> layout_;
};

}  // namespace

template <class T>
HalfwayLayout<T> halfwayLayoutOf(const HalfwayExpansion& expansion) {
    const HalfwayTerms& terms = expansion.terms();
    HalfwayLayout<T> layout;
    layout.counts = terms.counts();
    layout.axes = expansion.axes().constants();
    layout.harmonics = terms.harmonics();
    layout.channels = expansion.channels();
    for (const HalfwayRun& run : terms.runs())
        layout.powers = std::max(layout.powers, run.term.power());
    layout.rows = rowsOf(terms, layout.powers);
    for (const HalfwayRun& run : terms.runs()) {
        layout.runs.push_back(runOf(run, layout.rows));
        layout.smoothRuns += run.term.lobe ? 0 : 1;
    }
    for (std::size_t first = 0; first < layout.channels; first += 3) {
        const std::size_t last = std::min(layout.channels, first + 3);
        for (const std::size_t t : terms.position()) {
            for (std::size_t c = first; c < last; ++c) {
                const double value = expansion.value(t, c) * norm(terms.list()[t]);
                layout.values.push_back(static_cast<T>(value));
            }
        }
    }
    layout.terms = terms.size();
    layout.values.resize(layout.values.size() + 3);
    for (const HalfwayCeiling& ceiling : expansion.ceilings()) {
        for (const double value : {ceiling.smooth, ceiling.lobe, ceiling.top})
            layout.ceilings.push_back(static_cast<T>(value));
    }
    const HalfwayCounts& counts = terms.counts();
    const int most = std::max({counts.mean, counts.x, counts.v, counts.product});
    for (int n = 0; n < most; ++n) {
        layout.steps.push_back(static_cast<T>((2.0 * n + 1) / (n + 1)));
        layout.steps.push_back(static_cast<T>(n / (n + 1.0)));
    }
    const auto functions = static_cast<std::size_t>(most);
    layout.oneRows = 4 * functions + layout.rows.above - layout.rows.powers;
    for (HalfwayRunLayout run : layout.runs) {
        run.first = onePlace(run.first, layout.rows, functions);
        for (std::uint16_t& factor : run.factors) factor = onePlace(factor, layout.rows, functions);
        layout.oneRuns.push_back(run);
    }
    return layout;
}
template HalfwayLayout<float> halfwayLayoutOf(const HalfwayExpansion&);
template HalfwayLayout<double> halfwayLayoutOf(const HalfwayExpansion&);

std::unique_ptr<PairEvaluator> halfwayPairEvaluator(const Representation& representation) {
    return std::make_unique<HalfwayPairs>(representation);
}

}  // namespace hshfit::inline representation::inline halfway
