#include <hshfit/sampling/axis_lobes.h>

#include <hshfit/sampling/internal/folded.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hshfit::inline sampling {
namespace {

/// A point of the unit square mapped to the disc with constant area ratio, then raised to the
/// hemisphere.
Direction cosineDirection(double u, double v) {
    const double a = 2 * u - 1, b = 2 * v - 1;
    double radius = 0, phi = 0;
    if (a != 0 || b != 0) {
        const bool wide = std::abs(a) > std::abs(b);
        radius = wide ? a : b;
        phi = wide ? pi / 4 * (b / a) : pi / 2 - pi / 4 * (a / b);
    }
    // 1 - radius^2 as a product, which keeps digits at the horizon.
    const double square = (1 - radius) * (1 + radius);
    return {radius * std::cos(phi), radius * std::sin(phi),
            std::max(std::sqrt(std::max(0.0, square)), std::numeric_limits<double>::min())};
}

class Cosine final : public Sampler {
public:
    std::string_view name() const override { return "cosine"; }
    Sample sample(const Direction& wo, const Uniforms& u) const override {
        if (!(wo.z > 0)) return {};
        const Direction wi = cosineDirection(u[0], u[1]);
        return {wi, wi.z / pi};
    }
    double pdf(const Direction& wo, const Direction& wi) const override {
        return aboveHorizon(wo, wi) ? wi.z / pi : 0;
    }
};

/// A density that depends on the angle to an axis, by its versine 1 - cos(alpha).
class AboutAxis : public FoldedSampler {
public:
    explicit AboutAxis(LobeAxis axis) : axis_(axis) {}

protected:
    virtual double versineAt(double u) const = 0;
    virtual double densityAt(double versine) const = 0;

    Direction draw(const Direction& wo, const Uniforms& u) const final {
        const double versine = versineAt(u[0]), phi = 2 * pi * u[1];
        const double sine = std::sqrt(versine * (2 - versine));
        const double x = sine * std::cos(phi), y = sine * std::sin(phi);
        const Direction a = axis(wo);
        // An orthonormal frame about a: Duff et al. 2017, JCGT 6(1).
        const double sign = std::copysign(1.0, a.z), p = -1 / (sign + a.z), q = a.x * a.y * p;
        const Direction s{1 + sign * a.x * a.x * p, sign * q, -sign * a.x};
        const Direction t{q, sign + a.y * a.y * p, -a.y};
        return {a.x + (x * s.x + y * t.x - versine * a.x),
                a.y + (x * s.y + y * t.y - versine * a.y),
                a.z + (x * s.z + y * t.z - versine * a.z)};
    }
    double density(const Direction& wo, const Direction& wi) const final {
        const Direction a = axis(wo);
        const Direction d{wi.x - a.x, wi.y - a.y, wi.z - a.z};
        return densityAt(0.5 * dot(d, d));
    }

private:
    Direction axis(const Direction& wo) const {
        const Direction a{axis_.x * wo.x, axis_.y * wo.y, axis_.z * wo.z};
        const double largest = std::max({std::abs(a.x), std::abs(a.y), std::abs(a.z)});
        if (!(largest > 0)) return {};
        const Direction b{a.x / largest, a.y / largest, a.z / largest};
        const double length = std::sqrt(dot(b, b));
        return {b.x / length, b.y / length, b.z / length};
    }

    LobeAxis axis_;
};

class PowerCosine final : public AboutAxis {
public:
    PowerCosine(LobeAxis axis, double exponent) : AboutAxis(axis), exponent_(exponent) {}
    std::string_view name() const override { return "power cosine"; }

protected:
    double versineAt(double u) const override {
        return std::min(1.0, -std::expm1(std::log1p(-u) / (exponent_ + 1)));
    }
    double densityAt(double versine) const override {
        if (versine >= 1) return 0;
        return (exponent_ + 1) / (2 * pi) * std::exp(exponent_ * std::log1p(-versine));
    }

private:
    double exponent_;
};

class GaussianLobe final : public AboutAxis {
public:
    GaussianLobe(LobeAxis axis, double sharpness) : AboutAxis(axis), sharpness_(sharpness) {}
    std::string_view name() const override { return "spherical Gaussian"; }

protected:
    double versineAt(double u) const override {
        if (uniform()) return 2 * u;
        return std::min(2.0, -std::log1p(u * std::expm1(-2 * sharpness_)) / sharpness_);
    }
    double densityAt(double versine) const override {
        if (uniform()) return 1 / (4 * pi);
        return sharpness_ / (-2 * pi * std::expm1(-2 * sharpness_)) *
               std::exp(-sharpness_ * versine);
    }

private:
    /// The density varies by less than rounding.
    bool uniform() const { return sharpness_ < 1e-16; }

    double sharpness_;
};

}  // namespace

std::shared_ptr<const Sampler> cosineSampler() {
    static const auto sampler = std::make_shared<const Cosine>();
    return sampler;
}

std::shared_ptr<const Sampler> powerCosineSampler(LobeAxis axis, double exponent) {
    return std::make_shared<PowerCosine>(axis, exponent);
}

std::shared_ptr<const Sampler> gaussianLobeSampler(LobeAxis axis, double sharpness) {
    return std::make_shared<GaussianLobe>(axis, sharpness);
}

}  // namespace hshfit::inline sampling
