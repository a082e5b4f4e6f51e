#include <hshfit/projection/internal/theta_products.h>

#include <hshfit/projection/lane_products.h>
#include <hshfit/stop_request.h>

#include <tbb/concurrent_unordered_map.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>

namespace hshfit::inline projection {
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

/// Panels from halving have such ends; panels at kinks hardly ever recur.
bool isDyadic(double u) {
    constexpr double finest = 1 << 24;
    return u * finest == std::floor(u * finest);
}

std::size_t lanesOf(const Basis& basis) {
    std::size_t lanes = 0;
    for (int m = 0; m < basis.order(); ++m) lanes += thetaLanes(basis.order(), m);
    return lanes;
}

/// Theta functions of one m, l = m .. order-1, times the weights of the rings and of the inner
/// product and the sign of the azimuth functions: [ring][l - m], whole groups of l. `rows` is
/// scratch memory.
void weightedTheta(const Basis& basis, int m, const HemisphereGrid& grid,
                   const HemisphereGrid::Panel& panel, std::vector<double>& rows, double* out) {
    const std::span<const Elevation<double>> points(grid.elevations.data() + panel.firstRing,
                                                    panel.rings);
    const auto degrees = static_cast<std::size_t>(basis.order() - m);
    const std::size_t lanes = thetaLanes(basis.order(), m);
    if (rows.size() < degrees * panel.rings) rows.resize(degrees * panel.rings);
    basis.analysisTheta(m, points, rows.data());
    const bool projected = basis.inner() == Basis::Inner::projectedSolidAngle;
    const double sign = azimuthSign(m, basis.condonShortley());
    for (std::size_t r = 0; r < panel.rings; ++r)
        std::fill(out + r * lanes + degrees, out + (r + 1) * lanes, 0.0);
    // A few rings at a time, each of which is written from its beginning to its end.
    constexpr std::size_t together = 8;
    for (std::size_t first = 0; first < panel.rings; first += together) {
        const std::size_t some = std::min(together, panel.rings - first);
        double weights[together];
        for (std::size_t r = 0; r < some; ++r)
            weights[r] = sign * grid.weights[panel.firstRing + first + r] *
                         (projected ? points[first + r].mu : 1.0);
        for (std::size_t k = 0; k < degrees; ++k)
            for (std::size_t r = 0; r < some; ++r)
                out[(first + r) * lanes + k] = weights[r] * rows[k * panel.rings + first + r];
    }
}

}  // namespace

struct ThetaProducts::Kept {
    tbb::concurrent_unordered_map<Key, std::unique_ptr<std::vector<double>>, KeyHash> tables;
    std::atomic<std::size_t> values = 0;

    /// None where the cache is full.
    const std::vector<double>* find(const ThetaProducts& products, const HemisphereGrid& grid,
                                    const HemisphereGrid::Panel& panel, double a, double b);
};

const std::vector<double>* ThetaProducts::Kept::find(const ThetaProducts& products,
                                                     const HemisphereGrid& grid,
                                                     const HemisphereGrid::Panel& panel, double a,
                                                     double b) {
    const std::size_t size = products.lanes_ * panel.rings;
    if (size > mostOfPanel || panel.crowded || !isDyadic(a) || !isDyadic(b)) return nullptr;
    const Key key{a, b, panel.rings};
    if (const auto found = tables.find(key); found != tables.end()) return found->second.get();
    if (values.load(std::memory_order_relaxed) + size > mostOfAll) return nullptr;
    auto table = std::make_unique<std::vector<double>>(size);
    double* to = table->data();
    std::vector<double> rows;
    for (const Basis* basis : products.bases_) {
        for (int m = 0; m < basis->order(); ++m) {
            weightedTheta(*basis, m, grid, panel, rows, to);
            to += thetaLanes(basis->order(), m) * panel.rings;
        }
    }
    const auto [place, isNew] = tables.emplace(key, std::move(table));
    if (isNew) values += size;
    return place->second.get();
}

ThetaProducts::ThetaProducts(std::span<const Basis* const> bases)
    : bases_(bases.begin(), bases.end()), kept_(std::make_unique<Kept>()) {
    int order = 1;
    for (const Basis* basis : bases_) {
        lanes_ += lanesOf(*basis);
        order = std::max(order, basis->order());
    }
    const AzimuthColumns columns(order);
    for (int m = 0; m < order; ++m) {
        columnOf_.push_back(columns.of(m));
        columnOf_.push_back(m == 0 ? 0 : columns.of(-m));
    }
}

ThetaProducts::~ThetaProducts() = default;

std::size_t ThetaProducts::size(std::size_t basis, std::size_t channels) const {
    return 2 * channels * lanesOf(*bases_[basis]);
}

void ThetaProducts::addMoments(const HemisphereGrid& grid, std::size_t panelIndex, double a,
                               double b, const RingSpectrum& spectrum, bool even,
                               double* out) const {
    const HemisphereGrid::Panel& panel = grid.panels[panelIndex];
    const std::vector<double>* kept = kept_->find(*this, grid, panel, a, b);
    const double* table = kept ? kept->data() : nullptr;
    std::vector<double> own, rows;
    for (std::size_t k = 0; k < bases_.size(); ++k) {
        const Basis& basis = *bases_[k];
        ThetaSums sums{.spectrum = spectrum.parts.data() + panel.firstRing * spectrum.ringSize(),
                       .rings = panel.rings,
                       .channels = spectrum.channels,
                       .columns = spectrum.columns.all(),
                       .columnOf = columnOf_.data(),
                       .order = basis.order(),
                       .firstM = 0,
                       .lastM = basis.order(),
                       .even = even,
                       .theta = table};
        if (table) {
            addThetaSums(sums, out);
            table += lanesOf(basis) * panel.rings;
            out += size(k, spectrum.channels);
            continue;
        }
        for (int m = 0; m < basis.order(); ++m) {
            stopIfRequested();
            const std::size_t lanes = thetaLanes(basis.order(), m);
            if (own.size() < lanes * panel.rings) own.resize(lanes * panel.rings);
            weightedTheta(basis, m, grid, panel, rows, own.data());
            sums.theta = own.data();
            sums.firstM = m;
            sums.lastM = m + 1;
            addThetaSums(sums, out);
            out += 2 * spectrum.channels * lanes;
        }
    }
}

std::vector<double> ThetaProducts::toSlots(std::size_t basis, std::size_t channels,
                                           const double* from) const {
    const int order = bases_[basis]->order();
    const auto slots = static_cast<std::size_t>(bases_[basis]->slots());
    std::vector<double> result(channels * slots);
    for (int m = 0; m < order; ++m) {
        const std::size_t lanes = thetaLanes(order, m);
        const auto take = [&](int signedM, std::size_t c) {
            double* const to = result.data() + c * slots;
            for (int l = m; l < order; ++l) to[slotOf(l, signedM)] = from[l - m];
            from += lanes;
        };
        for (std::size_t c = 0; c < channels; ++c) take(m, c);
        if (m == 0) from += channels * lanes;
        if (m > 0)
            for (std::size_t c = 0; c < channels; ++c) take(-m, c);
    }
    return result;
}

}  // namespace hshfit::inline projection
