#include <hshfit/refinement.h>

#include <hshfit/error.h>
#include <hshfit/rings.h>

#include <fmt/format.h>
#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hshfit {
namespace {

using Inner = Basis::Inner;
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr int maxLevel = 16;

/// What one elevation panel holds at its present level.
struct Panel {
    double a, b;  ///< ends in u
    int level = -1;
    std::vector<std::vector<double>> moments = {};  ///< per basis: [channel][slot]
    PerInner energy{};
    std::vector<double> change = {};  ///< per basis: norm of the last change of the moments
    PerInner energyChange{};
};

/// Moments of one basis for every panel of a grid: the theta functions are evaluated once for all
/// rings, and each panel's block of rings is a matrix product.
std::vector<std::vector<double>> momentsOf(const Basis& basis, const RingSpectrum& spectrum,
                                           const HemisphereGrid& grid) {
    const std::size_t rings = spectrum.rings, channels = spectrum.channels;
    const int order = basis.order();
    Eigen::ArrayXd weights = Eigen::Map<const Eigen::ArrayXd>(grid.weights.data(), rings);
    if (basis.inner() == Inner::projectedSolidAngle) {
        for (std::size_t r = 0; r < rings; ++r) weights[r] *= grid.elevations[r].mu;
    }
    std::vector<std::vector<double>> moments(grid.panels.size());
    for (auto& m : moments) m.assign(channels * basis.slots(), 0.0);

    RowMatrix theta;
    Eigen::MatrixXd parts(rings, 2 * channels), products;
    for (int m = 0; m < order; ++m) {
        theta.resize(order - m, rings);
        basis.analysisTheta(m, grid.elevations, theta.data());
        for (std::size_t c = 0; c < channels; ++c) {
            using Column = Eigen::Map<const Eigen::ArrayXd>;
            parts.col(c) = Column(spectrum.part(m, c), rings) * weights;
            parts.col(channels + c) = Column(spectrum.part(-m, c), rings) * weights;
        }
        const double sign = azimuthSign(m, basis.condonShortley());
        for (std::size_t p = 0; p < grid.panels.size(); ++p) {
            const auto& panel = grid.panels[p];
            products.noalias() = theta.middleCols(panel.firstRing, panel.rings) *
                                 parts.middleRows(panel.firstRing, panel.rings);
            for (std::size_t c = 0; c < channels; ++c) {
                double* out = moments[p].data() + c * basis.slots();
                for (int l = m; l < order; ++l) {
                    out[slotOf(l, m)] = sign * products(l - m, c);
                    if (m > 0) out[slotOf(l, -m)] = sign * products(l - m, channels + c);
                }
            }
        }
    }
    return moments;
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
    using Column = Eigen::Map<const Eigen::VectorXd>;
    return (Column(a.data(), a.size()) - Column(b.data(), b.size())).norm();
}

double relative(double difference, double reference) {
    if (difference == 0) return 0;
    return reference > 0 ? difference / reference : std::numeric_limits<double>::infinity();
}

/// One outgoing direction on its way to convergence.
class Refinement {
public:
    Refinement(const Brdf& brdf, std::span<const Basis* const> bases, const Direction& wo,
               const RefinementOptions& options)
        : brdf_(brdf), bases_(bases), wo_(wo), options_(options), lobes_(brdf.lobes(wo)) {
        for (const Basis* basis : bases) order_ = std::max(order_, basis->order());
        const std::vector<double> breaks = panelBreaks(lobes_, wo, brdf.kinks(wo));
        for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
            panels_.push_back({.a = breaks[k], .b = breaks[k + 1]});
        }
        result_.horizon = horizonBehaviour(brdf, wo, options.quantity);
    }

    RefinedMoments run() {
        if (!result_.horizon.coefficientsExist()) {
            throw NumericError(
                fmt::format("{}: {}; its coefficients do not exist either", brdf_.name(),
                            divergenceReason(result_.horizon, wo_, options_.quantity)));
        }
        std::vector<std::size_t> active(panels_.size());
        for (std::size_t p = 0; p < active.size(); ++p) active[p] = p;
        while (!active.empty()) {
            refine(active);
            addUp();
            active = unconverged();
        }
        return std::move(result_);
    }

private:
    /// Takes the given panels one level further.
    void refine(const std::vector<std::size_t>& active) {
        HemisphereGrid grid;
        for (std::size_t p : active) {
            Panel& panel = panels_[p];
            ++panel.level;
            appendPanel(grid, panel.a, panel.b, lobes_, wo_,
                        {.order = order_, .level = panel.level});
        }
        const std::size_t cost = grid.points() / (options_.even ? 2 : 1);
        const bool tooDeep = std::any_of(active.begin(), active.end(), [&](std::size_t p) {
            return panels_[p].level > maxLevel;
        });
        if (tooDeep || result_.evaluations + cost > options_.maxEvaluations) giveUp();
        result_.evaluations += cost;

        const RingSpectrum spectrum =
            sampleRings(brdf_, wo_, grid, options_.quantity, order_, options_.even);
        std::vector<std::vector<std::vector<double>>> moments;  // [basis][active panel]
        for (const Basis* basis : bases_) moments.push_back(momentsOf(*basis, spectrum, grid));
        for (std::size_t k = 0; k < active.size(); ++k) {
            std::vector<std::vector<double>> ofPanel;
            for (auto& ofBasis : moments) ofPanel.push_back(std::move(ofBasis[k]));
            update(panels_[active[k]], std::move(ofPanel), energyOf(spectrum, grid, k));
        }
    }

    static PerInner energyOf(const RingSpectrum& spectrum, const HemisphereGrid& grid,
                             std::size_t p) {
        PerInner energy{};
        const auto& panel = grid.panels[p];
        for (std::size_t r = panel.firstRing; r < panel.firstRing + panel.rings; ++r) {
            const double part = grid.weights[r] * spectrum.squares[r];
            energy[static_cast<int>(Inner::solidAngle)] += part;
            energy[static_cast<int>(Inner::projectedSolidAngle)] += part * grid.elevations[r].mu;
        }
        return energy;
    }

    static void update(Panel& panel, std::vector<std::vector<double>> moments,
                       const PerInner& energy) {
        panel.change.assign(moments.size(), std::numeric_limits<double>::infinity());
        for (std::size_t e = 0; e < energy.size(); ++e) {
            panel.energyChange[e] = panel.level == 0 ? std::numeric_limits<double>::infinity()
                                                     : std::abs(energy[e] - panel.energy[e]);
        }
        for (std::size_t b = 0; b < moments.size() && panel.level > 0; ++b) {
            panel.change[b] = distance(moments[b], panel.moments[b]);
        }
        panel.moments = std::move(moments);
        panel.energy = energy;
    }

    /// Totals over the panels, in their order.
    void addUp() {
        result_.moments.assign(bases_.size(), {});
        result_.energy = result_.energyError = {};
        for (std::size_t b = 0; b < bases_.size(); ++b) {
            auto& total = result_.moments[b];
            total.assign(panels_[0].moments[b].size(), 0.0);
            for (const Panel& panel : panels_) {
                for (std::size_t i = 0; i < total.size(); ++i) total[i] += panel.moments[b][i];
            }
        }
        for (const Panel& panel : panels_) {
            for (std::size_t e = 0; e < result_.energy.size(); ++e) {
                result_.energy[e] += panel.energy[e];
                result_.energyError[e] += panel.energyChange[e];
            }
        }
        result_.error = 0;
        for (const Panel& panel : panels_) result_.error += changeOf(panel);
    }

    /// A panel's last change, relative to the totals: the largest over bases and their energies.
    double changeOf(const Panel& panel) const {
        double change = 0;
        for (std::size_t b = 0; b < bases_.size(); ++b) {
            const auto& total = result_.moments[b];
            const double norm =
                Eigen::Map<const Eigen::VectorXd>(total.data(), total.size()).norm();
            change = std::max(change, relative(panel.change[b], norm));
            const Inner inner = bases_[b]->inner();
            if (!result_.horizon.energyExists(inner)) continue;
            const int e = static_cast<int>(inner);
            change = std::max(change, relative(panel.energyChange[e], result_.energy[e]));
        }
        return change;
    }

    /// The panels to refine next: none once the changes add up to the tolerance.
    std::vector<std::size_t> unconverged() const {
        std::vector<std::size_t> active;
        if (result_.error <= options_.tolerance) return active;
        const double share = 0.5 * options_.tolerance / static_cast<double>(panels_.size());
        for (std::size_t p = 0; p < panels_.size(); ++p) {
            if (changeOf(panels_[p]) > share) active.push_back(p);
        }
        return active;
    }

    [[noreturn]] void giveUp() const {
        throw NumericError(fmt::format(
            "{}: not converged at theta_o = {:.6g}, phi_o = {:.6g} degrees: relative change {:.2g} "
            "after {} evaluations, {:.2g} asked; raise --tolerance or --max-evaluations",
            brdf_.name(), degrees(polarAngle(wo_)), degrees(azimuth(wo_)), result_.error,
            result_.evaluations, options_.tolerance));
    }

    const Brdf& brdf_;
    std::span<const Basis* const> bases_;
    Direction wo_;
    RefinementOptions options_;
    std::vector<Lobe> lobes_;
    int order_ = 1;
    std::vector<Panel> panels_;
    RefinedMoments result_;
};

}  // namespace

RefinedMoments refineMoments(const Brdf& brdf, std::span<const Basis* const> bases,
                             const Direction& wo, const RefinementOptions& options) {
    return Refinement(brdf, bases, wo, options).run();
}

}  // namespace hshfit
