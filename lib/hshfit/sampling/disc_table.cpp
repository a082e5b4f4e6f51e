#include <hshfit/sampling/disc_table.h>

#include <hshfit/sampling/internal/elevation_bins.h>
#include <hshfit/sampling/internal/folded.h>
#include <hshfit/sampling/internal/mirror_cells.h>
#include <hshfit/sampling/internal/target.h>
#include <hshfit/stop_request.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace hshfit::inline sampling {
namespace {

/// Distributions of one bin: cumulative over rows and, in every row, over columns.
struct Distribution {
    std::vector<double> rows;    ///< [rows + 1]
    std::vector<float> columns;  ///< [rows][columns + 1]
};

Distribution distributionOf(const std::vector<double>& mass, const MirrorCells& cells) {
    Distribution result;
    result.rows.push_back(0);
    const std::size_t n = cells.columns();
    for (std::size_t r = 0; r < cells.rows(); ++r) {
        double sum = 0;
        for (std::size_t c = 0; c < n; ++c) sum += mass[r * n + c];
        double part = 0;
        for (std::size_t c = 0; c <= n; ++c) {
            const double even = static_cast<double>(c) / static_cast<double>(n);
            result.columns.push_back(
                static_cast<float>(sum > 0 ? std::min(1.0, part / sum) : even));
            if (c < n) part += mass[r * n + c];
        }
        result.columns.back() = 1;
        result.rows.push_back(result.rows.back() + sum);
    }
    const double total = result.rows.back();
    for (std::size_t r = 0; r < result.rows.size(); ++r)
        result.rows[r] = total > 0 ? result.rows[r] / total : cells.radii[r];
    result.rows.back() = 1;
    return result;
}

class DiscTable final : public Sampler {
public:
    DiscTable(const Brdf& brdf, const DiscTableOptions& options)
        : elevations_(options.elevations),
          azimuths_(brdf.laws().isotropic ? 1 : options.azimuths),
          cells_(options.columns),
          bins_(elevations_ * azimuths_) {
        tbb::parallel_for(std::size_t{0}, bins_.size(), [&](std::size_t bin) {
            stopIfRequested();
            fill(brdf, bin);
        });
    }

    std::string_view name() const override { return "table"; }

    Sample sample(const Direction& wo, const Uniforms& u) const override {
        if (!(wo.z > 0)) return {};
        const Distribution& bin = bins_[binOf(wo)];
        const std::size_t r = MirrorCells::at(bin.rows, u[0]);
        const float* columns = bin.columns.data() + r * (cells_.columns() + 1);
        const std::span<const float> row(columns, cells_.columns() + 1);
        const std::size_t c = MirrorCells::at(row, u[1]);
        const double y = (u[0] - bin.rows[r]) / (bin.rows[r + 1] - bin.rows[r]);
        const double x = (u[1] - row[c]) / (static_cast<double>(row[c + 1]) - row[c]);
        const double a = cells_.radii[r], b = cells_.radii[r + 1];
        const double share = std::sqrt(a * a + y * (b - a) * (b + a));
        const double psi = std::lerp(cells_.angles[c], cells_.angles[c + 1], x);
        const Direction wi =
            MirrorPolar(wo).direction(std::min(share, 1.0), std::cos(psi), std::sin(psi));
        return {wi, pdf(wo, wi)};
    }

    double pdf(const Direction& wo, const Direction& wi) const override {
        if (!aboveHorizon(wo, wi)) return 0;
        const MirrorPolar::Place at = MirrorPolar(wo).place(wi);
        const Distribution& bin = bins_[binOf(wo)];
        const std::size_t r = cells_.rowOf(at.share), c = cells_.columnOf(at.psi);
        const float* columns = bin.columns.data() + r * (cells_.columns() + 1);
        const double mass =
            (bin.rows[r + 1] - bin.rows[r]) * (static_cast<double>(columns[c + 1]) - columns[c]);
        return mass / (cells_.area(r, c) * at.reach * at.reach) * wi.z;
    }

private:
    std::size_t binOf(const Direction& wo) const {
        const std::size_t elevation = elevationBin(wo, elevations_);
        if (azimuths_ == 1) return elevation;
        const double turn = (azimuth(wo) + pi) / (2 * pi) * static_cast<double>(azimuths_);
        return elevation * azimuths_ + static_cast<std::size_t>(turn) % azimuths_;
    }

    void fill(const Brdf& brdf, std::size_t bin) {
        const double phi = azimuths_ == 1 ? 0
                                          : (static_cast<double>(bin % azimuths_) + 0.5) * 2 * pi /
                                                    static_cast<double>(azimuths_) -
                                                pi;
        std::vector<double> mass(cells_.rows() * cells_.columns());
        constexpr double places[] = {1. / 6, .5, 5. / 6};
        for (const double place : places) {
            const double s =
                (static_cast<double>(bin / azimuths_) + place) / static_cast<double>(elevations_);
            addValues(brdf, directionOfBin(s, phi), mass);
        }
        bins_[bin] = distributionOf(mass, cells_);
    }

    /// Adds f times the projected area, over the integral of this, for one wo.
    void addValues(const Brdf& brdf, const Direction& wo, std::vector<double>& mass) const {
        const MirrorPolar polar(wo);
        const std::size_t n = cells_.columns(), channels = brdf.channels().count();
        std::vector<double> own(mass.size()), x(n), y(n), z(n), f(n * channels);
        double total = 0;
        for (std::size_t r = 0; r < cells_.rows(); ++r) {
            // Outer rows are wide enough for two places.
            const int places = cells_.radii[r] >= 0x1p-6 ? 2 : 1;
            for (int place = 0; place < places; ++place) {
                const double share =
                    std::lerp(cells_.radii[r], cells_.radii[r + 1], (place + 0.5) / places);
                std::vector<double> reach(n);
                for (std::size_t c = 0; c < n; ++c) {
                    const double psi = 0.5 * (cells_.angles[c] + cells_.angles[c + 1]);
                    const double cosine = std::cos(psi);
                    const Direction wi = polar.direction(share, cosine, std::sin(psi));
                    x[c] = wi.x, y[c] = wi.y, z[c] = wi.z, reach[c] = polar.reach(cosine);
                }
                std::ranges::fill(f, 0.0);
                brdf.eval(wo, {x.data(), y.data(), z.data(), n}, f.data());
                for (std::size_t c = 0; c < n; ++c) {
                    const double value = meanMagnitude(f, c, n, channels) * cells_.area(r, c) *
                                         reach[c] * reach[c] / places;
                    own[r * n + c] += value;
                    total += value;
                }
            }
        }
        if (!(total > 0)) return;
        for (std::size_t k = 0; k < mass.size(); ++k) mass[k] += own[k] / total;
    }

    std::size_t elevations_, azimuths_;
    MirrorCells cells_;
    std::vector<Distribution> bins_;
};

}  // namespace

std::shared_ptr<const Sampler> tabulate(const Brdf& brdf, const DiscTableOptions& options) {
    return std::make_shared<DiscTable>(brdf, options);
}

}  // namespace hshfit::inline sampling
