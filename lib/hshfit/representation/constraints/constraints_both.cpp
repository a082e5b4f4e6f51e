#include <hshfit/representation/constraints/internal/constraints_both.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/linear_algebra/descend.h>
#include <hshfit/representation/basis_matrix.h>
#include <hshfit/representation/constraints/constraints_cone.h>
#include <hshfit/representation/constraints/constraints_scan.h>
#include <hshfit/representation/constraints/internal/constraints_albedo.h>
#include <hshfit/representation/constraints/internal/constraints_least_change.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace hshfit::inline representation::inline constraints {
namespace {

constexpr std::size_t mostRefined = 8000;  // of the lowest nodes
constexpr std::size_t mostPerRound = 400;  // of the lowest minima

/// Everything that the channels of one matrix share.
class PairScan {
public:
    explicit PairScan(const Representation& matrix)
        : quantity_(matrix.head.quantity),
          basis_(bases::make(matrix.head.basis, matrix.head.order,
                             {.condonShortley = matrix.head.condonShortley})),
          symmetry_(symmetryOf(matrix)),
          terms_(productTerms(*basis_, symmetry_)),
          even_(symmetry_.isotropic && symmetry_.bilateral),
          coarse_(*basis_, even_),
          fine_(*basis_, even_, HemisphereScan::fine),
          moments_(albedoMoments(*basis_, quantity_)) {
        const int order = basis_->order(), polar = 4 * order + 9;
        polarStep_ = HemisphereScan::horizon() / (polar - 1);
        for (int i = 0; i < polar; ++i) polar_.push_back(i * polarStep_);
        azimuthStep_ = 2 * pi / (8 * order + 8);
        // Mirrored copies of a quarter, where both mirrors hold.
        int around = symmetry_.isotropic ? 1 : symmetry_.bilateral ? 2 * order + 3 : 8 * order + 8;
        for (int j = 0; j < around; ++j) azimuths_.push_back(j * azimuthStep_);
    }

    const Basis& basis() const { return *basis_; }
    std::size_t terms() const { return terms_.size(); }

    std::vector<double> row(const DirectionPair& at) const {
        std::vector<double> atWi(slots()), atWo(slots()), out(terms());
        basis_->evaluate(at.wi, atWi.data());
        basis_->evaluate(at.wo, atWo.data());
        evaluateProducts(terms_, symmetry_, atWi.data(), atWo.data(), out.data());
        return out;
    }
    /// The directional albedo as a functional of the terms.
    std::vector<double> albedoRow(const Direction& wo) const {
        std::vector<double> atWo(slots()), out(terms());
        basis_->evaluate(wo, atWo.data());
        evaluateProducts(terms_, symmetry_, moments_.data(), atWo.data(), out.data());
        return out;
    }
    double addedAt(const Brdf* added, std::size_t channel, const DirectionPair& at) const {
        if (!added) return 0;
        const std::vector<double> f = evaluate(*added, at.wi, at.wo);
        return f[f.size() == 1 ? 0 : channel] * (quantity_ == Quantity::brdf ? 1 : at.wi.z);
    }

    struct Minimum {
        DirectionPair pair;
        double value;
    };
    /// The lowest local minima over all four angles, refined; `thorough`: floors of valleys over wi
    /// for every wo as well.
    std::vector<Minimum> minima(const std::vector<double>& values, const Brdf* added,
                                std::size_t channel, double scale, bool thorough) const {
        const double threshold = (thorough ? 0.03 : 0.1) * scale;
        std::vector<std::vector<double>> sums(polar_.size() * azimuths_.size());
        const HemisphereScan& scan = thorough ? fine_ : coarse_;
        for (std::size_t o = 0; o < sums.size(); ++o) {
            sums[o] = sumsAt(scan, values, added, channel, o);
        }
        std::vector<std::pair<std::size_t, std::size_t>> nodes;  // of wo and wi
        for (std::size_t o = 0; o < sums.size(); ++o) {
            for (const std::size_t i : scan.minima(sums[o].data(), threshold, thorough)) {
                if (thorough || leastOfNeighbours(sums, o, i)) nodes.emplace_back(o, i);
            }
        }
        std::ranges::sort(nodes, {}, [&](const auto& at) { return sums[at.first][at.second]; });
        if (nodes.size() > mostRefined) nodes.resize(mostRefined);
        std::vector<Minimum> found(nodes.size());
        tbb::parallel_for(std::size_t{0}, nodes.size(), [&](std::size_t k) {
            found[k] = refined(scan, values, added, channel, nodes[k].first, nodes[k].second);
        });
        std::ranges::sort(found, {}, &Minimum::value);
        if (found.size() > mostPerRound) found.resize(mostPerRound);
        return found;
    }

    /// The directions at which the albedo is held: all polar angles down to the horizon ring.
    std::vector<Direction> albedoNodes() const {
        std::vector<Direction> nodes;
        const int polar = (symmetry_.isotropic ? 16 : 4) * basis_->order() + 9;
        for (int i = 0; i < polar; ++i) {
            for (const double phi : azimuths_) {
                nodes.push_back(directionFromAngles(i * lowestRing / (polar - 1), phi));
            }
        }
        return nodes;
    }

private:
    std::size_t slots() const { return static_cast<std::size_t>(basis_->slots()); }
    /// Offsets from the node of wo, as in HemisphereScan::offset.
    Direction outgoing(std::size_t o, double along, double across) const {
        const double radius = polar_[o / azimuths_.size()] + along;
        return directionFromAngles(std::min(std::hypot(radius, across), HemisphereScan::horizon()),
                                   azimuths_[o % azimuths_.size()] + std::atan2(across, radius));
    }
    Minimum refined(const HemisphereScan& scan, const std::vector<double>& values,
                    const Brdf* added, std::size_t channel, std::size_t o, std::size_t i) const {
        constexpr double any = std::numeric_limits<double>::infinity();
        const auto [along, across] = scan.axesAt(i);
        const double turn = symmetry_.isotropic
                                ? 0
                                : std::max(polarStep_, azimuthStep_ * polar_[o / azimuths_.size()]);
        std::vector<double> x(4, 0.0);
        const auto pairAt = [&](const std::vector<double>& to) {
            return DirectionPair{scan.offset(i, to[0], to[1]), outgoing(o, to[2], to[3])};
        };
        const double least = descend(
            [&](const std::vector<double>& to) {
                const DirectionPair at = pairAt(to);
                const std::vector<double> products = row(at);
                return std::inner_product(products.begin(), products.end(), values.begin(), 0.0) +
                       addedAt(added, channel, at);
            },
            x, {along, across, {polarStep_, -any, any}, {turn, -any, any}}, 6);
        return {pairAt(x), least};
    }
    std::vector<double> sumsAt(const HemisphereScan& scan, const std::vector<double>& values,
                               const Brdf* added, std::size_t channel, std::size_t o) const {
        std::vector<double> atWo(slots()), c(slots(), 0.0), sums(scan.size());
        const Direction wo = outgoing(o, 0, 0);
        basis_->evaluate(wo, atWo.data());
        contractWithOutgoing(terms_, symmetry_, values.data(), atWo.data(), c.data());
        scan.synthesise(c.data(), sums.data());
        for (std::size_t k = 0; added && k < sums.size(); ++k) {
            sums[k] += addedAt(added, channel, {scan.offset(k, 0, 0), wo});
        }
        return sums;
    }
    bool leastOfNeighbours(const std::vector<std::vector<double>>& sums, std::size_t o,
                           std::size_t node) const {
        const std::size_t around = azimuths_.size();
        const double value = sums[o][node];
        const std::size_t j = o % around;
        return (o < around || value <= sums[o - around][node]) &&
               (o + around >= sums.size() || value <= sums[o + around][node]) &&
               (j == 0 || value <= sums[o - 1][node]) &&
               (j + 1 == around || value <= sums[o + 1][node]);
    }

    Quantity quantity_;
    std::unique_ptr<Basis> basis_;
    ProductSymmetry symmetry_;
    std::vector<ProductTerm> terms_;
    bool even_;
    HemisphereScan coarse_, fine_;
    std::vector<double> moments_;
    double polarStep_ = 0, azimuthStep_ = 0;
    std::vector<double> polar_, azimuths_;  ///< of wo
};

double product(const std::vector<double>& a, const std::vector<double>& b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

/// The program of one channel.
std::vector<double> nearestMatrix(const PairScan& scan, std::vector<double> values,
                                  const BothConstraints& constraints, std::size_t channel,
                                  const std::vector<std::vector<double>>& albedoRows,
                                  const std::vector<double>& albedos) {
    const double norm = std::sqrt(product(values, values)), scale = norm / (2 * pi);
    if (norm == 0) return values;
    LeastChange program(values);
    for (std::size_t k = 0; k < albedoRows.size(); ++k) {
        std::vector<double> row = albedoRows[k];
        for (double& each : row) each = -each;
        program.add(row, -albedos[k]);
    }
    program.solve(1e-12 * norm);
    values = program.x();
    double lift = 0;
    bool thorough = false, settled = !constraints.nonNegative;
    for (int round = 0; !settled && round < constraints.mostRounds; ++round) {
        bool negative = false;
        lift = 0;
        for (const auto& each : scan.minima(values, constraints.added, channel, scale, thorough)) {
            if (each.value >= 0) continue;
            const std::vector<double> row = scan.row(each.pair);
            lift = std::max(lift, -each.value / row[0]);
            if (-each.value < 0.01 * nonNegativeTolerance * norm * row[0]) continue;
            negative = true;
            program.add(
                row, constraints.added ? -scan.addedAt(constraints.added, channel, each.pair) : 0);
        }
        settled = !negative && thorough;
        thorough = thorough || !negative;
        if (!negative) continue;
        program.solve(1e-12 * norm);
        values = program.x();
    }
    values[0] += lift;
    if (!settled) {
        double least = -lift / (2 * pi);
        for (const auto& each : scan.minima(values, constraints.added, channel, scale, true))
            least = std::min(least, each.value);
        requireNearlySettled(scan.basis(), constraints.mostRounds, least / scale);
    }
    double share = 1;
    for (std::size_t k = 0; k < albedoRows.size(); ++k) {
        const double albedo = product(albedoRows[k], values);
        if (lift > 0 && albedo > albedos[k]) share = std::min(share, albedos[k] / albedo);
    }
    for (double& each : values) each *= std::max(share, 0.0);
    return values;
}

}  // namespace

void constrainBoth(Representation& matrix, const BothConstraints& constraints) {
    const PairScan scan(matrix);
    const std::size_t channels = matrix.head.channels.count();
    std::vector<std::vector<double>> rows;
    std::vector<double> bounds;
    if (constraints.albedoSource) {
        const std::vector<Direction> nodes = scan.albedoNodes();
        bounds = albedoBounds(*constraints.albedoSource, nodes);
        for (const Direction& wo : nodes) rows.push_back(scan.albedoRow(wo));
    }
    StoredArray& array = std::get<MatrixArray>(matrix.content).matrix;
    tbb::parallel_for(std::size_t{0}, channels, [&](std::size_t c) {
        double* from = array.values.data() + c * scan.terms();
        std::vector<double> albedos;
        for (std::size_t k = 0; k < rows.size(); ++k) albedos.push_back(bounds[k * channels + c]);
        const std::vector<double> nearest = nearestMatrix(
            scan, std::vector<double>(from, from + scan.terms()), constraints, c, rows, albedos);
        std::ranges::copy(nearest, from);
    });
}

}  // namespace hshfit::inline representation::inline constraints
