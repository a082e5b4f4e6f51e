#include <hshfit/normal_filtering/filtered_texel.h>

#include <hshfit/bases/sh.h>
#include <hshfit/error.h>
#include <hshfit/normal_filtering/surface_frame.h>

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline normal_filtering {
namespace {

double standardDensity(double x) {
    return std::exp(-x * x / 2) / std::sqrt(2 * pi);
}
double standardShare(double x) {
    return 0.5 * std::erfc(-x / std::sqrt(2.0));
}

/// E[max(0, X)] of a Gaussian variable.
double meanAboveZero(double mean, double variance) {
    const double deviation = std::sqrt(std::max(variance, 0.0));
    if (!(deviation > 1e-9)) return std::max(mean, 0.0);
    const double at = mean / deviation;
    return mean * standardShare(at) + deviation * standardDensity(at);
}

/// Mean and squares of a channel's normals from its nine coefficients.
struct NormalMoments {
    double albedo;
    Direction mean;
    double xx, yy, zz, xy, yz, xz;

    explicit NormalMoments(const double* c) {
        albedo = c[0] * std::sqrt(4 * pi);
        if (!(albedo > 0)) {
            albedo = 0;
            return;
        }
        const double first = 1 / (albedo * std::sqrt(3 / (4 * pi)));
        const double second = 1 / (albedo * 0.5 * std::sqrt(15 / pi));
        mean = {c[3] * first, c[1] * first, c[2] * first};
        xy = c[4] * second;
        yz = c[5] * second;
        xz = c[7] * second;
        zz = (c[6] / (albedo * 0.25 * std::sqrt(5 / pi)) + 1) / 3;
        const double difference = c[8] * 2 * second;  // xx - yy
        xx = (1 - zz + difference) / 2;
        yy = (1 - zz - difference) / 2;
    }
    double covariance(const Direction& a, const Direction& b) const {
        const double product = xx * a.x * b.x + yy * a.y * b.y + zz * a.z * b.z +
                               xy * (a.x * b.y + a.y * b.x) + yz * (a.y * b.z + a.z * b.y) +
                               xz * (a.x * b.z + a.z * b.x);
        return product - dot(mean, a) * dot(mean, b);
    }
};

/// A direction below the horizon, or nearly so, as one just above it.
Direction aboveHorizon(const Direction& d) {
    constexpr double least = 1e-3;
    return d.z >= least ? d : normalised({d.x, d.y, least});
}

/// E[max(0, X) [Y > 0]]: the probability of Y > 0 times the mean for X given Y > 0, taken as
/// Gaussian of its own mean and variance.
double meanOfBothAbove(const NormalMoments& m, const Direction& wi, const Direction& wo) {
    const double x = dot(m.mean, wi), y = dot(m.mean, wo);
    const double xx = m.covariance(wi, wi), yy = m.covariance(wo, wo);
    if (!(yy > 1e-18)) return y > 0 ? meanAboveZero(x, xx) : 0;
    const double deviation = std::sqrt(yy), at = y / deviation, share = standardShare(at);
    if (share < 1e-12) return 0;
    const double xy = m.covariance(wi, wo), ratio = standardDensity(at) / share;
    return share *
           meanAboveZero(x + xy / deviation * ratio, xx - xy * xy / yy * ratio * (ratio + at));
}

}  // namespace

FilteredTexel::FilteredTexel(const MipLayout& layout, std::span<const double> texel,
                             const LobeTable& table, std::shared_ptr<const Basis> basis)
    : layout_(layout),
      numbers_(texel.begin(), texel.end()),
      table_(&table),
      basis_(std::move(basis)) {
    if (texel.size() != layout.size() && texel.size() != layout.ellipseSize())
        throw UsageError(
            fmt::format("{} numbers for a filtered texel of {}", texel.size(), layout.size()));
    if (texel.size() == layout.size() && (!basis_ || basis_->order() != layout.order))
        basis_ = bases::makeSh(layout.order, {});
    const double* n = &numbers_[MipLayout::normal];
    const Direction sum{n[0], n[1], n[2]};
    length_ = std::sqrt(dot(sum, sum));
    normal_ = length_ > 1e-6 ? normalised(sum) : Direction{0, 0, 1};
    lobe_ = {numbers_[MipLayout::lobe], numbers_[MipLayout::lobe + 1]};
    const double* u = &numbers_[MipLayout::plane];
    const double* squares = &numbers_[MipLayout::planeSquares];
    const double xx = std::max(0.0, squares[0] - u[0] * u[0]);
    const double yy = std::max(0.0, squares[2] - u[1] * u[1]);
    const double most = std::sqrt(xx * yy);
    covariance_ = {xx, std::clamp(squares[1] - u[0] * u[1], -most, most), yy};
}

/// The widths with their axes turned by an angle.
std::array<double, 3> FilteredTexel::turnedWidths(double angle) const {
    const double* w = &numbers_[MipLayout::widths];
    const double c = std::cos(2 * angle), s = std::sin(2 * angle);
    const double mean = (w[0] + w[2]) / 2, half = (w[0] - w[2]) / 2;
    const double x = half * c - w[1] * s;
    return {mean + x, half * s + w[1] * c, mean - x};
}

FilteredTexel::Facets FilteredTexel::facets(const Direction& half) const {
    const double* m = &numbers_[MipLayout::plane];
    const auto& [cxx, cxy, cyy] = covariance_;
    const PlanePoint u = toPlane(half.z < 0 ? -half : half);
    const double dx = u[0] - m[0], dy = u[1] - m[1];
    // As complex numbers, h has the place (u - m) / (1 + conj(m) u / 4) in the plane about m: seen
    // from u, the axes of D are turned by the angle of the denominator.
    const std::array<double, 3> width =
        turnedWidths(std::atan2(m[0] * u[1] - m[1] * u[0], 4 + m[0] * u[0] + m[1] * u[1]));
    const double scale =
        (1 + (u[0] * u[0] + u[1] * u[1]) / 4) * (1 + (m[0] * m[0] + m[1] * m[1] + cxx + cyy) / 4);
    const GaussianSum& sum = table_->gaussians(lobe_);
    Facets f{};
    for (std::size_t j = 0; j < sum.peaks.size(); ++j) {
        const double v = sum.variances[j] * scale;
        const double sxx = cxx + v * width[0], sxy = cxy + v * width[1], syy = cyy + v * width[2];
        const double determinant = sxx * syy - sxy * sxy;
        if (!(determinant > 0)) continue;
        const double gx = (syy * dx - sxy * dy) / determinant,
                     gy = (sxx * dy - sxy * dx) / determinant;
        const double value =
            sum.peaks[j] * v / std::sqrt(determinant) * std::exp(-(gx * dx + gy * dy) / 2);
        // Given h, the normals of this Gaussian: mean m + C S^-1 (u - m), covariance C - C S^-1 C.
        const double x = cxx * gx + cxy * gy, y = cxy * gx + cyy * gy;
        const double kxx = (cxx * syy - cxy * sxy) / determinant,
                     kxy = (cxy * sxx - cxx * sxy) / determinant,
                     kyx = (cxy * syy - cyy * sxy) / determinant,
                     kyy = (cyy * sxx - cxy * sxy) / determinant;
        f.density += value;
        f.x += value * x;
        f.y += value * y;
        f.xx += value * (cxx - kxx * cxx - kxy * cxy + x * x);
        f.xy += value * (cxy - kxx * cxy - kxy * cyy + x * y);
        f.yy += value * (cyy - kyx * cxy - kyy * cyy + y * y);
    }
    if (f.density > 0) {
        f.x /= f.density;
        f.y /= f.density;
        f.xx = f.xx / f.density - f.x * f.x;
        f.xy = f.xy / f.density - f.x * f.y;
        f.yy = f.yy / f.density - f.y * f.y;
    }
    f.x += m[0];
    f.y += m[1];
    return f;
}

void FilteredTexel::density(const MipUse& use, const Direction& h, std::span<double> out) const {
    if (use.form == MipForm::ellipse) {
        const double value = facets(h).density;
        for (std::size_t k = 0; k < out.size(); ++k)
            out[k] = value * numbers_[MipLayout::weight + k];
        return;
    }
    if (numbers_.size() < layout_.size())
        throw UsageError("a filtered texel without harmonics has the ellipse alone");
    const int used = use.order == 0 ? layout_.order : std::min(use.order, layout_.order);
    std::vector<double> y(static_cast<std::size_t>(basis_->slots()));
    basis_->evaluate(h, y.data());
    for (std::size_t k = 0; k < out.size(); ++k) {
        const double* c = &numbers_[layout_.harmonics(static_cast<int>(k))];
        double sum = 0;
        for (int l = 0; l < used; l += 2) {
            const double* band = &y[static_cast<std::size_t>(l * l)];
            for (int i = 0; i < 2 * l + 1; ++i) sum += *c++ * band[i];
        }
        out[k] = std::max(sum, 0.0);
    }
}

std::array<Direction, 4> FilteredTexel::normalsGiven(const Direction& h) const {
    const Facets f = facets(h);
    // Along the axes of the covariance, at sqrt(2) deviations on either side: four points of equal
    // shares with that mean and covariance.
    const double angle = 0.5 * std::atan2(2 * f.xy, f.xx - f.yy);
    const double mean = (f.xx + f.yy) / 2, half = std::hypot((f.xx - f.yy) / 2, f.xy);
    const double longer = std::sqrt(2 * std::max(0.0, mean + half)),
                 shorter = std::sqrt(2 * std::max(0.0, mean - half));
    const double c = std::cos(angle), s = std::sin(angle);
    return {fromPlane({f.x + longer * c, f.y + longer * s}),
            fromPlane({f.x - longer * c, f.y - longer * s}),
            fromPlane({f.x - shorter * s, f.y + shorter * c}),
            fromPlane({f.x + shorter * s, f.y - shorter * c})};
}

Direction FilteredTexel::tangentAt(const Direction& n) const {
    const double* width = &numbers_[MipLayout::widths];
    // The longer axis of the ellipse, which is y where the lobe is narrower along x.
    const auto [x, y] = table_->widths(lobe_);
    const double angle = 0.5 * std::atan2(2 * width[1], width[0] - width[2]) + (x < y ? pi / 2 : 0);
    return fromPlaneDirection(toPlane(n), {std::cos(angle), std::sin(angle)});
}

void FilteredTexel::diffuse(const Direction& wi, const Direction& wo, std::span<double> out) const {
    for (std::size_t k = 0; k < out.size(); ++k) {
        const NormalMoments m(&numbers_[layout_.albedo(static_cast<int>(k))]);
        out[k] = m.albedo > 0 ? m.albedo * meanOfBothAbove(m, wi, wo) : 0;
    }
}

void FilteredTexel::reflect(const MipUse& use, const Rest& rest, const Direction& wi,
                            const Direction& wo, std::span<double> out, const Shape& shape) const {
    std::fill(out.begin(), out.end(), 0.0);
    if (layout_.albedos > 0) {
        double diffuse[SurfaceTexel::most];
        this->diffuse(wi, wo, {diffuse, static_cast<std::size_t>(layout_.albedos)});
        double scale = 1 / pi;
        if (shape) {
            const SurfaceFrame frame(normal_, tangentAt(normal_));
            scale *= shape(*this, aboveHorizon(frame.toLocal(wi)), aboveHorizon(frame.toLocal(wo)));
        }
        for (std::size_t c = 0; c < out.size(); ++c)
            out[c] = diffuse[layout_.albedos == 1 ? 0 : c] * scale;
    }
    const Direction sum = wi + wo;
    if (layout_.weights == 0 || !(dot(sum, sum) > 1e-20)) return;
    const Direction h = normalised(sum);
    double density[SurfaceTexel::most];
    const std::span<const double> densities(density, static_cast<std::size_t>(layout_.weights));
    this->density(use, h, {density, densities.size()});
    std::vector<double> part(out.size());
    const auto add = [&](const Direction& n, double share) {
        if (!(dot(n, wi) > 0) || !(dot(n, wo) > 0)) return;
        const SurfaceFrame frame(n, tangentAt(n));
        std::fill(part.begin(), part.end(), 0.0);
        rest(*this, frame.toLocal(wi), frame.toLocal(wo), densities, part);
        for (std::size_t c = 0; c < out.size(); ++c) out[c] += share * part[c];
    };
    if (!use.facets) return add(normal_, 1);
    for (const Direction& n : normalsGiven(h)) add(n, 0.25);
}

}  // namespace hshfit::inline normal_filtering
