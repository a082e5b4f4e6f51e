#include <hshfit/sampling/visible_normals.h>

#include <hshfit/sampling/internal/folded.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hshfit::inline sampling {
namespace {

using Normal = NormalDistribution::Normal;

/// The half vector of a pair; z <= 0 where no visible normal leads from wo to wi.
Normal halfVector(const Direction& wo, const Direction& wi) {
    const double x = wo.x + wi.x, y = wo.y + wi.y, z = wo.z + wi.z;
    if (!(z > 0)) return {0, 0, 0, 1};
    const double length = std::hypot(x, y, z);
    const double nx = x / length, ny = y / length, nz = z / length;
    return {nx, ny, nz, (nx * nx + ny * ny) / (1 + nz)};
}

Direction mirroredAbout(const Direction& wo, double x, double y, double z) {
    const double twice = 2 * (wo.x * x + wo.y * y + wo.z * z);
    return {twice * x - wo.x, twice * y - wo.y, twice * z - wo.z};
}

class Ggx final : public FoldedSampler {
public:
    Ggx(double ax, double ay) : ax_(ax), ay_(ay) {}
    std::string_view name() const override { return "GGX normals"; }

protected:
    Direction draw(const Direction& wo, const Uniforms& u) const override {
        return drawGgx(wo, ax_, ay_, u[0], u[1]);
    }
    double density(const Direction& wo, const Direction& wi) const override {
        return ggxDensity(wo, wi, ax_, ay_);
    }

private:
    double ax_, ay_;
};

/// The slope x, against the direction with this cosine and sine, from its density
///     (cosine - x sine) exp(-x^2) / sqrt(pi) for x < cosine / sine,
/// at the share u of its distribution: safeguarded Newton steps.
double visibleSlope(double cosine, double sine, double u) {
    constexpr double most = 27;  // erfc underflows
    const auto below = [&](double x) {
        return cosine * 0.5 * std::erfc(-x) +
               sine * std::exp(-x * x) * 0.5 * std::numbers::inv_sqrtpi;
    };
    double low = -most, high = sine * most > cosine ? cosine / sine : most;
    const double all = below(high), target = u * all;
    double x = std::min(0.0, high);
    for (int step = 0; step < 100; ++step) {
        const double excess = below(x) - target;
        (excess > 0 ? high : low) = x;
        const double slope = (cosine - x * sine) * std::exp(-x * x) * std::numbers::inv_sqrtpi;
        double next = x - excess / slope;
        if (!(next > low && next < high)) next = 0.5 * (low + high);
        if (std::abs(next - x) <= 1e-15 * (1 + std::abs(x))) return next;
        x = next;
    }
    return x;
}

class Beckmann final : public FoldedSampler {
public:
    Beckmann(double ax, double ay) : ax_(ax), ay_(ay) {}
    std::string_view name() const override { return "Beckmann normals"; }

protected:
    Direction draw(const Direction& wo, const Uniforms& u) const override {
        const double wx = ax_ * wo.x, wy = ay_ * wo.y, across = std::hypot(wx, wy);
        const double length = std::hypot(across, wo.z);
        const double along = visibleSlope(wo.z / length, across / length, u[0]);
        const double aside = visibleSlope(1, 0, u[1]);
        const double c = across > 0 ? wx / across : 1, s = across > 0 ? wy / across : 0;
        const double hx = -ax_ * (c * along - s * aside), hy = -ay_ * (s * along + c * aside);
        const double scale = std::hypot(hx, hy, 1.0);
        return mirroredAbout(wo, hx / scale, hy / scale, 1 / scale);
    }
    double density(const Direction& wo, const Direction& wi) const override {
        const Normal h = halfVector(wo, wi);
        if (!(h.z > 0)) return 0;
        const double x = h.x / (ax_ * h.z), y = h.y / (ay_ * h.z), z2 = h.z * h.z;
        const double d = std::exp(-x * x - y * y) / (pi * ax_ * ay_ * z2 * z2);
        const double across = std::hypot(ax_ * wo.x, ay_ * wo.y);
        // cos / G1 = cos (1 + Lambda); with a = cos / across.
        double visible = wo.z;
        if (across > 0) {
            const double a = wo.z / across;
            visible =
                0.5 * (wo.z * std::erfc(-a) + across * std::exp(-a * a) * std::numbers::inv_sqrtpi);
        }
        return d > 0 ? d / (4 * visible) : 0;
    }

private:
    double ax_, ay_;
};

class Groove final : public FoldedSampler {
public:
    explicit Groove(std::shared_ptr<const NormalDistribution> normals)
        : normals_(std::move(normals)) {}
    std::string_view name() const override { return normals_->name(); }

protected:
    Direction draw(const Direction& wo, const Uniforms& u) const override {
        const Normal h = normals_->draw(u[0], u[1]);
        const double across = wo.x * h.x + wo.y * h.y, up = wo.z * h.z;
        const double one = std::max(0.0, up + across), other = std::max(0.0, up - across);
        const double side = u[2] * (one + other) < one ? 1 : -1;
        return mirroredAbout(wo, side * h.x, side * h.y, h.z);
    }
    double density(const Direction& wo, const Direction& wi) const override {
        const Normal h = halfVector(wo, wi);
        if (!(h.z > 0)) return 0;
        const double seen = wo.x * h.x + wo.y * h.y + wo.z * h.z;
        const double areas = std::max(seen, 2 * wo.z * h.z);
        return areas > 0 ? normals_->density(h) / (2 * areas) : 0;
    }

private:
    std::shared_ptr<const NormalDistribution> normals_;
};

Normal normalAt(double versine, double cosine, double sine, double across) {
    return {across * cosine, across * sine, 1 - versine, versine};
}

class GaussianNormals final : public NormalDistribution {
public:
    GaussianNormals(double ax, double ay) : ax_(ax), ay_(ay) {}
    std::string_view name() const override { return "normals of Gaussian slopes"; }
    Normal draw(double u, double v) const override {
        const double radius = std::sqrt(-std::log1p(-u)), phi = 2 * pi * v;
        const double tx = ax_ * radius * std::cos(phi), ty = ay_ * radius * std::sin(phi);
        const double secant = std::hypot(tx, ty, 1.0);
        const double x = tx / secant, y = ty / secant, z = 1 / secant;
        return {x, y, z, (x * x + y * y) / (1 + z)};
    }
    double density(const Normal& h) const override {
        const double x = h.x / (ax_ * h.z), y = h.y / (ay_ * h.z);
        const double e = std::exp(-x * x - y * y);
        return e > 0 ? e / (pi * ax_ * ay_ * h.z * h.z * h.z) : 0;
    }

private:
    double ax_, ay_;
};

class PowerNormals final : public NormalDistribution {
public:
    PowerNormals(double nu, double nv) : nu_(nu), nv_(nv) {}
    std::string_view name() const override { return "normals by powers of the cosine"; }
    Normal draw(double u, double v) const override {
        const double t = 2 * pi * v;
        double c = std::sqrt(nv_ + 1) * std::cos(t), s = std::sqrt(nu_ + 1) * std::sin(t);
        const double length = std::hypot(c, s);
        c /= length, s /= length;
        const double versine = -std::expm1(std::log1p(-u) / (nu_ * c * c + nv_ * s * s + 1));
        return normalAt(versine, c, s, std::sqrt(versine * (2 - versine)));
    }
    double density(const Normal& h) const override {
        const double across = h.x * h.x + h.y * h.y;
        const double power = across > 0 ? (nu_ * h.x * h.x + nv_ * h.y * h.y) / across : 1;
        return std::sqrt((nu_ + 1) * (nv_ + 1)) / (2 * pi) *
               std::exp(power * std::log1p(-h.versine));
    }

private:
    double nu_, nv_;
};

/// With y = 1 + (1 / alpha^2 - 1) sin^2 theta, D h.z d omega is proportional to y^-gamma dy.
class GtrNormals final : public NormalDistribution {
public:
    GtrNormals(double alpha, double gamma)
        : gamma_(gamma), more_((1 - alpha) * (1 + alpha) / (alpha * alpha)) {
        // The integral of y^-gamma from 1 to 1 + more.
        const double ends = std::log1p(more_), power = 1 - gamma;
        scale_ =
            flat() ? 1 / pi : more_ / (pi * (power == 0 ? ends : std::expm1(power * ends) / power));
    }
    std::string_view name() const override { return "normals of Trowbridge-Reitz tails"; }
    Normal draw(double u, double v) const override {
        double square = u;
        if (!flat()) {
            const double ends = std::log1p(more_), power = 1 - gamma_;
            const double y = power == 0
                                 ? std::expm1(u * ends)
                                 : std::expm1(std::log1p(u * std::expm1(power * ends)) / power);
            square = std::clamp(y / more_, 0.0, 1.0);
        }
        const double phi = 2 * pi * v, z = std::sqrt(1 - square);
        return normalAt(square / (1 + z), std::cos(phi), std::sin(phi), std::sqrt(square));
    }
    double density(const Normal& h) const override {
        const double square = h.x * h.x + h.y * h.y;
        return h.z * scale_ * std::exp(-gamma_ * std::log1p(more_ * square));
    }

private:
    bool flat() const { return more_ < 1e-12; }

    double gamma_, more_, scale_ = 0;
};

}  // namespace

Direction drawGgx(const Direction& wo, double ax, double ay, double u, double v) {
    const double wx = ax * wo.x, wy = ay * wo.y, length = std::hypot(wx, wy, wo.z);
    const Direction w{wx / length, wy / length, wo.z / length};
    // The cap of mirror directions of w about the normals of the upper hemisphere: z >= -w.z.
    const double phi = 2 * pi * u, above = (1 - v) * (1 + w.z), z = above - w.z;
    const double sine = std::sqrt(std::max(0.0, (1 - z) * (1 + z)));
    const double hx = ax * (sine * std::cos(phi) + w.x);
    const double hy = ay * (sine * std::sin(phi) + w.y), scale = std::hypot(hx, hy, above);
    if (!(scale > 0)) return mirrored(wo);
    return mirroredAbout(wo, hx / scale, hy / scale, above / scale);
}

double ggxDensity(const Direction& wo, const Direction& wi, double ax, double ay) {
    const Normal h = halfVector(wo, wi);
    if (!(h.z > 0)) return 0;
    const double x = h.x / ax, y = h.y / ay, s = x * x + y * y + h.z * h.z;
    const double visible = wo.z + std::hypot(ax * wo.x, ay * wo.y, wo.z);
    return 1 / (2 * pi * ax * ay * s * s * visible);
}

std::shared_ptr<const Sampler> ggxSampler(double ax, double ay) {
    return std::make_shared<Ggx>(ax, ay);
}

std::shared_ptr<const Sampler> beckmannSampler(double ax, double ay) {
    return std::make_shared<Beckmann>(ax, ay);
}

std::shared_ptr<const Sampler> grooveSampler(std::shared_ptr<const NormalDistribution> normals) {
    return std::make_shared<Groove>(std::move(normals));
}

std::shared_ptr<const NormalDistribution> gaussianNormals(double ax, double ay) {
    return std::make_shared<GaussianNormals>(ax, ay);
}

std::shared_ptr<const NormalDistribution> powerNormals(double nu, double nv) {
    return std::make_shared<PowerNormals>(nu, nv);
}

std::shared_ptr<const NormalDistribution> gtrNormals(double alpha, double gamma) {
    return std::make_shared<GtrNormals>(alpha, gamma);
}

}  // namespace hshfit::inline sampling
