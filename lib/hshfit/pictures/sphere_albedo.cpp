#include <hshfit/pictures/sphere_albedo.h>

#include <hshfit/brdf/steps.h>
#include <hshfit/quadrature/quadrature.h>
#include <hshfit/quadrature/ring_points.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace hshfit::inline pictures {
namespace {

constexpr int level = 2;

struct Albedo {
    std::vector<double> values;  ///< per channel
    std::size_t notFinite = 0;
};

/// The grid of a table ends at its steps: a cell without a node in it would be missed whole.
HemisphereGrid gridAt(const Brdf& brdf, const Direction& wo, int gridLevel) {
    const GridOptions options{.order = 1, .level = gridLevel, .squeezed = true};
    if (dynamic_cast<const HasSteps*>(&brdf) == nullptr)
        return gridFor(brdf.lobes(wo), wo, options);
    return gridFor(brdf.lobes(wo), wo, options, brdf.kinks(wo), kinkCurvesOf(brdf, wo));
}

/// The sum over nodes at the centres of cells on the square, which is exact for tables of such
/// cells.
Albedo squareAlbedoAt(const Brdf& brdf, const Direction& wo, int levels) {
    const std::size_t side = std::size_t{1} << levels, channels = brdf.channels().count();
    const auto centre = [side](std::size_t k) {
        return (static_cast<double>(k) + 0.5) / static_cast<double>(side);
    };
    const double weight = pi / static_cast<double>(side * side);
    Albedo albedo{std::vector<double>(channels, 0.0), 0};
    std::vector<double> x(side), y(side), z(side), f(channels * side);
    for (std::size_t b = 0; b < side; ++b) {
        for (std::size_t a = 0; a < side; ++a) {
            const Direction wi = directionFromSquare({centre(a), centre(b)});
            x[a] = wi.x, y[a] = wi.y, z[a] = wi.z;
        }
        brdf.eval(wo, {x.data(), y.data(), z.data(), side}, f.data());
        for (std::size_t k = 0; k < f.size(); ++k) {
            if (std::isfinite(f[k]))
                albedo.values[k / side] += weight * f[k];
            else
                ++albedo.notFinite;
        }
    }
    return albedo;
}

Albedo albedoAt(const Brdf& brdf, const Direction& wo, int gridLevel) {
    if (const int levels = squareLevelsOf(brdf); levels > 0)
        return squareAlbedoAt(brdf, wo, std::clamp(levels, 7, 8) + gridLevel - level);
    const HemisphereGrid grid = gridAt(brdf, wo, gridLevel);
    Albedo albedo{std::vector<double>(brdf.channels().count(), 0.0), 0};
    std::vector<double> f;
    RingPoints points(grid);
    while (points.next()) {
        const std::size_t count = points.count();
        f.resize(count * albedo.values.size());
        brdf.eval(wo, points.directions(), f.data());
        for (std::size_t k = 0; k < f.size(); ++k) {
            if (std::isfinite(f[k])) {
                albedo.values[k / count] += points.weight(k % count) * points.mu() * f[k];
            } else {
                ++albedo.notFinite;
            }
        }
    }
    return albedo;
}

std::vector<double> elevationsOf(bool isotropic, AlbedoTable::Detail detail) {
    const bool coarse = detail == AlbedoTable::Detail::coarse;
    const int step = isotropic ? (coarse ? 5 : 1) : (coarse ? 10 : 5);
    std::vector<double> thetas;
    for (int degree = 0; degree < 90; degree += step) thetas.push_back(radians(degree));
    if (step == 10) thetas.push_back(radians(85));
    if (step > 1) thetas.push_back(radians(89));
    return thetas;
}

}  // namespace

AlbedoTable::AlbedoTable(const Brdf& brdf, Detail detail)
    : channels_(brdf.channels().count()),
      mirrored_(brdf.laws().mirrorSymmetric),
      azimuthStep_(detail == Detail::coarse ? pi / 8 : pi / 16),
      thetas_(elevationsOf(brdf.laws().isotropic, detail)) {
    if (!brdf.laws().isotropic) {
        const auto quadrant = static_cast<std::size_t>(std::lround(pi / 2 / azimuthStep_));
        azimuths_ = mirrored_ ? quadrant + 1 : 4 * quadrant;
    }
    const std::size_t entries = thetas_.size() * azimuths_;
    const bool estimate = detail == Detail::fine;
    std::vector<Albedo> fine(entries), coarse(entries);
    tbb::parallel_for(std::size_t{0}, entries, [&](std::size_t i) {
        const double phi = static_cast<double>(i % azimuths_) * azimuthStep_;
        const Direction wo = directionFromAngles(thetas_[i / azimuths_], phi);
        if (estimate) coarse[i] = albedoAt(brdf, wo, level - 1);
        fine[i] = albedoAt(brdf, wo, level);
    });
    for (std::size_t i = 0; i < entries; ++i) {
        for (std::size_t c = 0; c < channels_; ++c) {
            values_.push_back(fine[i].values[c]);
            if (!estimate) continue;
            error_ = std::max(error_, std::abs(fine[i].values[c] - coarse[i].values[c]));
        }
        notFinite_ += fine[i].notFinite;
    }
}

void AlbedoTable::lookUpRow(std::size_t row, double share, const Direction& wo,
                            std::span<double> albedo) const {
    const double* values = values_.data() + row * azimuths_ * channels_;
    std::size_t low = 0, high = 0;
    double t = 0;
    if (azimuths_ > 1) {
        // Under mirror symmetry only |x| and |y| matter, and the last azimuth is 90 degrees.
        const double phi = mirrored_ ? std::atan2(std::abs(wo.y), std::abs(wo.x)) : azimuth(wo);
        const double at = (phi < 0 ? phi + 2 * pi : phi) / azimuthStep_;
        low = static_cast<std::size_t>(at);
        t = at - static_cast<double>(low);
        low = mirrored_ ? std::min(low, azimuths_ - 1) : low % azimuths_;
        high = mirrored_ ? std::min(low + 1, azimuths_ - 1) : (low + 1) % azimuths_;
    }
    for (std::size_t c = 0; c < channels_; ++c) {
        albedo[c] +=
            share * ((1 - t) * values[low * channels_ + c] + t * values[high * channels_ + c]);
    }
}

double AlbedoTable::largest() const {
    return *std::max_element(values_.begin(), values_.end());
}

void AlbedoTable::at(const Direction& wo, std::span<double> albedo) const {
    assert(albedo.size() == channels_);
    std::fill(albedo.begin(), albedo.end(), 0.0);
    const double theta = std::min(polarAngle(wo), thetas_.back());
    const auto above = std::upper_bound(thetas_.begin() + 1, thetas_.end() - 1, theta);
    const auto row = static_cast<std::size_t>(above - thetas_.begin()) - 1;
    const double t = (theta - thetas_[row]) / (thetas_[row + 1] - thetas_[row]);
    lookUpRow(row, 1 - t, wo, albedo);
    lookUpRow(row + 1, t, wo, albedo);
}

}  // namespace hshfit::inline pictures
