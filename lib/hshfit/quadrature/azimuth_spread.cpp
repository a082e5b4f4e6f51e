#include <hshfit/quadrature/azimuth_spread.h>

#include <algorithm>
#include <complex>

namespace hshfit::inline quadrature {
namespace {

using Complex = std::complex<double>;

/// Enough at the coarsest level for 3e-4 or so.
constexpr double firstAzimuthExponent = 10;
constexpr std::size_t maxAzimuths = std::size_t{1} << 22;

}  // namespace

AzimuthPeaks::AzimuthPeaks(const std::vector<Lobe>& lobes, const Direction& wo, double a,
                           double b) {
    const auto visit = [&](const Lobe& lobe, double u) {
        const double mu = u * u, s = std::sqrt((1 - mu) * (1 + mu));
        addLobe(lobe, wo, s, mu);
    };
    // A lobe is narrowest on its own ring: the rings of other lobes tell nothing more about it.
    for (const double end : {a, b})
        for (const Lobe& lobe : lobes) visit(lobe, end);
    for (const Lobe& lobe : lobes) {
        const double peak = lobe.about == Lobe::About::axis ? lobe.axis.z : wo.z;
        const double u = std::sqrt(std::clamp(peak, 0.0, 1.0));
        if (u > a && u < b) visit(lobe, u);
    }
}

void AzimuthPeaks::add(double x, double y, double scale) {
    constexpr double together = 1 - 1e-12, farOff = 20;
    if (!(scale < farOff)) return;
    for (Peak& peak : peaks_) {
        if (peak.x * x + peak.y * y > together) {
            peak.scale = std::min(peak.scale, scale);
            return;
        }
    }
    peaks_.push_back({x, y, scale});
}

/// On the ring (s, mu): acosh(1 + q/2), where q is the squared distance in the plane of incidence
/// over s s'; none at the pole, where f does not depend on phi.
void AzimuthPeaks::addLobe(const Lobe& lobe, const Direction& wo, double s, double mu) {
    const auto acosh1 = [](double q) { return 2 * std::asinh(std::sqrt(q) / 2); };
    if (lobe.about == Lobe::About::axis) {
        const double axisSine = std::hypot(lobe.axis.x, lobe.axis.y);
        if (s * axisSine == 0) return;
        const double across = std::atan2(s, mu) - std::atan2(axisSine, lobe.axis.z);
        add(lobe.axis.x / axisSine, lobe.axis.y / axisSine,
            acosh1((across * across + lobe.width * lobe.width) / (s * axisSine)));
        return;
    }
    const double woSine = std::hypot(wo.x, wo.y);
    if (s * woSine == 0) return;
    if (lobe.spread > lobe.width && addAnisotropic(lobe, wo, s, mu)) return;
    const double away = s - woSine, across = lobe.width * (mu + wo.z);
    add(-wo.x / woSine, -wo.y / woSine, acosh1((away * away + across * across) / (s * woSine)));
}

void AzimuthPeaks::addRoot(double re, double im) {
    const double size = std::hypot(re, im);
    if (!(size > 0) || !std::isfinite(size)) return;
    // Symmetric lobes: on the axis but for rounding.
    constexpr double rounding = 1e-9;
    const double scale = std::abs(std::log(size));
    if (std::abs(im) < rounding * size) {
        add(re < 0 ? -1 : 1, 0, scale);
    } else {
        add(re / size, im / size, scale);
    }
}

/// A half-vector lobe of widths w along x and v along y is singular where
///     ((s cos phi + x_o) / w)^2 + ((s sin phi + y_o) / v)^2 + (mu + mu_o)^2 = 0,
/// times z^2 a polynomial of degree 4 in z = exp(i phi) with two roots inside of the unit circle,
/// and their mirror images outside. One is found by Newton's method, the other from the quotient.
bool AzimuthPeaks::addAnisotropic(const Lobe& lobe, const Direction& wo, double s, double mu) {
    const bool wideX = std::abs(lobe.axis.x) > std::abs(lobe.axis.y);
    const double w = wideX ? lobe.spread : lobe.width, v = wideX ? lobe.width : lobe.spread;
    const double a = s / w, b = s / v, x = wo.x / w, y = wo.y / v, height = mu + wo.z;
    const double ends = (a * a - b * b) / 4;
    const double middle = (a * a + b * b) / 2 + x * x + y * y + height * height;
    const Complex side(a * x, -b * y);
    const auto value = [&](Complex z) {
        return (((ends * z + side) * z + middle) * z + std::conj(side)) * z + ends;
    };
    const auto slope = [&](Complex z) {
        return ((4.0 * ends * z + 3.0 * side) * z + 2.0 * middle) * z + std::conj(side);
    };
    const double woSine = std::hypot(wo.x, wo.y);
    Complex z = -0.9 * Complex(wo.x, wo.y) / woSine;
    constexpr int steps = 60;
    constexpr double close = 1e-7;
    bool found = false;
    for (int k = 0; k < steps && !found; ++k) {
        const Complex change = value(z) / slope(z);
        z -= change;
        found = std::norm(change) <= close * close * std::norm(z);
    }
    if (!found || !(std::abs(z) > 0)) return false;
    addRoot(z.real(), z.imag());
    // (z - z1)(z - 1 / conj z1) divided out leaves ends z^2 + linear z + ends / (z1 / conj z1).
    const Complex partner = 1.0 / std::conj(z), linear = side + ends * (z + partner);
    const Complex constant = ends / (z * partner);
    if (std::abs(linear) == 0) return true;
    const Complex root = std::sqrt(linear * linear - 4.0 * ends * constant);
    const Complex larger = std::real(std::conj(linear) * root) >= 0 ? linear + root : linear - root;
    const Complex other = -2.0 * constant / larger;
    addRoot(other.real(), other.imag());
    return true;
}

const AzimuthPeaks::Peak* AzimuthPeaks::narrowest(bool even) const {
    const Peak* best = nullptr;
    for (const Peak& peak : peaks_) {
        if (even && peak.y != 0) continue;
        if (!best || peak.scale < best->scale) best = &peak;
    }
    return best;
}

double AzimuthPeaks::scale() const {
    double least = 1.25;  // assumed for a BRDF without lobes
    for (const Peak& peak : peaks_) least = std::min(least, peak.scale);
    return least;
}

/// With tan((difference + i scale) / 2) / kappa = u + i v, the imaginary part of 2 atan(u + i v).
double AzimuthPeaks::scaleAbout(const Peak& centre, double kappa) const {
    double least = 2 * std::atanh(kappa);  // cos(m phi) has poles there
    for (const Peak& peak : peaks_) {
        const double cosine = centre.x * peak.x + centre.y * peak.y;
        const double sine = centre.x * peak.y - centre.y * peak.x;
        const double below = (cosine + std::cosh(peak.scale)) * kappa;
        const double u = sine / below, v = std::sinh(peak.scale) / below;
        least = std::min(least,
                         0.5 * std::log((u * u + (1 + v) * (1 + v)) / (u * u + (1 - v) * (1 - v))));
    }
    return least;
}

SpreadAzimuth spreadAzimuth(double t, const AzimuthSpacing& spacing) {
    if (spacing.squeeze == 0) return {std::cos(t), std::sin(t), 1};
    const double kappa = spacing.kappa();
    const double c = std::cos(t / 2), s = kappa * std::sin(t / 2), square = c * c + s * s;
    return {(c - s) * (c + s) / square, 2 * s * c / square, kappa / square};
}

AzimuthSpread spreadAzimuths(const AzimuthPeaks& peaks, const SpreadOptions& options) {
    AzimuthSpread spread;
    // Products with the highest basis function need `order` more than the lobe alone. At least 8
    // and `order` of the rest grow with the level, so that no two levels use the same azimuths.
    const double order = options.order;
    const double smooth = order + std::max(order, 8.0) * options.refinement;
    const auto needed = [&](double scale, double kappa) {
        return std::max(smooth / kappa,
                        order / kappa + firstAzimuthExponent / scale * options.refinement);
    };
    double count = needed(peaks.scale(), 1);
    const AzimuthPeaks::Peak* centre = options.squeezed ? peaks.narrowest(options.even) : nullptr;
    if (centre) {
        constexpr int maxSqueeze = 24;
        constexpr double worthIt = 0.9;  // sums over clustered azimuths cost a little more
        double least = worthIt * count;
        for (int squeeze = 1; squeeze <= maxSqueeze; ++squeeze) {
            const double kappa = std::ldexp(1.0, -squeeze);
            if (smooth / kappa >= least) break;
            const double squeezed = needed(peaks.scaleAbout(*centre, kappa), kappa);
            if (squeezed >= least) continue;
            count = least = squeezed;
            spread.spacing.squeeze = squeeze;
            spread.centreX = centre->x;
            spread.centreY = centre->y;
        }
    }
    const auto whole =
        static_cast<std::size_t>(std::min(std::ceil(count), static_cast<double>(maxAzimuths)));
    spread.spacing.azimuths = (whole + 3) / 4 * 4;
    return spread;
}

}  // namespace hshfit::inline quadrature
