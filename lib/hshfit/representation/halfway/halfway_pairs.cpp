#include <hshfit/representation/halfway/halfway.h>
#include <hshfit/representation/halfway/internal/halfway_kernel.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline representation::inline halfway {
namespace {

/// The kernel's Legendre polynomials are those of value 1 at 1; the factors that make them
/// orthonormal go into the coefficients.
double norm(const HalfwayTerm& t) {
    const double harmonic = t.q > 0 ? 2 : 1;
    return std::sqrt((2.0 * t.i + 1) * (2.0 * t.j + 1) * (2.0 * t.k + 1) * harmonic);
}

void addEnvelope(HalfwayLayout& layout, const HalfwayEnvelope& envelope) {
    if (envelope.empty()) return;
    layout.alongA = static_cast<int>(envelope.nodesAlongA());
    layout.alongB = static_cast<int>(envelope.nodesAlongB());
    layout.ridge = static_cast<float>(envelope.ridge());
    layout.reciprocal = envelope.reciprocal();
    for (const double log : envelope.logs()) layout.logs.push_back(static_cast<float>(log));
}

HalfwayLayout layoutOf(const Representation& r, const HalfwayExpansion& expansion) {
    const HalfwayTerms& terms = expansion.terms();
    const HalfwayOrders& orders = terms.orders();
    HalfwayLayout layout{.half = orders.half,
                         .difference = orders.difference,
                         .azimuth = orders.azimuth,
                         .harmonics = terms.harmonics(),
                         .turns = terms.harmonics() > 0,
                         .channels = r.head.channels.count(),
                         .runs = {},
                         .values = {},
                         .logs = {},
                         .steps = {}};
    addEnvelope(layout, expansion.envelope());
    for (const HalfwayRun& run : terms.runs()) {
        const HalfwayTerm& t = run.term;
        layout.runs.push_back({static_cast<std::uint16_t>(t.j), static_cast<std::uint16_t>(t.k),
                               static_cast<std::uint16_t>(t.q),
                               static_cast<std::uint16_t>(run.length), t.exchange, t.mirror,
                               t.sine});
    }
    const std::vector<double>& values = std::get<HalfwayArray>(r.content).halfway.values;
    for (std::size_t first = 0; first < layout.channels; first += 3) {
        const std::size_t last = std::min(layout.channels, first + 3);
        for (const std::size_t t : terms.position()) {
            for (std::size_t c = first; c < last; ++c) {
                const double value = values[c * terms.size() + t] * norm(terms.list()[t]);
                layout.values.push_back(static_cast<float>(value));
            }
        }
    }
    const int most = std::max({orders.half, orders.difference, orders.azimuth});
    for (int n = 0; n < most; ++n) {
        layout.steps.push_back(static_cast<float>((2.0 * n + 1) / (n + 1)));
        layout.steps.push_back(static_cast<float>(n / (n + 1.0)));
    }
    return layout;
}

class HalfwayPairs final : public PairEvaluator {
public:
    explicit HalfwayPairs(const Representation& r) : layout_(layoutOf(r, HalfwayExpansion(r))) {}

    void evaluate(DirectionBatch wi, DirectionBatch wo, float* out) const override {
        evaluateHalfwayPairs(layout_, wi, wo, wi.count, out);
    }

private:
    HalfwayLayout layout_;
};

}  // namespace

std::unique_ptr<PairEvaluator> halfwayPairEvaluator(const Representation& representation) {
    return std::make_unique<HalfwayPairs>(representation);
}

}  // namespace hshfit::inline representation::inline halfway
