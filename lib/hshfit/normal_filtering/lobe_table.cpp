#include <hshfit/normal_filtering/lobe_table.h>

#include <hshfit/bases/sh.h>
#include <hshfit/error.h>
#include <hshfit/normal_filtering/internal/gaussian_sum.h>
#include <hshfit/quadrature/quadrature.h>

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline normal_filtering {
namespace {

/// Elevations with weights d mu over the hemisphere: Gauss-Legendre in theta on panels that grow by
/// a half, from a small part of the lobe's width on; exact for bands up to a few hundred.
struct Rings {
    std::vector<Elevation<double>> elevations;
    std::vector<double> sines, weights;
};
Rings ringsFor(double width) {
    Rings rings;
    const GaussRule& rule = gaussLegendre(24);
    double from = 0, to = std::min(width / 4, pi / 2);
    while (from < pi / 2) {
        for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
            const double theta = from + (to - from) * (1 + rule.nodes[k]) / 2;
            const double sine = std::sin(theta), half = std::sin(theta / 2);
            rings.elevations.push_back({std::cos(theta), 2 * half * half});
            rings.sines.push_back(sine);
            rings.weights.push_back(rule.weights[k] * (to - from) / 2 * sine);
        }
        from = to;
        // Panels of at most 0.2 keep 24 nodes for two waves of band 300.
        to = std::min({pi / 2, to + std::min(0.5 * to, 0.2)});
    }
    return rings;
}

double valueAt(const NormalDistribution& d, const Direction& h, std::size_t row,
               std::size_t column) {
    const double value = d.density(h);
    if (!(value >= 0) || !std::isfinite(value))
        throw InputError(fmt::format(
            "the normal distribution of row {}, column {} is {} at ({:.6g}, {:.6g}, {:.6g}); it "
            "has to be finite and not negative",
            row, column, value, h.x, h.y, h.z));
    return value;
}

/// D by azimuth: sums over a ring times the azimuth functions of |m| < order, [order - 1 + m].
void ringMoments(const NormalDistribution& d, double sine, double mu, int order, bool isotropic,
                 std::size_t row, std::size_t column, std::vector<double>& out) {
    std::fill(out.begin(), out.end(), 0.0);
    // Azimuths of an anisotropic D cluster where it is long; 1/ratio as many are needed.
    const double ratio = std::max(d.widthX, d.widthY) / std::min(d.widthX, d.widthY);
    const int azimuths = isotropic ? 1 : 4 * static_cast<int>(order + 8 * std::ceil(ratio));
    std::vector<double> parts(static_cast<std::size_t>(2 * order - 1));
    for (int k = 0; k < azimuths; ++k) {
        const double phi = 2 * pi * (k + (isotropic ? 0.0 : 0.5)) / azimuths;
        const Direction h{sine * std::cos(phi), sine * std::sin(phi), mu};
        const double value = valueAt(d, h, row, column) * 2 * pi / azimuths;
        if (isotropic) {
            out[static_cast<std::size_t>(order - 1)] = value / std::sqrt(2 * pi);
            return;
        }
        azimuthParts(h, order, false, parts.data());
        for (std::size_t i = 0; i < parts.size(); ++i) out[i] += value * parts[i];
    }
}

/// Coefficients in slots of the even continuation of D.
std::vector<double> project(const NormalDistribution& d, const Basis& basis, bool isotropic,
                            std::size_t row, std::size_t column) {
    const int order = basis.order();
    const Rings rings = ringsFor(std::min(d.widthX, d.widthY));
    const std::size_t count = rings.weights.size(),
                      azimuths = static_cast<std::size_t>(2 * order - 1);
    std::vector<double> moments(count * azimuths), ring(azimuths);
    for (std::size_t k = 0; k < count; ++k) {
        ringMoments(d, rings.sines[k], rings.elevations[k].mu, order, isotropic, row, column, ring);
        for (std::size_t i = 0; i < azimuths; ++i)
            // Twice: the lower hemisphere has the same share in even bands.
            moments[i * count + k] = 2 * rings.weights[k] * ring[i];
    }
    std::vector<double> c(static_cast<std::size_t>(order * order), 0.0);
    std::vector<double> theta(static_cast<std::size_t>(order) * count);
    for (int m = 0; m < (isotropic ? 1 : order); ++m) {
        basis.theta(m, rings.elevations, theta.data());
        for (const int sign : {1, -1}) {
            if (m == 0 && sign < 0) continue;
            const double* f =
                moments.data() + static_cast<std::size_t>(order - 1 + sign * m) * count;
            for (int l = m + m % 2; l < order; l += 2) {
                const double* t = theta.data() + static_cast<std::size_t>(l - m) * count;
                double sum = 0;
                for (std::size_t k = 0; k < count; ++k) sum += t[k] * f[k];
                c[static_cast<std::size_t>(slotOf(l, sign * m))] = sum;
            }
        }
    }
    return c;
}

std::vector<double> zonalOf(const std::vector<double>& c, int order) {
    std::vector<double> zonal;
    for (int l = 0; l < order; l += 2) zonal.push_back(c[static_cast<std::size_t>(slotOf(l, 0))]);
    return zonal;
}

}  // namespace

LobeTable::LobeTable(std::size_t rows, std::size_t columns, const Make& make,
                     const LobeTableOptions& options)
    : rows_(rows), columns_(columns), order_(options.order) {
    if (rows == 0 || columns == 0)
        throw UsageError("a table of normal distributions needs at least one entry");
    if (order_ < 3 || order_ > 301 || order_ % 2 == 0)
        throw UsageError(fmt::format(
            "order {} of normal distributions: an odd number from 3 to 301 is needed", order_));
    std::vector<NormalDistribution> all;
    for (std::size_t row = 0; row < rows; ++row) {
        for (std::size_t column = 0; column < columns; ++column) {
            all.push_back(make(row, column));
            const NormalDistribution& d = all.back();
            if (!(d.widthX > 0) || !(d.widthY > 0) || !std::isfinite(d.widthX + d.widthY))
                throw InputError(fmt::format(
                    "the normal distribution of row {}, column {} has the widths {} and {}; they "
                    "have to be positive",
                    row, column, d.widthX, d.widthY));
            isotropic_ = isotropic_ && d.widthX == d.widthY;
        }
    }
    const auto basis = bases::makeSh(order_, {});
    for (std::size_t k = 0; k < all.size(); ++k) {
        std::vector<double> c = project(all[k], *basis, isotropic_, k / columns, k % columns);
        if (!(c[0] > 0))
            throw InputError(fmt::format("the normal distribution of row {}, column {} is 0",
                                         k / columns, k % columns));
        entries_.push_back({{all[k].widthX, all[k].widthY},
                            isotropic_ ? zonalOf(c, order_) : std::move(c),
                            fitGaussians(all[k])});
    }
}

std::array<LobeTable::Corner, 4> LobeTable::corners(const LobePlace& place) const {
    const auto split = [](double at, std::size_t count, std::size_t& low, double& share) {
        const double clamped = std::clamp(at, 0.0, static_cast<double>(count - 1));
        low = std::min(static_cast<std::size_t>(clamped), count > 1 ? count - 2 : 0);
        share = clamped - static_cast<double>(low);
    };
    std::size_t row = 0, column = 0;
    double down = 0, right = 0;
    split(place[0], rows_, row, down);
    split(place[1], columns_, column, right);
    const std::size_t below = std::min(row + 1, rows_ - 1),
                      beside = std::min(column + 1, columns_ - 1);
    return {{{&entries_[row * columns_ + column], (1 - down) * (1 - right)},
             {&entries_[row * columns_ + beside], (1 - down) * right},
             {&entries_[below * columns_ + column], down * (1 - right)},
             {&entries_[below * columns_ + beside], down * right}}};
}

void LobeTable::zonal(const LobePlace& place, std::span<double> out) const {
    if (!isotropic_) throw UsageError("an anisotropic table has no zonal coefficients");
    std::fill(out.begin(), out.end(), 0.0);
    for (const Corner& corner : corners(place)) {
        if (corner.share == 0) continue;
        const std::size_t count = std::min(out.size(), corner.entry->coefficients.size());
        for (std::size_t l = 0; l < count; ++l)
            out[l] += corner.share * corner.entry->coefficients[l];
    }
}

void LobeTable::coefficients(const LobePlace& place, std::span<double> out) const {
    std::fill(out.begin(), out.end(), 0.0);
    for (const Corner& corner : corners(place)) {
        if (corner.share == 0) continue;
        const std::vector<double>& c = corner.entry->coefficients;
        for (std::size_t i = 0; i < c.size(); ++i) {
            const auto l = static_cast<int>(2 * i);
            const std::size_t slot = isotropic_ ? static_cast<std::size_t>(slotOf(l, 0)) : i;
            if (slot < out.size()) out[slot] += corner.share * c[i];
        }
    }
}

std::array<double, 2> LobeTable::widths(const LobePlace& place) const {
    std::array<double, 2> mean{};
    for (const Corner& corner : corners(place))
        for (std::size_t a = 0; a < 2; ++a) mean[a] += corner.share * corner.entry->widths[a];
    return mean;
}

const GaussianSum& LobeTable::gaussians(const LobePlace& place) const {
    const auto all = corners(place);
    return std::max_element(all.begin(), all.end(),
                            [](const Corner& a, const Corner& b) { return a.share < b.share; })
        ->entry->gaussians;
}

double LobeTable::truncation(const LobePlace& place, int order) const {
    std::vector<double> c(static_cast<std::size_t>(order_ * order_));
    coefficients(place, c);
    double all = 0, tail = 0;
    for (std::size_t i = 0; i < c.size(); ++i) {
        all += c[i] * c[i];
        if (i >= static_cast<std::size_t>(order * order)) tail += c[i] * c[i];
    }
    return std::sqrt(tail / all);
}

}  // namespace hshfit::inline normal_filtering
