#include <hshfit/transport/environment_sampler.h>

#include <hshfit/brdf/vectors.h>
#include <hshfit/light/light_samples.h>
#include <hshfit/light/picture_light.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace hshfit::inline transport {
namespace {

/// Cells of equal steps in theta and phi, each in proportion to its mean radiance times its solid
/// angle.
class Table {
public:
    explicit Table(std::vector<Light> lights) : lights_(std::move(lights)) {
        for (const Light& light : lights_) {
            if (const auto* picture = std::get_if<PictureLight>(&light))
                rows_ = std::clamp(picture->height, rows_, std::size_t{1024});
        }
        columns_ = 2 * rows_;
        cumulative_.resize(rows_ * columns_);
        tbb::parallel_for(std::size_t{0}, rows_, [&](std::size_t row) {
            for (std::size_t column = 0; column < columns_; ++column)
                cumulative_[row * columns_ + column] = brightness(row, column) * areaOf(row);
        });
        for (double& value : cumulative_) flux_ = value += flux_;
    }

    double flux() const { return flux_; }
    Rgb radiance(const Direction& world) const { return radianceFrom(lights_, world); }

    Direction sample(const std::array<double, 3>& u) const {
        if (u[2] < EnvironmentSampler::evenShare) return at(1 - 2 * u[0], 2 * pi * u[1]);
        const double wanted =
            (u[2] - EnvironmentSampler::evenShare) / (1 - EnvironmentSampler::evenShare) * flux_;
        const auto found = std::upper_bound(cumulative_.begin(), cumulative_.end() - 1, wanted);
        const auto cell = static_cast<std::size_t>(found - cumulative_.begin());
        const std::size_t row = cell / columns_, column = cell % columns_;
        const double high = edge(row), low = edge(row + 1);
        return at(high + (low - high) * u[0],
                  2 * pi * (static_cast<double>(column) + u[1]) / static_cast<double>(columns_));
    }
    double pdf(const Direction& world) const {
        const auto placed = [](double share, std::size_t count) {
            return std::min(count - 1, static_cast<std::size_t>(
                                           std::max(0.0, share * static_cast<double>(count))));
        };
        const double phi = azimuth(world);
        const std::size_t row = placed(polarAngle(world) / pi, rows_);
        const std::size_t column = placed((phi < 0 ? phi + 2 * pi : phi) / (2 * pi), columns_);
        const std::size_t cell = row * columns_ + column;
        const double share = cumulative_[cell] - (cell > 0 ? cumulative_[cell - 1] : 0);
        return EnvironmentSampler::evenShare / (4 * pi) +
               (1 - EnvironmentSampler::evenShare) * share / flux_ / areaOf(row);
    }

private:
    static Direction at(double z, double phi) {
        const double s = std::sqrt(std::max(0.0, (1 - z) * (1 + z)));
        return {s * std::cos(phi), s * std::sin(phi), z};
    }
    double edge(std::size_t row) const {
        return std::cos(pi * static_cast<double>(row) / static_cast<double>(rows_));
    }
    double areaOf(std::size_t row) const {
        return 2 * pi / static_cast<double>(columns_) * (edge(row) - edge(row + 1));
    }
    /// The mean over 2 x 2 places, so that every pixel of a picture counts.
    double brightness(std::size_t row, std::size_t column) const {
        double sum = 0;
        for (const double down : {0.25, 0.75}) {
            for (const double right : {0.25, 0.75}) {
                const double theta =
                    pi * (static_cast<double>(row) + down) / static_cast<double>(rows_);
                const double phi =
                    2 * pi * (static_cast<double>(column) + right) / static_cast<double>(columns_);
                sum += std::abs(meanOf(radiance(directionFromAngles(theta, phi))));
            }
        }
        return sum / 4;
    }

    std::vector<Light> lights_;
    std::size_t rows_ = 128, columns_ = 0;
    std::vector<double> cumulative_;
    double flux_ = 0;
};

/// A frame with the direction as its pole, its tangent along growing theta.
Frame frameAbout(const Direction& pole) {
    const double phi = azimuth(pole);
    return Frame({.theta = polarAngle(pole), .phi = phi, .turn = phi});
}

/// A disc or a panel: a density of its own, even over the disc's solid angle or the panel's plane.
class Shape {
public:
    explicit Shape(const Light& light) : light_(light) {
        if (const auto* disc = std::get_if<DiscLight>(&light)) {
            frame_.emplace(frameAbout(disc->towards));
            depth_ = 2 * std::pow(std::sin(disc->radius / 2), 2);
            flux_ = meanOf(disc->radiance) * 2 * pi * depth_;
        } else {
            const auto& panel = std::get<PanelLight>(light);
            frame_.emplace(frameAbout(panel.towards));
            halfWidth_ = std::tan(panel.width / 2);
            halfHeight_ = std::tan(panel.height / 2);
            turn_ = panel.turn;
            // Its solid angle (the flux of a rectangle at distance 1).
            const double a = halfWidth_, b = halfHeight_;
            flux_ = meanOf(panel.radiance) * 4 *
                    std::asin(a * b / std::sqrt((1 + a * a) * (1 + b * b)));
        }
    }
    double flux() const { return flux_; }
    Rgb radiance(const Direction& world) const { return radianceFrom({&light_, 1}, world); }

    Direction sample(const std::array<double, 3>& u) const {
        if (halfWidth_ > 0) {
            const double x = (2 * u[0] - 1) * halfWidth_, y = (2 * u[1] - 1) * halfHeight_;
            const double c = std::cos(turn_), s = std::sin(turn_);
            // The panel's axes: along azimuth, and down along growing theta.
            return frameToWorld(s * x + c * y, c * x - s * y, 1);
        }
        const double missing = depth_ * u[0], across = std::sqrt(missing * (2 - missing));
        return frameToWorld(across * std::cos(2 * pi * u[1]), across * std::sin(2 * pi * u[1]),
                            1 - missing);
    }
    /// Per steradian, for a direction within.
    double pdfWithin(const Direction& world) const {
        if (!(halfWidth_ > 0)) return 1 / (2 * pi * depth_);
        const double ahead = dot(world, frame_->normal);
        return 1 / (4 * halfWidth_ * halfHeight_ * ahead * ahead * ahead);
    }
    double pdf(const Direction& world) const {
        const Rgb seen = radiance(world);
        return seen[0] > 0 || seen[1] > 0 || seen[2] > 0 ? pdfWithin(world) : 0;
    }

private:
    Direction frameToWorld(double down, double along, double ahead) const {
        return normalised(frame_->toWorld({down, along, ahead}));
    }

    Light light_;
    std::optional<Frame> frame_;
    double depth_ = 0, halfWidth_ = 0, halfHeight_ = 0, turn_ = 0, flux_ = 0;
};

}  // namespace

struct EnvironmentSampler::Parts {
    std::optional<Table> table;
    std::vector<Shape> shapes;
    std::vector<DirectionalLight> beams;
    std::vector<double> shares;  ///< of the table, the shapes and the beams, cumulative

    explicit Parts(std::span<const Light> lights) {
        std::vector<Light> tabled;
        for (const Light& light : lights) {
            if (std::holds_alternative<DiscLight>(light) ||
                std::holds_alternative<PanelLight>(light))
                shapes.emplace_back(light);
            else if (const auto* beam = std::get_if<DirectionalLight>(&light))
                beams.push_back(*beam);
            else
                tabled.push_back(light);
        }
        if (!tabled.empty()) table.emplace(std::move(tabled));
        shares.push_back(table ? table->flux() : 0);
        for (const Shape& shape : shapes) shares.push_back(shape.flux());
        for (const DirectionalLight& beam : beams) shares.push_back(meanOf(beam.irradiance));
        double sum = 0;
        for (double& share : shares) share = sum += share;
        if (!(sum > 0)) shares.clear();
        for (double& share : shares) share /= sum;
    }

    double shareOf(std::size_t part) const {
        return shares[part] - (part > 0 ? shares[part - 1] : 0);
    }
    Rgb radiance(const Direction& world) const {
        Rgb sum = table ? table->radiance(world) : Rgb{};
        for (const Shape& shape : shapes) {
            const Rgb more = shape.radiance(world);
            for (std::size_t c = 0; c < 3; ++c) sum[c] += more[c];
        }
        return sum;
    }
    double pdf(const Direction& world) const {
        if (shares.empty()) return 0;
        double sum = table ? shareOf(0) * table->pdf(world) : 0;
        for (std::size_t k = 0; k < shapes.size(); ++k)
            sum += shareOf(1 + k) * shapes[k].pdf(world);
        return sum;
    }
};

EnvironmentSampler::EnvironmentSampler(std::span<const Light> lights)
    : parts_(std::make_unique<Parts>(lights)) {}
EnvironmentSampler::~EnvironmentSampler() = default;

bool EnvironmentSampler::any() const {
    return !parts_->shares.empty();
}

EnvironmentSample EnvironmentSampler::sample(const std::array<double, 3>& u) const {
    const Parts& parts = *parts_;
    const auto found = std::upper_bound(parts.shares.begin(), parts.shares.end() - 1, u[2]);
    const auto part = static_cast<std::size_t>(found - parts.shares.begin());
    const double below = part > 0 ? parts.shares[part - 1] : 0;
    const std::array<double, 3> rest{u[0], u[1],
                                     std::min((u[2] - below) / parts.shareOf(part), 1 - 0x1p-53)};
    EnvironmentSample sample;
    const std::size_t first = 1 + parts.shapes.size();
    if (part >= first) {
        const DirectionalLight& beam = parts.beams[part - first];
        return {beam.towards, beam.irradiance, parts.shareOf(part), true};
    }
    sample.world = part == 0 ? parts.table->sample(rest) : parts.shapes[part - 1].sample(rest);
    sample.radiance = parts.radiance(sample.world);
    sample.pdf = parts.pdf(sample.world);
    return sample;
}

double EnvironmentSampler::pdf(const Direction& world) const {
    return parts_->pdf(world);
}

Rgb EnvironmentSampler::radiance(const Direction& world) const {
    return parts_->radiance(world);
}

}  // namespace hshfit::inline transport
