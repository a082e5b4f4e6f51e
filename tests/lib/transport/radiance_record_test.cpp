#include <hshfit/bases/catalog.h>
#include <hshfit/quadrature/quadrature.h>
#include <hshfit/transport/radiance_cache/record.h>

#include <lib/transport/cache_scenes.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace hshfit {
namespace {

using test::materialOf;
using test::patch;

/// A scene in which coefficients change along the floor: a square lamp above it and, if asked, a
/// black board between them.
std::unique_ptr<SurfaceScene> lampAbove(bool board) {
    std::vector<SurfaceObject> objects;
    objects.push_back({"floor", patch({-9, -9, 0}, {18, 0, 0}, {0, 18, 0}), 0, {}});
    objects.push_back({"lamp", patch({-0.5, -0.4, 1.5}, {0, 1, 0}, {1, 0, 0}), 0, {1, 1, 1}});
    if (board) objects.push_back({"board", patch({-1, -1, 0.7}, {1.1, 0, 0}, {0, 3, 0}), 0, {}});
    return std::make_unique<SurfaceScene>(std::vector{materialOf("lambert:kd=0")},
                                          std::move(objects), std::vector<Light>{});
}

/// The record at (x, y) of the floor, with second derivatives if it has a gradient by strata.
Gathered gatheredAt(const SurfaceScene& scene, double x, double y,
                    const IncomingFunctions& functions, int rays, Gradient gradient) {
    const LightWalk walk(scene, DirectLight::gathered);
    const SurfaceIrradiance none({}, 0, 0);
    const HemisphereStrata strata(functions, rays, gradient == Gradient::strata);
    std::size_t traced = 0;
    const auto hit = scene.firstHit({x, y, 0.1}, {0, 0, -1});
    return gather(*hit, 0, functions, strata, gradient, {&walk, &none}, RandomNumbers(7, 0),
                  traced);
}

Record recordAt(const SurfaceScene& scene, double x, double y, const IncomingFunctions& functions,
                int rays, Gradient gradient) {
    return gatheredAt(scene, x, y, functions, rays, gradient).record;
}

/// The distance of a record's gradient from central differences of coefficients by many rays,
/// relative to the latter.
double gradientError(bool board, const IncomingFunctions& functions, Gradient gradient, int rays) {
    const auto scene = lampAbove(board);
    const double x = 0.35, y = -0.2, h = 0.02;
    const std::size_t size = functions.size();
    const Record found = recordAt(*scene, x, y, functions, rays, gradient);
    double error = 0, norm = 0;
    for (const std::size_t axis : {0U, 1U}) {
        const Direction along = axis == 0 ? found.frame.tangent : found.frame.bitangent;
        const auto beside = [&](double step) {
            return recordAt(*scene, x + step * along.x, y + step * along.y, functions, 400000,
                            Gradient::none);
        };
        const Record more = beside(h), less = beside(-h);
        for (std::size_t i = 0; i < size; ++i) {
            const double expected =
                static_cast<double>(more.part(0, size)[i] - less.part(0, size)[i]) / (2 * h);
            const double off = static_cast<double>(found.part(1 + axis, size)[i]) - expected;
            error += off * off;
            norm += expected * expected;
        }
    }
    return std::sqrt(error / norm);
}

TEST(RecordGradient, MatchesDifferencesOfConvergedCoefficients) {
    const IncomingFunctions hsh(bases::make("hsh", 5));
    for (const Gradient gradient : {Gradient::strata, Gradient::hitPoints}) {
        EXPECT_LT(gradientError(false, hsh, gradient, 4000), 0.1);
        EXPECT_LT(gradientError(false, hsh, gradient, 100000), 0.05);
    }
}

/// Coefficients at (x, y, 0) of the lamp's radiance 1 in a frame, by Gauss's rule over the part of
/// it that is seen: the shadow of the board ends at a line that moves with x.
std::vector<double> coefficientsOfLamp(const IncomingFunctions& functions, const Frame& frame,
                                       double x, double y, bool board) {
    const double from = board ? std::max(-0.5, x + (0.1 - x) * 1.5 / 0.7) : -0.5;
    const GaussRule rule = gaussLegendre(24);
    std::vector<double> dx, dy, dz, weights;
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
        for (std::size_t j = 0; j < rule.nodes.size(); ++j) {
            const double along = from + (0.5 - from) * (rule.nodes[i] + 1) / 2;
            const Direction gap{along - x, -0.4 + (rule.nodes[j] + 1) / 2 - y, 1.5};
            const Direction d = frame.toLocal(normalised(gap));
            dx.push_back(d.x), dy.push_back(d.y), dz.push_back(d.z);
            const double square = dot(gap, gap);
            weights.push_back(rule.weights[i] * rule.weights[j] * (0.5 - from) / 4 * 1.5 /
                              (square * std::sqrt(square)));
        }
    }
    std::vector<float> values(weights.size() * functions.size());
    functions.tabulate({dx.data(), dy.data(), dz.data(), dx.size()}, values.data());
    std::vector<double> sums(functions.size());
    for (std::size_t n = 0; n < values.size(); ++n)
        sums[n % functions.size()] +=
            weights[n / functions.size()] * static_cast<double>(values[n]);
    return sums;
}

/// The distance of a record's second derivatives from second differences of coefficients by
/// quadrature, relative to the latter.
double bendError(bool board, const IncomingFunctions& functions, int rays) {
    const auto scene = lampAbove(board);
    const double x = 0.35, y = -0.2, h = 0.03;
    const std::size_t size = functions.size();
    const Gathered found = gatheredAt(*scene, x, y, functions, rays, Gradient::strata);
    const Direction &t = found.record.frame.tangent, &b = found.record.frame.bitangent;
    const auto at = [&](int i, int j) {
        return coefficientsOfLamp(functions, found.record.frame, x + h * (i * t.x + j * b.x),
                                  y + h * (i * t.y + j * b.y), board);
    };
    const auto middle = at(0, 0), east = at(1, 0), west = at(-1, 0), north = at(0, 1),
               south = at(0, -1), ne = at(1, 1), nw = at(-1, 1), se = at(1, -1), sw = at(-1, -1);
    double error = 0, norm = 0;
    for (std::size_t i = 0; i < size; ++i) {
        const std::array<double, 3> differences{east[i] - 2 * middle[i] + west[i],
                                                (ne[i] - nw[i] - se[i] + sw[i]) / 4,
                                                north[i] - 2 * middle[i] + south[i]};
        for (const std::size_t k : {0U, 1U, 2U}) {
            // A record sums the derivatives of R, G and B.
            const double expected = 3 * differences[k] / (h * h);
            const double off = static_cast<double>(found.bends[k * size + i]) - expected;
            error += off * off;
            norm += expected * expected;
        }
    }
    return std::sqrt(error / norm);
}

TEST(RecordBend, MatchesSecondDifferencesOfCoefficientsWithAndWithoutOccluder) {
    const IncomingFunctions irradiance, hsh(bases::make("hsh", 5));
    EXPECT_LT(bendError(false, irradiance, 40000), 0.03);
    EXPECT_LT(bendError(true, irradiance, 40000), 0.08);
    EXPECT_LT(bendError(false, hsh, 40000), 0.04);
    EXPECT_LT(bendError(true, hsh, 40000), 0.12);
    EXPECT_LT(bendError(true, hsh, 1000), 0.25);
}

/// Irradiance at (x, y, 0) by a polygon of radiance 1: half the sum over edges of the angle times
/// the normal of the edge's plane (Lambert 1760).
double irradianceOfLamp(double x, double y) {
    const std::array<Direction, 4> corners{{{-0.5 - x, -0.4 - y, 1.5},
                                            {0.5 - x, -0.4 - y, 1.5},
                                            {0.5 - x, 0.6 - y, 1.5},
                                            {-0.5 - x, 0.6 - y, 1.5}}};
    double sum = 0;
    for (std::size_t k = 0; k < 4; ++k) {
        const Direction a = normalised(corners[k]), b = normalised(corners[(k + 1) % 4]);
        sum += std::acos(dot(a, b)) * normalised(cross(a, b)).z / 2;
    }
    return std::abs(sum);
}

TEST(RecordGradient, IsThatOfTheIrradianceOfAPolygon) {
    const auto scene = lampAbove(false);
    const double x = 0.35, y = -0.2, h = 1e-4;
    const double alongX = (irradianceOfLamp(x + h, y) - irradianceOfLamp(x - h, y)) / (2 * h);
    const double alongY = (irradianceOfLamp(x, y + h) - irradianceOfLamp(x, y - h)) / (2 * h);
    for (const Gradient gradient : {Gradient::strata, Gradient::hitPoints}) {
        const Record found = recordAt(*scene, x, y, {}, 100000, gradient);
        EXPECT_NEAR(found.part(0, 1)[0], irradianceOfLamp(x, y), 1e-3);
        const Direction& t = found.frame.tangent;
        const Direction& b = found.frame.bitangent;
        const double most = 0.03 * std::hypot(alongX, alongY);
        EXPECT_NEAR(found.part(1, 1)[0], t.x * alongX + t.y * alongY, most);
        EXPECT_NEAR(found.part(2, 1)[0], b.x * alongX + b.y * alongY, most);
    }
}

TEST(RecordBend, IsThatOfTheIrradianceOfAPolygon) {
    const auto scene = lampAbove(false);
    const double x = 0.35, y = -0.2, h = 1e-3;
    const Gathered found = gatheredAt(*scene, x, y, {}, 100000, Gradient::strata);
    const Direction &t = found.record.frame.tangent, &b = found.record.frame.bitangent;
    const auto at = [&](int i, int j) {
        return irradianceOfLamp(x + h * (i * t.x + j * b.x), y + h * (i * t.y + j * b.y));
    };
    const std::array<double, 3> expected{
        (at(1, 0) - 2 * at(0, 0) + at(-1, 0)) / (h * h),
        (at(1, 1) - at(1, -1) - at(-1, 1) + at(-1, -1)) / (4 * h * h),
        (at(0, 1) - 2 * at(0, 0) + at(0, -1)) / (h * h)};
    const double norm = std::hypot(expected[0], expected[1], expected[2]);
    for (const std::size_t k : {0U, 1U, 2U}) {
        EXPECT_NEAR(found.bends[k] / 3, expected[k], 0.03 * norm) << k;
    }
}

/// Points that stay where rays met them do not know what moves in front of them.
TEST(RecordGradient, SeesWhatComesIntoSightByStrataAlone) {
    const IncomingFunctions hsh(bases::make("hsh", 5));
    EXPECT_LT(gradientError(true, hsh, Gradient::strata, 100000), 0.05);
    EXPECT_GT(gradientError(true, hsh, Gradient::hitPoints, 100000), 0.3);
}

/// A reflection in a glossy wall moves as what it shows does: beside the wall, the gradient of
/// irradiance is small, as differences of irradiance are.
TEST(RecordGradient, TellsReflectionsFromTheSurfaceThatShowsThem) {
    std::vector<SurfaceObject> objects;
    objects.push_back({"floor", patch({-9, -9, 0}, {18, 0, 0}, {0, 18, 0}), 0, {}});
    objects.push_back({"lamp", patch({0.5, -0.4, 1.5}, {0, 1, 0}, {1, 0, 0}), 0, {1, 1, 1}});
    objects.push_back({"wall", patch({0, -9, 0}, {0, 18, 0}, {0, 0, 9}), 1, {}});
    const SurfaceScene scene(
        {materialOf("lambert:kd=0"), materialOf("phong:kd=0,ks=.8,exponent=10,normalized=true")},
        std::move(objects), {});
    const double x = 0.04, h = 0.02;
    const auto irradiance = [&](double at) {
        return static_cast<double>(
            recordAt(scene, at, 0, {}, 100000, Gradient::none).part(0, 1)[0]);
    };
    const double slope = (irradiance(x + h) - irradiance(x - h)) / (2 * h);
    const Record found = recordAt(scene, x, 0, {}, 20000, Gradient::strata);
    const double alongX = static_cast<double>(found.part(1, 1)[0]) * found.frame.tangent.x +
                          static_cast<double>(found.part(2, 1)[0]) * found.frame.bitangent.x;
    EXPECT_NEAR(alongX, slope, 0.5 * irradiance(x));
}

}  // namespace
}  // namespace hshfit
