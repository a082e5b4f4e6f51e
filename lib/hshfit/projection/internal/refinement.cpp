#include <hshfit/projection/internal/refinement.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/brdf/kink_curve.h>
#include <hshfit/error.h>
#include <hshfit/projection/internal/convergence.h>
#include <hshfit/stop_request.h>
#include <hshfit/wording.h>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hshfit::inline projection {
namespace {

using Inner = Basis::Inner;

constexpr int maxLevel = 20;
/// Rounding of sums over all nodes, relative; and the accuracy of basis functions and of models'
/// formulas, below which no error is stated.
constexpr double rounding = 1e-14, accuracyOfValues = 1e-12;
/// Tolerances from here on belong to interpolated tables (Brdf::defaultTolerance).
constexpr double interpolated = 1e-4;
/// Changes that a panel has to show before they are believed: a small one, or two, may be an
/// accident. Interpolated tables state a multiple of their error, which covers such accidents.
constexpr int leastChanges = 3;
/// The share of the totals below which a panel is believed sooner.
constexpr double negligible = 0.1;
/// Tolerances from here on are loose: panels begin with a level below 0 and are believed once an
/// error that leaves room for accidents (earlyError) is small enough, and an error states no less
/// than a hundredth of the tolerance. To begin with level 0 takes 1.3 times the evaluations of
/// Ward's model at 1e-3 (bench/projection.cpp, byTolerance).
constexpr double loose = 1e-4, leastStated = 0.01;
constexpr int firstOfLoose = -1;

/// State of one elevation panel at its present level.
struct Panel {
    double a, b;  ///< ends in u
    AzimuthPeaks peaks;
    PanelCurves curves;
    int level;
    std::vector<double> moments = {}, before = {};  ///< in the order of ThetaProducts
    PerInner energy{};
    std::vector<Changes> change = {};  ///< per basis: of the moments, by norm
    std::array<Changes, 2> energyChange = {};
    PanelError error = {};  ///< relative to the totals
    double share = 0;       ///< of the totals, the largest over bases and energies
};

/// The root of the sum of squares of `count` values, in four sums side by side.
template <class Value>
double rootOfSquares(std::size_t count, Value value) {
    constexpr std::size_t lanes = laneGroup;
    double sums[lanes] = {};
    for (std::size_t i = 0; i + lanes <= count; i += lanes)
        for (std::size_t k = 0; k < lanes; ++k) sums[k] += value(i + k) * value(i + k);
    for (std::size_t i = count / lanes * lanes; i < count; ++i) sums[0] += value(i) * value(i);
    return std::sqrt((sums[0] + sums[1]) + (sums[2] + sums[3]));
}

double distance(std::span<const double> a, std::span<const double> b) {
    return rootOfSquares(a.size(), [&](std::size_t i) { return a[i] - b[i]; });
}

double norm(std::span<const double> a) {
    return rootOfSquares(a.size(), [&](std::size_t i) { return a[i]; });
}

double relative(double difference, double reference) {
    if (difference == 0) return 0;
    return reference > 0 ? difference / reference : infinity;
}

/// One outgoing direction on its way to convergence.
class Refinement {
public:
    Refinement(const Brdf& brdf, const ProjectionTables& tables, const Direction& wo,
               const RefinementOptions& options)
        : brdf_(brdf),
          tables_(tables),
          bases_(tables.theta.bases()),
          wo_(wo),
          options_(options),
          mayBeSmooth_(brdf.defaultTolerance() < interpolated),
          loose_(mayBeSmooth_ && options.tolerance >= loose),
          firstLevel_(loose_ ? firstOfLoose : 0) {
        offsets_ = {0};
        for (std::size_t b = 0; b < bases_.size(); ++b)
            offsets_.push_back(offsets_[b] + tables.theta.size(b, brdf.channels().count()));
        const std::vector<Lobe> lobes = brdf.lobes(wo);
        const std::vector<KinkCurve> curves = kinkCurvesOf(brdf, wo);
        std::vector<double> heights = brdf.kinks(wo);
        for (const double height : curveEnds(curves)) heights.push_back(height);
        const std::vector<double> breaks = panelBreaks(lobes, wo, heights);
        for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
            const double a = breaks[k], b = breaks[k + 1];
            panels_.push_back({.a = a,
                               .b = b,
                               .peaks = {lobes, wo, a, b},
                               .curves = {curves, a, b},
                               .level = firstLevel_ - 1});
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
        for (std::size_t b = 0; b < bases_.size(); ++b) {
            result_.moments.push_back(
                tables_.theta.toSlots(b, spectrum_.channels, ofBasis(totals_, b).data()));
            result_.enlargement.push_back(enlargement(b));
            result_.rounding.push_back(roundingOf(b));
        }
        return std::move(result_);
    }

private:
    /// Takes the given panels one level further.
    void refine(const std::vector<std::size_t>& active) {
        grid_.clear();
        for (std::size_t p : active) {
            Panel& panel = panels_[p];
            ++panel.level;
            appendPanel(grid_, panel.a, panel.b, panel.peaks,
                        {.order = tables_.azimuths.order(),
                         .level = panel.level,
                         .squeezed = true,
                         .even = options_.even},
                        panel.curves);
            // Rounded up to a multiple of 4, level 0 may have as many azimuths, and show no change.
            HemisphereGrid::Panel& last = grid_.panels.back();
            if (panel.level < 0 && last.cuts.empty()) last.azimuths.spacing.azimuths -= 4;
        }
        const std::size_t cost = grid_.points() / (options_.even ? 2 : 1);
        const bool tooDeep = std::any_of(active.begin(), active.end(), [&](std::size_t p) {
            return panels_[p].level > maxLevel;
        });
        if (tooDeep || result_.evaluations + cost > options_.maxEvaluations) giveUp();
        result_.evaluations += cost;

        sampleRings(brdf_, wo_, grid_, options_.quantity, tables_.azimuths, options_.even,
                    spectrum_);
        const auto takePanel = [&](std::size_t k) {
            stopIfRequested();
            Panel& panel = panels_[active[k]];
            panel.before.swap(panel.moments);
            panel.moments.assign(offsets_.back(), 0.0);
            tables_.theta.addMoments(grid_, k, panel.a, panel.b, spectrum_, options_.even,
                                     panel.moments.data());
            update(panel, energyOf(k));
        };
        // Worth sharing where the functions are many.
        if (offsets_.back() * spectrum_.rings > std::size_t{1} << 20) {
            tbb::parallel_for(std::size_t{0}, active.size(), takePanel);
        } else {
            for (std::size_t k = 0; k < active.size(); ++k) takePanel(k);
        }
    }

    PerInner energyOf(std::size_t p) const {
        PerInner energy{};
        const auto& panel = grid_.panels[p];
        for (std::size_t r = panel.firstRing; r < panel.firstRing + panel.rings; ++r) {
            const double part = grid_.weights[r] * spectrum_.squares[r];
            energy[static_cast<int>(Inner::solidAngle)] += part;
            energy[static_cast<int>(Inner::projectedSolidAngle)] += part * grid_.elevations[r].mu;
        }
        return energy;
    }

    std::span<const double> ofBasis(const std::vector<double>& moments, std::size_t b) const {
        return std::span(moments).subspan(offsets_[b], offsets_[b + 1] - offsets_[b]);
    }

    void update(Panel& panel, const PerInner& energy) const {
        panel.change.resize(bases_.size());
        for (std::size_t e = 0; e < energy.size() && changesOf(panel) > 0; ++e) {
            panel.energyChange[e].add(std::abs(energy[e] - panel.energy[e]));
        }
        for (std::size_t b = 0; b < bases_.size() && changesOf(panel) > 0; ++b) {
            panel.change[b].add(distance(ofBasis(panel.moments, b), ofBasis(panel.before, b)));
        }
        panel.energy = energy;
    }

    /// Totals over the panels, in their order, and their errors.
    void addUp() {
        totals_.assign(offsets_.back(), 0.0);
        result_.energy = {};
        for (const Panel& panel : panels_) {
            stopIfRequested();
            for (std::size_t i = 0; i < totals_.size(); ++i) totals_[i] += panel.moments[i];
            for (std::size_t e = 0; e < result_.energy.size(); ++e)
                result_.energy[e] += panel.energy[e];
        }
        norms_.clear();
        for (std::size_t b = 0; b < bases_.size(); ++b) norms_.push_back(norm(ofBasis(totals_, b)));
        expected_ = result_.error = 0;
        for (Panel& panel : panels_) {
            panel.share = shareOf(panel);
            const bool early = loose_ && !hasShownItself(panel);
            panel.error = early ? earlyError(largestChanges(panel))
                                : panelError(largestChanges(panel), mayBeSmooth_);
            expected_ += panel.error.expected;
            result_.error += panel.error.stated;
        }
        if (result_.error > 0)
            result_.error += loose_ ? leastStated * options_.tolerance : accuracyOfValues;
        for (std::size_t e = 0; e < result_.energy.size(); ++e)
            result_.energyError[e] = result_.error * result_.energy[e];
    }

    /// A panel's changes, each relative to its total: the largest over bases and energies.
    Changes largestChanges(const Panel& panel) const {
        Changes largest;
        for (std::size_t k = 0; k < Changes::kept; ++k) {
            double& value = largest.values[k];
            if (value = panel.energyChange[0].values[k]; value == infinity) continue;
            value = 0;
            for (std::size_t b = 0; b < bases_.size(); ++b)
                value = std::max(value, relative(panel.change[b].values[k], norms_[b]));
            for (std::size_t e = 0; e < result_.energy.size(); ++e)
                if (result_.horizon.energyExists(static_cast<Inner>(e)))
                    value = std::max(value,
                                     relative(panel.energyChange[e].values[k], result_.energy[e]));
        }
        return largest;
    }

    double shareOf(const Panel& panel) const {
        double largest = 0;
        for (std::size_t b = 0; b < bases_.size(); ++b)
            largest = std::max(largest, relative(norm(ofBasis(panel.moments, b)), norms_[b]));
        for (std::size_t e = 0; e < result_.energy.size(); ++e)
            if (result_.horizon.energyExists(static_cast<Inner>(e)))
                largest = std::max(largest, relative(panel.energy[e], result_.energy[e]));
        return largest;
    }

    int changesOf(const Panel& panel) const { return panel.level - firstLevel_; }

    /// Whether a panel has as many changes as are needed to see how it converges.
    bool hasShownItself(const Panel& panel) const {
        return !mayBeSmooth_ || changesOf(panel) >= leastChanges || panel.share < negligible;
    }

    /// By how much the solution of a Gram system enlarges the last changes, relative to the
    /// moments.
    double enlargement(std::size_t b) const {
        if (bases::find(bases_[b]->name()).orthonormal) return 1;
        double changes = 0, solvedChanges = 0;
        std::vector<double> change(offsets_[b + 1] - offsets_[b]);
        for (const Panel& panel : panels_) {
            const auto now = ofBasis(panel.moments, b), before = ofBasis(panel.before, b);
            for (std::size_t i = 0; i < change.size(); ++i) change[i] = now[i] - before[i];
            changes += norm(change);
            solvedChanges += solvedNorm(b, change);
        }
        const double solved = solvedNorm(b, ofBasis(totals_, b));
        if (!(changes > 0 && solved > 0)) return 1;
        return std::max(1.0, solvedChanges / changes * norms_[b] / solved);
    }

    /// Rounding of f, relative: a Gram system enlarges it by up to the root of its largest inverse
    /// eigenvalue, which the solution of moments of alternating signs shows.
    double roundingOf(std::size_t b) const {
        if (bases::find(bases_[b]->name()).orthonormal) return 0;
        std::vector<double> signs(offsets_[b + 1] - offsets_[b]);
        for (std::size_t i = 0; i < signs.size(); ++i) signs[i] = i % 2 == 0 ? 1 : -1;
        return rounding * std::sqrt(std::max(1.0, solvedNorm(b, signs)));
    }

    /// The norm of the coefficients that follow from moments.
    double solvedNorm(std::size_t b, std::span<const double> moments) const {
        const Basis& basis = *bases_[b];
        const std::vector<double> slots =
            tables_.theta.toSlots(b, spectrum_.channels, moments.data());
        std::vector<double> solved(slots.size());
        const auto each = static_cast<std::size_t>(basis.slots());
        for (std::size_t c = 0; c < spectrum_.channels; ++c)
            basis.coefficientsFromMoments(slots.data() + c * each, basis.order(),
                                          solved.data() + c * each);
        return norm(solved);
    }

    /// The panels to refine next: none once the errors add up to the tolerance.
    std::vector<std::size_t> unconverged() const {
        std::vector<std::size_t> active;
        for (std::size_t p = 0; p < panels_.size() && !loose_; ++p)
            if (changesOf(panels_[p]) > 0 && !hasShownItself(panels_[p])) active.push_back(p);
        if (!active.empty() || expected_ <= options_.tolerance) return active;
        const double share = 0.5 * options_.tolerance / static_cast<double>(panels_.size());
        for (std::size_t p = 0; p < panels_.size(); ++p) {
            if (panels_[p].error.expected > share) active.push_back(p);
        }
        return active;
    }

    [[noreturn]] void giveUp() const {
        throw NumericError(fmt::format(
            "{}: not converged at theta_o = {:.6g}, phi_o = {:.6g} degrees: relative change {:.2g} "
            "after {} evaluations, {:.2g} asked; raise {} or {}",
            brdf_.name(), degrees(polarAngle(wo_)), degrees(azimuth(wo_)), expected_,
            result_.evaluations, options_.tolerance, Setting{"ProjectionOptions::tolerance"},
            Setting{"ProjectionOptions::maxEvaluations"}));
    }

    const Brdf& brdf_;
    const ProjectionTables& tables_;
    std::span<const Basis* const> bases_;
    Direction wo_;
    RefinementOptions options_;
    bool mayBeSmooth_;  ///< f is no interpolated table
    bool loose_;        ///< the tolerance, of such an f
    int firstLevel_;
    double expected_ = 0;               ///< relative error, by which refinement goes
    std::vector<std::size_t> offsets_;  ///< of each basis among the moments
    std::vector<Panel> panels_;
    HemisphereGrid grid_;    ///< of the panels that are being refined
    RingSpectrum spectrum_;  ///< on it
    std::vector<double> totals_, norms_;
    RefinedMoments result_;
};

}  // namespace

ProjectionTables::ProjectionTables(std::span<const Basis* const> bases)
    : azimuths((*std::ranges::max_element(bases, {}, &Basis::order))->order()), theta(bases) {}

RefinedMoments refineMoments(const Brdf& brdf, const ProjectionTables& tables, const Direction& wo,
                             const RefinementOptions& options) {
    return Refinement(brdf, tables, wo, options).run();
}

}  // namespace hshfit::inline projection
