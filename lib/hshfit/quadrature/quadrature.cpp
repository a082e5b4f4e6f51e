#include <hshfit/quadrature/quadrature.h>

#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <iterator>
#include <map>
#include <memory>
#include <mutex>

namespace hshfit::inline quadrature {
namespace {

/// P_n and P_{n-1} at x = 1 - d. Differences of neighbours, with d exact, keep the accuracy at the
/// ends of the interval, where P_n(x) alone amplifies a rounding of x by n^2.
struct LegendrePair {
    long double value, previous;
};
LegendrePair legendre(int n, long double d) {
    long double p = 1, previous = 0, difference = 0;
    for (int k = 0; k < n; ++k) {
        difference = (k * difference - (2 * k + 1) * d * p) / (k + 1);
        previous = p;
        p += difference;
    }
    return {p, previous};
}

GaussRule computeRule(int n) {
    GaussRule rule;
    rule.nodes.resize(n);
    rule.weights.resize(n);
    const long double piL = 3.14159265358979323846264338327950288L;
    for (int i = 0; i < (n + 1) / 2; ++i) {
        // First guess: Tricomi's expansion, theta = pi (4i + 3) / (4n + 2) and its correction.
        long double theta = piL * (4 * i + 3) / (4 * n + 2);
        theta += 1 / (8.0L * n * n * std::tan(theta));
        long double slope = 0;
        for (int step = 0; step < 10; ++step) {
            const long double half = std::sin(theta / 2), s = std::sin(theta);
            const auto [value, previous] = legendre(n, 2 * half * half);
            // dP/dtheta = n (cos(theta) P_n - P_{n-1}) / sin(theta)
            slope = n * (std::cos(theta) * value - previous) / s;
            const long double change = value / slope;
            theta -= change;
            if (std::abs(change) < 1e-15L * theta) break;
        }
        const bool middle = 2 * i + 1 == n;
        const double x = middle ? 0.0 : static_cast<double>(std::cos(theta));
        const double w = static_cast<double>(2 / (slope * slope));
        rule.nodes[i] = -x;
        rule.nodes[n - 1 - i] = x;
        rule.weights[i] = rule.weights[n - 1 - i] = w;
    }
    return rule;
}

using Complex = std::complex<double>;

/// Bernstein parameter of the ellipse about [a, b] that passes through z.
double bernstein(double a, double b, Complex z) {
    const Complex t = (2.0 * z - (a + b)) / (b - a);
    const Complex root = std::sqrt(t - 1.0) * std::sqrt(t + 1.0);
    return std::max(std::abs(t + root), std::abs(t - root));
}

/// Gauss-Legendre converges like rho^(-2 p) with p nodes a panel; halving until rho >= 2.2 gives
/// 4e-4 at 5 nodes and 6e-9 at 12.
constexpr double panelEllipse = 2.2;
constexpr double firstNodes = 5, levelGrowth = 1.4;

/// Points of the complex u plane where the BRDF is not smooth.
std::vector<Complex> singularities(const std::vector<Lobe>& lobes, const Direction& wo) {
    std::vector<Complex> points;
    const auto addAngle = [&](Complex theta) { points.push_back(std::sqrt(std::cos(theta))); };
    for (const Lobe& lobe : lobes) {
        if (lobe.about == Lobe::About::axis) {
            addAngle({polarAngle(lobe.axis), lobe.width});
            continue;
        }
        // Half vector: its slope is tan((theta - theta_o) / 2) in the plane of incidence, so a
        // slope of i alpha lies at theta_o + 2 i atanh(alpha). cos(theta) + cos(theta_o) = 0 and
        // the shadowing term's 1 + alpha^2 tan(theta)^2 = 0 add two points near the horizon.
        const double alpha = std::min(lobe.width, 0.95);
        addAngle({polarAngle(wo), 2 * std::atanh(alpha)});
        // A lobe that is long and narrow is a ridge: rings touch it where the sine is wo's
        // component across, if it reaches so far.
        if (lobe.spread > lobe.width) {
            const bool wideX = std::abs(lobe.axis.x) > std::abs(lobe.axis.y);
            const double across = std::abs(wideX ? wo.y : wo.x);
            const double along = std::abs(wideX ? wo.x : wo.y);
            if (along < 2 * lobe.spread * (wo.z + std::sqrt((1 - across) * (1 + across))))
                addAngle({std::asin(across), 2 * std::atanh(alpha)});
        }
        points.push_back(Complex(0, std::sqrt(std::max(wo.z, 0.0))));
        points.push_back(std::sqrt(Complex(0, alpha / std::sqrt(1 - alpha * alpha))));
    }
    return points;
}

/// The ellipse of a half panel lies within the ellipse of the whole: only points within are passed
/// on.
void splitPanels(double a, double b, const std::vector<Complex>& points, int depth,
                 std::vector<double>& breaks) {
    constexpr int maxDepth = 40;
    std::vector<Complex> within;
    if (depth < maxDepth)
        std::ranges::copy_if(points, std::back_inserter(within),
                             [&](Complex z) { return bernstein(a, b, z) < panelEllipse; });
    if (within.empty()) {
        breaks.push_back(b);
        return;
    }
    const double middle = 0.5 * (a + b);
    splitPanels(a, middle, within, depth + 1, breaks);
    splitPanels(middle, b, within, depth + 1, breaks);
}

}  // namespace

const GaussRule& gaussLegendre(int n) {
    if (n < 1 || n > 100000) {
        throw UsageError(
            fmt::format("{} Gauss-Legendre nodes asked for; 1 to 100000 exist here", n));
    }
    static std::mutex mutex;
    static std::map<int, std::unique_ptr<const GaussRule>> cache;
    {
        const std::lock_guard lock(mutex);
        if (const auto found = cache.find(n); found != cache.end()) return *found->second;
    }
    auto rule = std::make_unique<const GaussRule>(computeRule(n));
    const std::lock_guard lock(mutex);
    return *cache.try_emplace(n, std::move(rule)).first->second;
}

std::size_t HemisphereGrid::Panel::points() const {
    if (cuts.empty()) return rings * azimuths.spacing.azimuths;
    std::size_t total = 0;
    for (const CutRing& ring : cuts) total += 2 * ring.size();
    return total;
}

std::size_t HemisphereGrid::points() const {
    std::size_t total = 0;
    for (const Panel& panel : panels) total += panel.points();
    return total;
}

void HemisphereGrid::clear() {
    elevations.clear();
    sines.clear();
    weights.clear();
    panels.clear();
}

std::vector<double> panelBreaks(const std::vector<Lobe>& lobes, const Direction& wo,
                                const std::vector<double>& kinks) {
    std::vector<double> ends = {0.0};
    for (double mu : kinks) {
        if (mu > 0 && mu < 1) ends.push_back(std::sqrt(mu));
    }
    ends.push_back(1.0);
    std::sort(ends.begin(), ends.end());
    ends.erase(std::unique(ends.begin(), ends.end()), ends.end());

    const std::vector<Complex> points = singularities(lobes, wo);
    std::vector<double> breaks = {0.0};
    for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
        splitPanels(ends[k], ends[k + 1], points, 0, breaks);
    }
    return breaks;
}

void appendPanel(HemisphereGrid& grid, double a, double b, const AzimuthPeaks& peaks,
                 const GridOptions& options, const PanelCurves& curves) {
    const double refinement = std::pow(levelGrowth, options.level);
    const bool crowd = curves.rootAtA || curves.rootAtB;
    // Basis functions are polynomials of degree 2 order in u: half as many nodes, by length.
    constexpr double crowding = 1.5;
    const int nodes = static_cast<int>(std::ceil(
        (crowd ? crowding : 1) * (firstNodes * refinement + options.order * (b - a) * 1.3)));
    const GaussRule& rule = gaussLegendre(nodes);
    HemisphereGrid::Panel panel{.firstRing = grid.weights.size(),
                                .rings = static_cast<std::size_t>(nodes),
                                .azimuths = spreadAzimuths(peaks, {.order = options.order,
                                                                   .refinement = refinement,
                                                                   .squeezed = options.squeezed,
                                                                   .even = options.even}),
                                .crowded = crowd};
    if (!curves.empty() && panel.azimuths.spacing.squeeze == 0) {
        const KinkCurve& curve = curves.curves.front();
        const double radius = std::hypot(curve.x, curve.y);
        panel.azimuths.centreX = options.even ? std::copysign(1.0, curve.x) : curve.x / radius;
        panel.azimuths.centreY = options.even ? 0 : curve.y / radius;
    }
    for (int i = 0; i < nodes; ++i) {
        const Crowded place = crowded(0.5 * (1 + rule.nodes[i]), curves.rootAtA, curves.rootAtB);
        const double u = a + (b - a) * place.at;
        const double mu = u * u, oneMinusMu = (1 - u) * (1 + u);
        grid.elevations.push_back({mu, oneMinusMu});
        grid.sines.push_back(std::sqrt(oneMinusMu * (1 + mu)));
        grid.weights.push_back(u * (b - a) * place.slope * rule.weights[i]);
        if (!curves.empty())
            panel.cuts.emplace_back(curves, panel.azimuths, refinement, mu, grid.sines.back());
    }
    grid.panels.push_back(std::move(panel));
}

HemisphereGrid gridFor(const std::vector<Lobe>& lobes, const Direction& wo,
                       const GridOptions& options, const std::vector<double>& kinks,
                       const std::vector<KinkCurve>& curves) {
    std::vector<double> heights = kinks;
    for (const double height : curveEnds(curves)) heights.push_back(height);
    const std::vector<double> breaks = panelBreaks(lobes, wo, heights);
    HemisphereGrid grid;
    for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
        const double a = breaks[k], b = breaks[k + 1];
        appendPanel(grid, a, b, AzimuthPeaks(lobes, wo, a, b), options, {curves, a, b});
    }
    return grid;
}

}  // namespace hshfit::inline quadrature
