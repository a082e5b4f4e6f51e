#include <hshfit/theta_products.h>

#include <hshfit/ring_kernels.h>

#include <tbb/concurrent_unordered_map.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>

namespace hshfit {
namespace {

/// Doubles kept of one panel, and of all.
constexpr std::size_t mostOfPanel = std::size_t{1} << 19, mostOfAll = std::size_t{1} << 23;

struct Key {
    double a, b;
    std::size_t rings;
    bool operator==(const Key&) const = default;
};

struct KeyHash {
    std::size_t operator()(const Key& key) const {
        std::uint64_t hash = std::bit_cast<std::uint64_t>(key.a) * 0x9e3779b97f4a7c15u;
        hash = (hash ^ std::bit_cast<std::uint64_t>(key.b)) * 0x9e3779b97f4a7c15u;
        hash ^= hash >> 29;
        return static_cast<std::size_t>((hash + key.rings) * 0x9e3779b97f4a7c15u >> 16);
    }
};

/// Panels from halving have such ends; those at kinks hardly ever recur.
bool isDyadic(double u) {
    constexpr double finest = 1 << 24;
    return u * finest == std::floor(u * finest);
}

/// Theta functions of one m, l = m .. order-1, times the weights of the rings and what the inner
/// product adds to them: [l - m][ring].
void weightedTheta(const Basis& basis, int m, const HemisphereGrid& grid,
                   const HemisphereGrid::Panel& panel, double* out) {
    const std::span<const Elevation<double>> points(grid.elevations.data() + panel.firstRing,
                                                    panel.rings);
    basis.analysisTheta(m, points, out);
    const bool projected = basis.inner() == Basis::Inner::projectedSolidAngle;
    for (std::size_t r = 0; r < panel.rings; ++r) {
        const double weight = grid.weights[panel.firstRing + r] * (projected ? points[r].mu : 1.0);
        for (int l = m; l < basis.order(); ++l) out[(l - m) * panel.rings + r] *= weight;
    }
}

}  // namespace

struct ThetaProducts::Kept {
    tbb::concurrent_unordered_map<Key, std::unique_ptr<std::vector<double>>, KeyHash> tables;
    std::atomic<std::size_t> values = 0;

    /// None where there is no room.
    const std::vector<double>* find(const ThetaProducts& products, const HemisphereGrid& grid,
                                    const HemisphereGrid::Panel& panel, double a, double b);
};

const std::vector<double>* ThetaProducts::Kept::find(const ThetaProducts& products,
                                                     const HemisphereGrid& grid,
                                                     const HemisphereGrid::Panel& panel, double a,
                                                     double b) {
    const std::size_t size = products.pairs_ * panel.rings;
    if (size > mostOfPanel || !isDyadic(a) || !isDyadic(b)) return nullptr;
    const Key key{a, b, panel.rings};
    if (const auto found = tables.find(key); found != tables.end()) return found->second.get();
    if (values.load(std::memory_order_relaxed) + size > mostOfAll) return nullptr;
    auto table = std::make_unique<std::vector<double>>(size);
    double* to = table->data();
    for (const Basis* basis : products.bases_) {
        for (int m = 0; m < basis->order(); ++m) {
            weightedTheta(*basis, m, grid, panel, to);
            to += static_cast<std::size_t>(basis->order() - m) * panel.rings;
        }
    }
    const auto [place, isNew] = tables.emplace(key, std::move(table));
    if (isNew) values += size;
    return place->second.get();
}

ThetaProducts::ThetaProducts(std::span<const Basis* const> bases)
    : bases_(bases.begin(), bases.end()), kept_(std::make_unique<Kept>()) {
    for (const Basis* basis : bases_) {
        pairs_ += static_cast<std::size_t>(basis->order()) * (basis->order() + 1) / 2;
    }
}

ThetaProducts::~ThetaProducts() = default;

void ThetaProducts::moments(const HemisphereGrid& grid, std::size_t panelIndex, double a, double b,
                            const RingSpectrum& spectrum, bool even, double* out) const {
    const HemisphereGrid::Panel& panel = grid.panels[panelIndex];
    const std::size_t channels = spectrum.channels;
    const std::vector<double>* table = kept_->find(*this, grid, panel, a, b);
    const double* rows = table ? table->data() : nullptr;
    std::vector<double> own, products;
    for (const Basis* basis : bases_) {
        const int order = basis->order();
        for (int m = 0; m < order; ++m) {
            const std::size_t degrees = static_cast<std::size_t>(order - m);
            const double* theta = rows;
            if (rows) {
                rows += degrees * panel.rings;
            } else {
                own.resize(degrees * panel.rings);
                weightedTheta(*basis, m, grid, panel, own.data());
                theta = own.data();
            }
            const std::size_t columns = even || m == 0 ? channels : 2 * channels;
            products.assign(degrees * columns, 0.0);
            addRowProducts({theta, degrees, panel.rings},
                           {spectrum.part(m, 0) + panel.firstRing, columns, spectrum.rings},
                           panel.rings, products.data(), columns);
            const double sign = azimuthSign(m, basis->condonShortley());
            for (std::size_t c = 0; c < channels; ++c) {
                double* to = out + c * basis->slots();
                for (int l = m; l < order; ++l) {
                    const double* from = products.data() + (l - m) * columns;
                    to[slotOf(l, m)] = sign * from[c];
                    if (m > 0) to[slotOf(l, -m)] = even ? 0.0 : sign * from[channels + c];
                }
            }
        }
        out += channels * basis->slots();
    }
}

}  // namespace hshfit
