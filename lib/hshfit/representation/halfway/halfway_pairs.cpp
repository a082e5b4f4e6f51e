#include <hshfit/representation/halfway/halfway.h>
#include <hshfit/representation/halfway/internal/halfway_kernel.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace hshfit::inline representation::inline halfway {
namespace {

/// The kernel's Legendre polynomials have the value 1 at 1; the factors that make them orthonormal
/// go into the coefficients.
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

std::uint32_t padded(std::size_t count) {
    return static_cast<std::uint32_t>((count + halfwayPadding - 1) / halfwayPadding *
                                      halfwayPadding);
}

HalfwayRunLayout runOf(const HalfwayRun& run, const HalfwayRows& rows, std::size_t value) {
    const HalfwayTerm& t = run.term;
    HalfwayRunLayout out{.first = t.lobe ? rows.x : std::uint16_t{0},
                         .length = static_cast<std::uint16_t>(run.length),
                         .factors = {},
                         .factorCount = 0,
                         .value = static_cast<std::uint32_t>(value),
                         .stored = padded(run.length)};
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

/// The place of a row of a block in the table of one pair, which has `functions` for each axis.
std::uint16_t onePlace(std::uint16_t row, const HalfwayRows& rows, std::size_t functions) {
    if (row >= rows.powers) return static_cast<std::uint16_t>(4 * functions + row - rows.powers);
    std::size_t axis = 0;
    std::uint16_t first = 0;
    for (const std::uint16_t start : {rows.x, rows.v, rows.product}) {
        if (row < start) break;
        first = start;
        ++axis;
    }
    return static_cast<std::uint16_t>(axis * functions + row - first);
}

/// The runs as the kernel of one pair takes them.
std::vector<HalfwayRunLayout> oneRunsOf(std::vector<HalfwayRunLayout> runs, std::size_t smooth,
                                        const HalfwayRows& rows, std::size_t functions) {
    for (HalfwayRunLayout& run : runs) {
        run.first = onePlace(run.first, rows, functions);
        for (std::uint16_t& factor : run.factors) factor = onePlace(factor, rows, functions);
    }
    const auto byShape = [](const HalfwayRunLayout& a, const HalfwayRunLayout& b) {
        return std::pair(a.stored, a.factorCount) < std::pair(b.stored, b.factorCount);
    };
    const auto lobe = runs.begin() + static_cast<std::ptrdiff_t>(smooth);
    std::stable_sort(runs.begin(), lobe, byShape);
    std::stable_sort(lobe, runs.end(), byShape);
    return runs;
}

/// The coefficients of a group of channels from the first on.
template <class T>
void appendGroup(const HalfwayExpansion& expansion, std::size_t firstChannel,
                 HalfwayLayout<T>& layout) {
    const HalfwayTerms& terms = expansion.terms();
    const std::size_t group = std::min<std::size_t>(3, layout.channels - firstChannel);
    const std::size_t begin = layout.values.size();
    layout.values.resize(begin + group * layout.stored);
    for (std::size_t r = 0; r < layout.runs.size(); ++r) {
        const HalfwayRunLayout& run = layout.runs[r];
        for (std::size_t i = 0; i < run.length; ++i) {
            const std::size_t t = terms.position()[terms.runs()[r].first + i];
            for (std::size_t c = 0; c < group; ++c) {
                layout.values[begin + group * run.value + c * run.stored + i] =
                    static_cast<T>(expansion.value(t, firstChannel + c) * norm(terms.list()[t]));
            }
        }
    }
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
        layout.runs.push_back(runOf(run, layout.rows, layout.stored));
        layout.stored += layout.runs.back().stored;
        layout.smoothRuns += run.term.lobe ? 0 : 1;
    }
    for (std::size_t first = 0; first < layout.channels; first += 3)
        appendGroup(expansion, first, layout);
    for (const HalfwayCeiling& ceiling : expansion.ceilings()) {
        for (const double value : {ceiling.smooth, ceiling.lobe, ceiling.top})
            layout.ceilings.push_back(static_cast<T>(value));
    }
    const HalfwayCounts& counts = terms.counts();
    const int most = std::max({counts.mean, counts.x, counts.v, counts.product});
    const std::size_t functions = (static_cast<std::size_t>(most) + 3) / 4 * 4;
    for (std::size_t n = 0; n < functions; ++n) {
        const auto degree = static_cast<T>(n);
        layout.steps.push_back((2 * degree + 1) / (degree + 1));
        layout.steps.push_back(degree / (degree + 1));
    }
    layout.oneRows = 4 * functions + layout.rows.above - layout.rows.powers;
    layout.oneRuns = oneRunsOf(layout.runs, layout.smoothRuns, layout.rows, functions);
    return layout;
}
template HalfwayLayout<float> halfwayLayoutOf(const HalfwayExpansion&);
template HalfwayLayout<double> halfwayLayoutOf(const HalfwayExpansion&);

std::unique_ptr<PairEvaluator> halfwayPairEvaluator(const Representation& representation) {
    return std::make_unique<HalfwayPairs>(representation);
}

}  // namespace hshfit::inline representation::inline halfway
