#include <hshfit/rendering/internal/even_light.h>

#include <hshfit/brdf/steps.h>
#include <hshfit/brdf/vectors.h>
#include <hshfit/rendering/internal/lit_points.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hshfit::inline rendering {
namespace {

/// Viewers beyond, whose radiance may be steep, have integrals of their own.
const double lowest = radians(88);
/// Cells from the normal to there, and the finest steps of one.
constexpr std::uint32_t rows = 8, finest = 64;

/// Weights of a cell's ends and middle, at a share 0 to 1 of its side.
std::array<double, 3> linear(double at) {
    return {1 - at, 0, at};
}
std::array<double, 3> quadratic(double at) {
    return {(1 - at) * (1 - 2 * at), 4 * at * (1 - at), at * (2 * at - 1)};
}

}  // namespace

std::optional<Rgb> evenRadianceOf(const Light& light) {
    if (const auto* disc = std::get_if<DiscLight>(&light); disc && disc->radius >= pi)
        return disc->radiance;
    const auto* sky = std::get_if<SkyLight>(&light);
    if (sky && sky->model == SkyLight::Model::uniform && sky->zenith == sky->ground)
        return sky->zenith;
    return std::nullopt;
}

EvenLight::EvenLight(const Brdf& brdf, const IntegrationOptions& options, std::size_t most,
                     const std::function<bool()>& goesOn)
    : isotropic_(brdf.laws().isotropic), mirrored_(brdf.laws().mirrorSymmetric) {
    if (!isotropic_) azimuths_ = mirrored_ ? 4 : 16;
    const auto* steps = dynamic_cast<const HasSteps*>(&brdf);
    if (steps && (steps->cells() > 0 || steps->squareLevels() > 0)) return;
    if ((rows + 1) * (azimuths_ + 1) > most) return;
    std::vector<std::size_t> open;
    for (std::uint32_t row = 0; row < rows; ++row) {
        for (std::uint32_t column = 0; column < azimuths_; ++column) {
            open.push_back(cells_.size());
            cells_.push_back({.corner = {row * finest, column * finest}, .size = finest});
        }
    }
    while (!open.empty()) {
        std::vector<Place> places;
        for (const std::size_t k : open)
            for (std::uint32_t i = 0; i < 3; ++i)
                for (std::uint32_t j = 0; j < 3; ++j) places.push_back(placeIn(cells_[k], i, j));
        std::ranges::sort(places);
        places.erase(std::unique(places.begin(), places.end()), places.end());
        std::erase_if(places, [&](const Place& place) { return integrals_.contains(place); });
        if (integrals_.size() + places.size() > most || !goesOn()) return;
        integrate(places, brdf, options, goesOn);
        open = judged(open, options.tolerance);
    }
}

/// The place whose radiance is the same, by the laws of f.
EvenLight::Place EvenLight::within(const Place& place) const {
    if (isotropic_ || place.theta == 0) return {place.theta, 0};
    return {place.theta, mirrored_ ? place.phi : place.phi % (azimuths_ * finest)};
}

EvenLight::Place EvenLight::placeIn(const Cell& cell, std::uint32_t i, std::uint32_t j) const {
    const auto [theta, phi] = cell.corner;
    return within({theta + i * cell.size / 2, phi + j * cell.size / 2});
}

EvenLight::Value EvenLight::sum(const Cell& cell, const std::array<double, 3>& alongTheta,
                                const std::array<double, 3>& alongPhi) const {
    Value sum;
    for (std::uint32_t i = 0; i < 3; ++i) {
        for (std::uint32_t j = 0; j < 3; ++j) {
            const double weight = alongTheta[i] * alongPhi[j];
            if (weight == 0) continue;
            const Value& value = integrals_.at(placeIn(cell, i, j));
            for (std::size_t c = 0; c < 3; ++c) sum.radiance[c] += weight * value.radiance[c];
            sum.error += std::abs(weight) * value.error;
        }
    }
    return sum;
}

/// Places whose integral was cut short, or met values that are not finite, are NaN.
void EvenLight::integrate(const std::vector<Place>& places, const Brdf& brdf,
                          const IntegrationOptions& options, const std::function<bool()>& goesOn) {
    const std::vector<Light> even = {DiscLight{{0, 0, 1}, pi, {1, 1, 1}}};
    IntegrationOptions finer = options;
    finer.tolerance *= interpolationShare;
    const DirectIntegral light(even, finer.tolerance);
    const double turn = isotropic_ || !mirrored_ ? 2 * pi : pi / 2;
    std::vector<PointRadiance> found(places.size());
    tbb::parallel_for(std::size_t{0}, places.size(), [&](std::size_t k) {
        const double theta = lowest * places[k].theta / (rows * finest),
                     phi = turn * places[k].phi / (azimuths_ * finest);
        if (goesOn())
            found[k] = light.at(brdf, frameAt({0, 0, 1}), directionFromAngles(theta, phi), finer);
        else
            found[k].cut = true;
    });
    for (std::size_t k = 0; k < places.size(); ++k) {
        evaluations_ += found[k].evaluations;
        const bool whole = !found[k].cut && found[k].notFinite == 0;
        const double error = whole ? found[k].error : std::numeric_limits<double>::quiet_NaN();
        integrals_[places[k]] = {found[k].radiance, error};
    }
}

/// Cuts the cells in which interpolation is off; their parts are returned.
std::vector<std::size_t> EvenLight::judged(const std::vector<std::size_t>& open, double tolerance) {
    std::vector<std::size_t> parts;
    for (const std::size_t k : open) {
        const Cell cell = cells_[k];
        double error = 0, allowed = std::numeric_limits<double>::infinity();
        for (std::uint32_t i = 0; i < 3; ++i) {
            for (std::uint32_t j = 0; j < 3; ++j) {
                const Value& exact = integrals_.at(placeIn(cell, i, j));
                const Value nearly = sum(cell, linear(i / 2.0), linear(j / 2.0));
                double gap = exact.error - exact.error;  // NaN stays NaN
                for (std::size_t c = 0; c < 3; ++c)
                    gap += std::abs(nearly.radiance[c] - exact.radiance[c]);
                error = std::isnan(gap) ? gap : std::max(error, gap / 4);
                allowed =
                    std::min(allowed, interpolationShare * tolerance * absoluteSum(exact.radiance));
            }
        }
        cells_[k].error = error;
        cells_[k].serves = error <= allowed;
        if (cells_[k].serves || cell.size <= 2) continue;
        cells_[k].firstPart = cells_.size();
        for (std::size_t part = 0; part < (isotropic_ ? 2 : 4); ++part) {
            parts.push_back(cells_.size());
            const std::uint32_t half = cell.size / 2;
            cells_.push_back({.corner = {cell.corner.theta + (part % 2 == 1 ? half : 0),
                                         cell.corner.phi + (part / 2 == 1 ? half : 0)},
                              .size = half});
        }
    }
    return parts;
}

std::optional<EvenLight::Value> EvenLight::at(const Direction& wo) const {
    const double row = polarAngle(wo) / lowest * rows;
    if (cells_.empty() || !(row < rows)) return std::nullopt;
    double column = 0;
    if (!isotropic_) {
        const double phi = mirrored_ ? std::atan2(std::abs(wo.y), std::abs(wo.x)) : azimuth(wo);
        const double turn = mirrored_ ? pi / 2 : 2 * pi;
        column = std::clamp((phi < 0 ? phi + 2 * pi : phi) / turn, 0.0, 1.0) * azimuths_;
    }
    const auto along = [](double at, std::uint32_t last) {
        return std::min(static_cast<std::uint32_t>(at), last);
    };
    const Cell* cell = &cells_[along(row, rows - 1) * azimuths_ + along(column, azimuths_ - 1)];
    while (true) {
        const double theta = (row * finest - cell->corner.theta) / cell->size,
                     phi = (column * finest - cell->corner.phi) / cell->size;
        if (cell->serves) {
            Value value = sum(*cell, quadratic(theta), quadratic(phi));
            value.error += cell->error;
            return value;
        }
        if (cell->firstPart == 0) return std::nullopt;
        const std::size_t part = (theta >= 0.5 ? 1 : 0) + (!isotropic_ && phi >= 0.5 ? 2 : 0);
        cell = &cells_[cell->firstPart + part];
    }
}

}  // namespace hshfit::inline rendering
