#include <hshfit/pictures/internal/channel_colours.h>
#include <hshfit/pictures/sphere.h>

#include <tbb/parallel_for.h>

#include <array>
#include <atomic>
#include <cmath>

namespace hshfit::inline pictures {
namespace {

using Rgb = std::array<double, 3>;

/// The local frame at a point of the sphere, in that of the picture.
struct Frame {
    Direction tangent, bitangent, normal;
    Direction local(const Direction& d) const {
        return {dot(d, tangent), dot(d, bitangent), dot(d, normal)};
    }
};

/// The frame at the point (x, y) of the unit disc.
Frame frameAt(double x, double y) {
    const double z = std::sqrt(1 - x * x - y * y);
    const Direction n{x, y, z};
    const double length = std::hypot(z, x);
    const Direction t = length > 0 ? Direction{z / length, 0, -x / length} : Direction{1, 0, 0};
    return {t, {n.y * t.z - n.z * t.y, n.z * t.x - n.x * t.z, n.x * t.y - n.y * t.x}, n};
}

class Shader {
public:
    /// `albedo` is needed under a dome only.
    Shader(const Brdf& brdf, const AlbedoTable* albedo, const SphereRig& rig)
        : brdf_(brdf),
          albedo_(albedo),
          rig_(rig),
          colour_(brdf.channels()),
          channels_(brdf.channels().count()) {}

    const std::string& colours() const { return colour_.what(); }

    /// Adds the radiance that the point (x, y) of the unit disc sends to the viewer.
    void add(double x, double y, Rgb& sum, std::size_t& notFinite) const {
        const Frame frame = frameAt(x, y);
        const Direction wo = frame.local({0, 0, 1});
        std::vector<double> wx, wy, wz, weight, f;
        for (const SphereLight& light : rig_.lights) {
            const Direction wi = frame.local(light.towards);
            if (wi.z <= 0) continue;
            wx.push_back(wi.x);
            wy.push_back(wi.y);
            wz.push_back(wi.z);
            weight.push_back(pi * light.strength * wi.z);
        }
        f.resize(std::max<std::size_t>(1, wx.size()) * channels_);
        if (!wx.empty()) brdf_.eval(wo, {wx.data(), wy.data(), wz.data(), wx.size()}, f.data());
        for (std::size_t k = 0; k < wx.size(); ++k) {
            addFinite(colour_(f.data() + k, wx.size()), weight[k], sum, notFinite);
        }
        if (rig_.dome == 0) return;
        f.resize(channels_);
        albedo_->at(wo, f);
        addFinite(colour_(f.data(), 1), rig_.dome, sum, notFinite);
    }

private:
    static void addFinite(const Rgb& value, double weight, Rgb& sum, std::size_t& notFinite) {
        for (std::size_t c = 0; c < 3; ++c) {
            if (std::isfinite(value[c])) {
                sum[c] += weight * value[c];
            } else {
                ++notFinite;
            }
        }
    }

    const Brdf& brdf_;
    const AlbedoTable* albedo_;
    const SphereRig& rig_;
    const ChannelColours colour_;
    std::size_t channels_;
};

SpherePicture render(const Brdf& brdf, const AlbedoTable* albedo, const SphereOptions& options) {
    const Shader shader(brdf, albedo, options.rig);
    const auto size = static_cast<std::size_t>(options.size);
    SpherePicture picture{.size = options.size,
                          .radiance = std::vector<float>(size * size * 3),
                          .coverage = std::vector<float>(size * size),
                          .colours = shader.colours(),
                          .notFinite = albedo ? albedo->notFinite() : 0};
    std::vector<std::size_t> notFinite(size);
    std::atomic<std::size_t> done = 0;
    const double samples = options.samples, scale = 2 / (options.size * sphereRadius);
    tbb::parallel_for(std::size_t{0}, size, [&](std::size_t row) {
        for (std::size_t column = 0; column < size; ++column) {
            Rgb sum{};
            double covered = 0;
            for (int i = 0; i < options.samples * options.samples; ++i) {
                const double across = (i % options.samples + 0.5) / samples;
                const double down = (i / options.samples + 0.5) / samples;
                const double x = scale * (static_cast<double>(column) + across) - 1 / sphereRadius;
                const double y = 1 / sphereRadius - scale * (static_cast<double>(row) + down);
                if (x * x + y * y >= 1) continue;
                shader.add(x, y, sum, notFinite[row]);
                ++covered;
            }
            const std::size_t pixel = row * size + column;
            picture.coverage[pixel] = static_cast<float>(covered / (samples * samples));
            for (std::size_t c = 0; c < 3 && covered > 0; ++c) {
                picture.radiance[3 * pixel + c] = static_cast<float>(sum[c] / covered);
            }
        }
        if (options.progress) options.progress(++done, size);
    });
    for (const std::size_t count : notFinite) picture.notFinite += count;
    return picture;
}

}  // namespace

SpherePicture renderSphere(const Brdf& brdf, const AlbedoTable& albedo,
                           const SphereOptions& options) {
    return render(brdf, &albedo, options);
}

SpherePicture renderSphere(const Brdf& brdf, const SphereOptions& options) {
    if (options.rig.dome == 0) return render(brdf, nullptr, options);
    return renderSphere(brdf, AlbedoTable(brdf), options);
}

}  // namespace hshfit::inline pictures
