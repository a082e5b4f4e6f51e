#include <hshfit/quadrature.h>

#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <memory>
#include <mutex>

namespace hshfit {
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

/// Gauss-Legendre converges like rho^(-2 p) with p nodes a panel; halving until rho >= 2.4 gives
/// 1e-4 at 5 nodes and 1e-9 at 12. Trapezoid sums over azimuth converge like exp(-N psi) for a
/// singularity at distance psi: the exponent at level 0 is enough to see the lobe, not more.
constexpr double panelEllipse = 2.4;
constexpr double firstNodes = 5, firstAzimuthExponent = 4.5, levelGrowth = 1.5;
constexpr std::size_t maxAzimuths = std::size_t{1} << 22;

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
        points.push_back(Complex(0, std::sqrt(std::max(wo.z, 0.0))));
        points.push_back(std::sqrt(Complex(0, alpha / std::sqrt(1 - alpha * alpha))));
    }
    return points;
}

void splitPanels(double a, double b, const std::vector<Complex>& points, int depth,
                 std::vector<double>& breaks) {
    constexpr int maxDepth = 40;
    const bool split = depth < maxDepth &&
                       std::any_of(points.begin(), points.end(),
                                   [&](Complex z) { return bernstein(a, b, z) < panelEllipse; });
    if (!split) {
        breaks.push_back(b);
        return;
    }
    const double middle = 0.5 * (a + b);
    splitPanels(a, middle, points, depth + 1, breaks);
    splitPanels(middle, b, points, depth + 1, breaks);
}

/// Where along phi the BRDF is not smooth: `scale` off the real axis, at an azimuth given by its
/// cosine and sine.
struct AzimuthPeak {
    double x, y, scale;
};

/// The narrowest peak at each azimuth where there are any.
class AzimuthPeaks {
public:
    void add(double x, double y, double scale) {
        constexpr double together = 1 - 1e-12, farOff = 20;
        if (!(scale < farOff)) return;
        for (AzimuthPeak& peak : peaks_) {
            if (peak.x * x + peak.y * y > together) {
                peak.scale = std::min(peak.scale, scale);
                return;
            }
        }
        peaks_.push_back({x, y, scale});
    }

    /// On the ring (s, mu): acosh(1 + q/2), where q is the squared distance in the plane of
    /// incidence over s s'; none at the pole, where nothing depends on phi.
    void addLobe(const Lobe& lobe, const Direction& wo, double s, double mu) {
        const auto acosh1 = [](double q) { return 2 * std::asinh(std::sqrt(q) / 2); };
        if (lobe.about == Lobe::About::axis) {
            const double axisSine = std::hypot(lobe.axis.x, lobe.axis.y);
            if (s * axisSine == 0) return;
            const double across = std::atan2(s, mu) - std::atan2(axisSine, lobe.axis.z);
            add(lobe.axis.x / axisSine, lobe.axis.y / axisSine,
                acosh1((across * across + lobe.width * lobe.width) / (s * axisSine)));
            return;
        }
        // Off the peak by `away` along the wide axis, the narrow one has grown by hypot(1, away /
        // spread) only; `across` is what that makes of the width, times mu + mu_o.
        const double woSine = std::hypot(wo.x, wo.y), heights = mu + wo.z;
        const double ratio = lobe.spread > lobe.width ? lobe.width / lobe.spread : 1;
        const double away = (s - woSine) * ratio, across = lobe.width * heights;
        if (s * woSine > 0)
            add(-wo.x / woSine, -wo.y / woSine,
                acosh1((away * away + across * across) / (s * woSine)));
        if (ratio == 1) return;
        // An anisotropic lobe varies with phi even about the pole: with slope t on the ring,
        // 1 + t^2 (cos^2 phi / spread^2 + sin^2 phi / width^2) vanishes at phi = i asinh(…) off
        // one of its axes.
        const double reach = lobe.spread * heights / (s + woSine);
        const double scale =
            std::asinh(ratio * std::sqrt((1 + reach * reach) / (1 - ratio * ratio)));
        for (const auto& [x, y] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) add(x, y, scale);
    }

    const AzimuthPeak* narrowest(bool even) const {
        const AzimuthPeak* best = nullptr;
        for (const AzimuthPeak& peak : peaks_) {
            if (even && peak.y != 0) continue;
            if (!best || peak.scale < best->scale) best = &peak;
        }
        return best;
    }
    double scale() const {
        double least = 1;  // what a BRDF without lobes is taken to need
        for (const AzimuthPeak& peak : peaks_) least = std::min(least, peak.scale);
        return least;
    }
    /// What the least scale becomes where azimuths are squeezed about `centre`: with
    /// tan((difference + i scale) / 2) / kappa = u + i v, the imaginary part of 2 atan(u + i v).
    double scaleAbout(const AzimuthPeak& centre, double kappa) const {
        double least = 2 * std::atanh(kappa);  // cos(m phi) has poles there
        for (const AzimuthPeak& peak : peaks_) {
            const double cosine = centre.x * peak.x + centre.y * peak.y;
            const double sine = centre.x * peak.y - centre.y * peak.x;
            const double below = (cosine + std::cosh(peak.scale)) * kappa;
            const double u = sine / below, v = std::sinh(peak.scale) / below;
            least = std::min(
                least, 0.5 * std::log((u * u + (1 + v) * (1 + v)) / (u * u + (1 - v) * (1 - v))));
        }
        return least;
    }

private:
    std::vector<AzimuthPeak> peaks_;
};

AzimuthPeaks azimuthPeaks(const std::vector<Lobe>& lobes, const Direction& wo, double a, double b) {
    AzimuthPeaks peaks;
    const auto visit = [&](double u) {
        const double mu = u * u, s = std::sqrt((1 - mu) * (1 + mu));
        for (const Lobe& lobe : lobes) peaks.addLobe(lobe, wo, s, mu);
    };
    visit(a);
    visit(b);
    for (const Lobe& lobe : lobes) {
        const double peak = lobe.about == Lobe::About::axis ? lobe.axis.z : wo.z;
        const double u = std::sqrt(std::clamp(peak, 0.0, 1.0));
        if (u > a && u < b) visit(u);
    }
    return peaks;
}

void spreadAzimuths(HemisphereGrid::Panel& panel, const AzimuthPeaks& peaks,
                    const GridOptions& options, double refinement) {
    // Products with the highest basis function need `order` more than the lobe alone. At least 8
    // and `order` of the rest grow with the level, so that no two levels use the same azimuths.
    const double order = options.order;
    const double smooth = order + std::max(order, 8.0) * refinement;
    const auto needed = [&](double scale, double kappa) {
        return std::max(smooth / kappa, order / kappa + firstAzimuthExponent / scale * refinement);
    };
    double count = needed(peaks.scale(), 1);
    const AzimuthPeak* centre = options.squeezed ? peaks.narrowest(options.even) : nullptr;
    if (centre) {
        constexpr int maxSqueeze = 24;
        constexpr double worthIt = 0.9;  // sums of squeezed rings cost a little more
        double least = worthIt * count;
        for (int squeeze = 1; squeeze <= maxSqueeze; ++squeeze) {
            const double kappa = std::ldexp(1.0, -squeeze);
            if (smooth / kappa >= least) break;
            const double squeezed = needed(peaks.scaleAbout(*centre, kappa), kappa);
            if (squeezed >= least) continue;
            count = least = squeezed;
            panel.spacing.squeeze = squeeze;
            panel.centreX = centre->x;
            panel.centreY = centre->y;
        }
    }
    const auto whole =
        static_cast<std::size_t>(std::min(std::ceil(count), static_cast<double>(maxAzimuths)));
    panel.spacing.azimuths = (whole + 3) / 4 * 4;
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

std::size_t HemisphereGrid::points() const {
    std::size_t total = 0;
    for (const Panel& panel : panels) total += panel.rings * panel.spacing.azimuths;
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

void appendPanel(HemisphereGrid& grid, double a, double b, const std::vector<Lobe>& lobes,
                 const Direction& wo, const GridOptions& options) {
    const double refinement = std::pow(levelGrowth, options.level), half = 0.5 * (b - a);
    // Basis functions are polynomials of degree 2 order in u: half as many nodes, by length.
    const int nodes =
        static_cast<int>(std::ceil(firstNodes * refinement + options.order * (b - a) * 1.3));
    const GaussRule& rule = gaussLegendre(nodes);
    grid.panels.push_back({grid.weights.size(), static_cast<std::size_t>(nodes)});
    spreadAzimuths(grid.panels.back(), azimuthPeaks(lobes, wo, a, b), options, refinement);
    for (int i = 0; i < nodes; ++i) {
        const double u = a + half * (1 + rule.nodes[i]);
        const double mu = u * u, oneMinusMu = (1 - u) * (1 + u);
        grid.elevations.push_back({mu, oneMinusMu});
        grid.sines.push_back(std::sqrt(oneMinusMu * (1 + mu)));
        grid.weights.push_back(2 * u * half * rule.weights[i]);
    }
}

HemisphereGrid gridFor(const std::vector<Lobe>& lobes, const Direction& wo,
                       const GridOptions& options) {
    const std::vector<double> breaks = panelBreaks(lobes, wo);
    HemisphereGrid grid;
    for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
        appendPanel(grid, breaks[k], breaks[k + 1], lobes, wo, options);
    }
    return grid;
}

}  // namespace hshfit
