// `shadeWorld` of the snippets: light in the world, turned to the frame of each surface.

#include "runners.h"
#include "variants.h"

#include <hshfit/bases/catalog.h>
#include <hshfit/light/catalog.h>
#include <hshfit/light/light_projection.h>
#include <hshfit/projection/projection.h>
#include <hshfit/rendering/lit_picture.h>

#include <brdfs/catalog.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <set>

namespace hshfit::shaders {
namespace {

std::vector<float> runShader(gpu::Language language, const ShaderJob& job) {
    const std::string snippet =
        gpu::shaderSource(language, job.payload, {.environmentOrder = job.environment.order});
    return run(language, job, wrapped(language, job, snippet));
}

/// Quadrature with the light turned by the library, for frames all over the sphere.
void prove(gpu::Language language) {
    const std::set<std::string> wanted = {"hsh 10", "hsh 7, f cos", "hsh 7, elevations",
                                          "sh 7, Condon-Shortley", "lsosh 7, elevations, spectral"};
    std::size_t proved = 0;
    for (Variant& variant : variants()) {
        if (!wanted.contains(variant.name)) continue;
        ShaderJob job = makeJob(std::move(variant.payload), variant.environmentOrder);
        job.world = true;
        for (std::size_t k = 0; k < job.pairs.wi.size(); ++k) {
            Direction &n = job.pairs.wi[k], &wo = job.pairs.wo[k];
            if (k % 2 == 0) n = {-n.x, -n.y, -n.z};
            // The way through the world rounds wo: its azimuth at the pole, its side at the
            // horizon.
            if (std::hypot(wo.x, wo.y) < 0.05 || std::abs(wo.z) < 0.01) wo = {0.48, -0.6, 0.64};
        }
        try {
            const std::vector<double> expected = reference(job);
            const Difference difference = compare(job, expected, runShader(language, job));
            const Bounds bounds{2e-6, 1e-2};
            std::cout << fmt::format("{:<48} shadeWorld {:.1e}\n", variant.name, difference.shade);
            EXPECT_LE(difference.shade, bounds.here()) << variant.name;
            keepLast("light in the world", language, variant.name, wantedOf(job, expected), bounds);
        } catch (const Missing& reason) {
            GTEST_SKIP() << reason.what();
        } catch (const Refused& reason) {
            FAIL() << variant.name << ": " << reason.what();
        }
        ++proved;
    }
    EXPECT_EQ(proved, wanted.size());
}

TEST(ShaderWorld, GlslOnVulkan) {
    prove(gpu::Language::glsl);
}
TEST(ShaderWorld, HlslOnVulkan) {
    prove(gpu::Language::hlsl);
}
TEST(ShaderWorld, SlangOnVulkan) {
    prove(gpu::Language::slang);
}
TEST(ShaderWorld, WgslOnVulkan) {
    prove(gpu::Language::wgsl);
}
TEST(ShaderWorld, GlslEsOnOpenGlEs) {
    prove(gpu::Language::glslEs);
}
TEST(ShaderWorld, MetalAsCpp) {
    prove(gpu::Language::metal);
}
TEST(ShaderWorld, OslAsCpp) {
    prove(gpu::Language::osl);
}

double along(const Direction& a, const Direction& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// A sphere under a sky: the coefficient path of pictures, whose light is sampled above each normal
/// and not rotated, and the shader with 16 bands of the sky. The sky's edge at the horizon leaves
/// some of its energy beyond.
TEST(ShaderWorld, SphereUnderASkyIsThatOfTheCoefficientPath) {
    const auto brdf = brdfs::open("phong:kd=0.3,ks=0.5,exponent=6");
    const auto basis = bases::make("hsh", 7);
    const Basis* const one[] = {basis.get()};
    const auto projections =
        project(*brdf, one, OutgoingSet::elevations(32), {.quantity = Quantity::brdfCosine});
    const auto lights = parseLights("sky:type=12,elevation=40,azimuth=70,radiance=2/3/5").lights;
    const auto sh = bases::make("sh", 16);
    const LightCoefficients light = projectLight(lights, *sh, {.tolerance = 1e-5});

    ShaderJob job =
        makeJob(gpu::pack(projections[0].coefficients, {.number = gpu::Number::float32}), 16);
    job.world = true;
    for (std::size_t j = 0; j < light.slots(); ++j)
        for (std::size_t c = 0; c < 3; ++c) job.environment.values[3 * j + c] = light.at(c)[j];
    const rendering::View view(radians(75), 0);
    const rendering::SurfacePoints points = rendering::spherePoints(view, 40, 1);
    ASSERT_LE(points.count(), job.pairs.wi.size());
    for (std::size_t k = 0; k < points.count(); ++k) {
        const auto [t, b, n] = frameOf(points.normals[k]);
        job.pairs.wi[k] = n;
        job.pairs.wo[k] = {along(view.towards, t), along(view.towards, b), along(view.towards, n)};
    }
    std::vector<float> found;
    try {
        found = runShader(gpu::Language::glslEs, job);
    } catch (const Missing& reason) {
        GTEST_SKIP() << reason.what();
    }
    const Coefficients material = gpu::unpack(job.payload);
    const Coefficients* const materials[] = {&material};
    const auto picture = rendering::renderByCoefficients(materials, points, view, lights);
    double wrong = 0, all = 0;
    for (std::size_t pixel = 0; pixel + 1 < points.first.size(); ++pixel) {
        const std::size_t k = points.first[pixel];
        if (points.first[pixel + 1] == k) continue;
        for (std::size_t c = 0; c < 3; ++c) {
            const double expected = picture[0].picture.radiance[3 * pixel + c];
            const double value =
                static_cast<double>(found[k * job.outputs() + 2 * job.channels() + c]);
            wrong += std::pow(value - expected, 2);
            all += expected * expected;
        }
    }
    std::cout << fmt::format("relative L2 {:.2e}\n", std::sqrt(wrong / all));
    EXPECT_LT(std::sqrt(wrong / all), 2e-3);
}

}  // namespace
}  // namespace hshfit::shaders
