// Averages of turned lobes: the coefficients against quadrature and direct sums, and the laws of
// the evaluation.

#include <lib/normal_filtering/maps.h>

#include <hshfit/bases/sh.h>
#include <hshfit/error.h>
#include <hshfit/normal_filtering/filtered_texel.h>
#include <hshfit/normal_filtering/internal/gaussian_sum.h>
#include <hshfit/normal_filtering/mip_errors.h>
#include <hshfit/normal_filtering/surface_frame.h>
#include <hshfit/quadrature/quadrature.h>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>

namespace {

using namespace hshfit;
using hshfit::test::ggxTable;

/// GGX from alpha = 0.05 to 1 in 33 geometric steps.
double alphaAt(double row) {
    return 0.05 * std::pow(20.0, row / 32);
}
std::shared_ptr<const LobeTable> ggxTables(int order) {
    return std::make_shared<LobeTable>(
        33, 1,
        [](std::size_t row, std::size_t) {
            const double alpha = alphaAt(static_cast<double>(row));
            return test::ggxDistribution(alpha, alpha);
        },
        LobeTableOptions{order});
}

std::vector<SurfaceTexel> randomTexels(std::size_t count, unsigned seed) {
    std::mt19937_64 random(seed);
    std::vector<SurfaceTexel> texels(count);
    for (SurfaceTexel& t : texels) {
        t.normal = {uniform(random) - 0.5, uniform(random) - 0.5, 1};
        t.tangent = {uniform(random) - 0.5, uniform(random) - 0.5, 0.3};
        t.lobe = {32 * uniform(random), 0};
        for (double& w : t.weights) w = uniform(random);
        for (double& a : t.albedos) a = uniform(random);
    }
    return texels;
}

/// Integral over the sphere of g(direction).
template <class Function>
double overSphere(int rings, const Function& g) {
    const GaussRule& rule = gaussLegendre(rings);
    const int azimuths = 2 * rings;
    double sum = 0;
    for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
        const double z = rule.nodes[k], s = std::sqrt(1 - z * z);
        for (int j = 0; j < azimuths; ++j) {
            const double phi = 2 * pi * (j + 0.25) / azimuths;
            sum += rule.weights[k] * 2 * pi / azimuths *
                   g(Direction{s * std::cos(phi), s * std::sin(phi), z});
        }
    }
    return sum;
}

/// The mean of w D(R^-1 h) over texels, D even.
double meanDensity(std::span<const SurfaceTexel> texels, std::size_t weight, const Direction& h,
                   double ax, double ay) {
    double sum = 0;
    for (const SurfaceTexel& t : texels) {
        const Direction n = normalised(t.normal);
        const Direction x = normalised(t.tangent - dot(t.tangent, n) * n);
        const Direction local{dot(h, x), dot(h, cross(n, x)), dot(h, n)};
        sum += t.weights[weight] * test::ggxDensity(local, ax, ay);
    }
    return sum / static_cast<double>(texels.size());
}

class FilteredCoefficients : public testing::TestWithParam<std::pair<double, double>> {};

TEST_P(FilteredCoefficients, EqualQuadratureOfTheAveragedDistribution) {
    const double ax = GetParam().first, ay = GetParam().second;
    constexpr int order = 9;
    std::vector<SurfaceTexel> texels = randomTexels(4, 7);
    const MipLayout layout{.weights = 2, .albedos = 0, .order = order};
    const MipLevel top = filterNormals(2, 2, texels, ggxTable(order, ax, ay), layout).back();
    const auto basis = bases::makeSh(order, {});
    for (const std::pair<int, int>& each :
         {std::pair{0, 0}, {2, -2}, {2, 1}, {4, 0}, {4, 3}, {8, -7}, {8, 8}}) {
        const int l = each.first, m = each.second;
        for (int k = 0; k < 2; ++k) {
            const double expected = overSphere(200, [&](const Direction& h) {
                std::vector<double> y(order * order);
                basis->evaluate(h, y.data());
                return y[static_cast<std::size_t>(slotOf(l, m))] *
                       meanDensity(texels, static_cast<std::size_t>(k), h, ax, ay);
            });
            EXPECT_NEAR(
                top.texel(0, 0)[layout.harmonics(k) + static_cast<std::size_t>(evenSlotOf(l, m))],
                expected, 1e-9)
                << l << " " << m;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Lobes, FilteredCoefficients,
                         testing::Values(std::pair{0.4, 0.4}, std::pair{0.3, 0.6}));

TEST(FilteredLevels, AreMeansOverTheirBaseTexels) {
    constexpr int order = 5;
    const auto table = ggxTables(order);
    const MipLayout layout{.weights = 1, .albedos = 2, .order = order};
    const std::vector<SurfaceTexel> texels = randomTexels(8 * 4, 3);
    const auto levels = filterNormals(8, 4, texels, table, layout);
    ASSERT_EQ(levels.size(), 3U);
    const auto basis = bases::makeSh(order, {});
    for (int level = 1; level <= 2; ++level) {
        const MipLevel& made = levels[static_cast<std::size_t>(level - 1)];
        const std::size_t side = std::size_t{1} << level;
        ASSERT_EQ(made.width, 8 / side);
        ASSERT_EQ(made.height, 4 / side);
        for (std::size_t y = 0; y < made.height; ++y)
            for (std::size_t x = 0; x < made.width; ++x) {
                std::vector<double> sum(layout.size(), 0.0);
                const double share = 1 / static_cast<double>(side * side);
                for (std::size_t k = 0; k < side * side; ++k) {
                    const SurfaceTexel& t = texels[(y * side + k / side) * 8 + x * side + k % side];
                    const Direction n = normalised(t.normal);
                    std::vector<double> values(25), zonal(3);
                    basis->evaluate(n, values.data());
                    table->zonal(t.lobe, zonal);
                    sum[MipLayout::normal] += share * n.x;
                    sum[MipLayout::normal + 2] += share * n.z;
                    sum[MipLayout::planeSquares + 1] +=
                        share * 4 * n.x * n.y / ((1 + n.z) * (1 + n.z));
                    sum[MipLayout::lobe] += share * t.lobe[0];
                    sum[layout.albedo(1) + 5] += share * t.albedos[1] * values[5];
                    sum[layout.harmonics(0) + 13] +=
                        share * t.weights[0] * values[4 * 4 + 7] * std::sqrt(4 * pi / 9) * zonal[2];
                }
                for (const std::size_t i :
                     {MipLayout::normal, MipLayout::normal + 2, MipLayout::planeSquares + 1,
                      MipLayout::lobe, layout.albedo(1) + 5, layout.harmonics(0) + 13})
                    EXPECT_NEAR(made.texel(x, y)[i], sum[i], 1e-13 * (1 + std::abs(sum[i]))) << i;
            }
    }
}

TEST(FilteredLevels, OfOddSizesKeepTheMeanOfTheBase) {
    const MipLayout layout{.weights = 1, .albedos = 1, .order = 3};
    const std::vector<SurfaceTexel> texels = randomTexels(7 * 5, 4);
    Direction mean{0, 0, 0};
    for (const SurfaceTexel& t : texels) mean = mean + 1.0 / 35 * normalised(t.normal);
    const auto levels = filterNormals(7, 5, texels, ggxTables(3), layout);
    ASSERT_EQ(levels.size(), 2U);
    EXPECT_EQ(levels[0].width, 3U);
    EXPECT_EQ(levels[0].height, 2U);
    for (const MipLevel& level : levels) {
        double x = 0;
        for (std::size_t k = 0; k < level.width * level.height; ++k)
            x += level.texel(k % level.width, k / level.width)[MipLayout::normal] /
                 static_cast<double>(level.width * level.height);
        EXPECT_NEAR(x, mean.x, 1e-15) << level.width;
    }
}

TEST(FilteredLevels, AreTheSameBitsForAnyPortionsAndThreads) {
    const MipLayout layout{.weights = 2, .albedos = 1, .order = 5};
    constexpr std::size_t width = 300, height = 21;
    const std::vector<SurfaceTexel> texels = randomTexels(width * height, 5);
    const auto table = ggxTables(5);
    const auto filtered = [&](std::size_t rows) {
        std::vector<double> all;
        MipFilter filter(width, height, table, layout, [&](const MipRow& row) {
            all.push_back(row.level * 1000 + static_cast<double>(row.y));
            all.insert(all.end(), row.texels.begin(), row.texels.end());
        });
        for (std::size_t y = 0; y < height; y += rows)
            filter.add(std::span(texels).subspan(y * width, std::min(rows, height - y) * width));
        EXPECT_TRUE(filter.complete());
        return all;
    };
    const std::vector<double> once = filtered(height);
    EXPECT_EQ(filtered(1), once);
    EXPECT_EQ(filtered(4), once);
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    EXPECT_EQ(filtered(5), once);
}

MipLevel constantLevel(const SurfaceTexel& texel, std::shared_ptr<const LobeTable> table,
                       int order) {
    return filterNormals(2, 2, std::vector<SurfaceTexel>(4, texel), std::move(table),
                         {.weights = 1, .albedos = 1, .order = order})
        .back();
}

TEST(ConstantNormals, ReproduceTheLobeToTheStatedTruncation) {
    for (const double alpha : {0.15, 0.4}) {
        const auto table = ggxTable(129, alpha, alpha);
        SurfaceTexel tilted;
        tilted.normal = {0.3, -0.2, 1};
        const Direction n = normalised(tilted.normal);
        const MipLevel level = constantLevel(tilted, table, 33);
        const FilteredTexel texel(level.layout, level.texel(0, 0), *table);
        const auto error = [&](const MipUse& use) {
            double distance = 0;
            const double norm = overSphere(150, [&](const Direction& h) {
                const double z = dot(h, n);
                if (z < 0.1) return 0.0;  // the ellipse leaves out what is past the horizon
                const double d = test::ggxDensity({std::sqrt(1 - z * z), 0, z}, alpha, alpha);
                return d * d;
            });
            distance = overSphere(150, [&](const Direction& h) {
                const double z = dot(h, n);
                if (z < 0.1) return 0.0;
                const double d = test::ggxDensity({std::sqrt(1 - z * z), 0, z}, alpha, alpha);
                double found = 0;
                texel.density(use, h, {&found, 1});
                return (found - d) * (found - d);
            });
            return std::sqrt(distance / norm);
        };
        for (const int order : {9, 17, 33}) {
            const double stated = table->truncation({0, 0}, order);
            const double found = error({MipForm::harmonics, order});
            EXPECT_LE(found, 1.02 * stated + 1e-6) << alpha << " " << order;
            EXPECT_GE(found, 0.5 * stated - 1e-6) << alpha << " " << order;
        }
        EXPECT_LT(error({MipForm::ellipse}), 0.01) << alpha;
    }
}

TEST(ConstantNormals, ReproduceTurnedAnisotropicLobes) {
    constexpr double ax = 0.15, ay = 0.4;
    const auto table = ggxTable(65, ax, ay);
    SurfaceTexel t;
    t.normal = {0.2, 0.1, 1};
    t.tangent = {std::cos(0.5), std::sin(0.5), 0};
    const MipLevel level = constantLevel(t, table, 65);
    const FilteredTexel texel(level.layout, level.texel(0, 0), *table);
    std::mt19937_64 random(3);
    const double peak = 1 / (pi * ax * ay);
    for (int k = 0; k < 50; ++k) {
        const Direction h =
            normalised(t.normal + Direction{uniform(random) - 0.5, uniform(random) - 0.5, 0});
        const double expected = meanDensity({&t, 1}, 0, h, ax, ay);
        double harmonics = 0, ellipse = 0;
        texel.density({MipForm::harmonics}, h, {&harmonics, 1});
        texel.density({MipForm::ellipse}, h, {&ellipse, 1});
        EXPECT_NEAR(harmonics, expected, 1e-3 * peak);
        EXPECT_NEAR(ellipse, expected, 0.04 * peak);
    }
}

TEST(ConstantNormals, KeepTheAreaOfFacetsAndTheCosine) {
    for (const double alpha : {0.1, 0.3, 0.6}) {
        const auto table = ggxTable(65, alpha, alpha);
        SurfaceTexel flat;
        flat.albedos[0] = 0.7;
        const MipLevel level = constantLevel(flat, table, 65);
        const FilteredTexel texel(level.layout, level.texel(0, 0), *table);
        for (const MipForm form : {MipForm::harmonics, MipForm::ellipse}) {
            const double area = overSphere(160, [&](const Direction& h) {
                if (h.z <= 0) return 0.0;
                double d = 0;
                texel.density({form}, h, {&d, 1});
                return d * h.z;
            });
            EXPECT_NEAR(area, 1, 0.01) << alpha << (form == MipForm::ellipse);
        }
        double diffuse = 0;
        const Direction wi = directionFromAngles(1.2, 0.4);
        texel.diffuse(wi, {0, 0, 1}, {&diffuse, 1});
        EXPECT_NEAR(diffuse, 0.7 * wi.z, 1e-12);
    }
}

TEST(FilteredTexel, TurnsWithItsNormals) {
    constexpr int order = 9;
    const auto table = ggxTable(order, 0.3, 0.5);
    const MipLayout layout{.weights = 1, .albedos = 1, .order = order};
    std::vector<SurfaceTexel> texels = randomTexels(16, 9), turned = texels;
    constexpr double angle = 1.1;
    for (SurfaceTexel& t : turned) {
        t.normal = rotateAboutZ(t.normal, angle);
        t.tangent = rotateAboutZ(t.tangent, angle);
    }
    const MipLevel before = filterNormals(4, 4, texels, table, layout).back(),
                   after = filterNormals(4, 4, turned, table, layout).back();
    const FilteredTexel a(layout, before.texel(0, 0), *table), b(layout, after.texel(0, 0), *table);
    const FilteredTexel::Rest rest = [](const FilteredTexel&, const Direction& wi,
                                        const Direction& wo, std::span<const double> density,
                                        std::span<double> out) {
        out[0] = density[0] * (1 + wi.x * wi.x) / (wi.z + wo.z);
    };
    for (const double theta : {0.1, 0.7, 1.4}) {
        const Direction wi = directionFromAngles(theta, 0.3), wo = directionFromAngles(0.9, 2.2);
        for (const MipForm form : {MipForm::harmonics, MipForm::ellipse}) {
            double first = 0, second = 0;
            a.reflect({form}, rest, wi, wo, {&first, 1});
            b.reflect({form}, rest, rotateAboutZ(wi, angle), rotateAboutZ(wo, angle), {&second, 1});
            EXPECT_GT(first, 0);
            EXPECT_NEAR(second, first, 1e-11 * first);
        }
    }
}

TEST(FilteredTexel, DiffusePartIsTheMeanOverGaussianNormals) {
    const test::SlopeMap map = test::SlopeMap::bumpy(0.35);
    constexpr std::size_t size = 128;
    std::vector<SurfaceTexel> texels(size * size);
    for (std::size_t k = 0; k < texels.size(); ++k) {
        texels[k].normal = map.normal(static_cast<double>(k % size), static_cast<double>(k / size));
        texels[k].albedos[0] = 0.5;
    }
    const auto table = ggxTable(3, 0.3, 0.3);
    const MipLayout layout{.weights = 0, .albedos = 1, .order = 1};
    const MipLevel top = filterNormals(size, size, texels, table, layout).back();
    const FilteredTexel texel(layout, top.texel(0, 0), *table);
    for (const double in : {0.0, 0.8, 1.4})
        for (const double out : {0.0, 1.0, 1.45}) {
            const Direction wi = directionFromAngles(in, 0.5), wo = directionFromAngles(out, 2.5);
            double mean = 0, found = 0;
            for (const SurfaceTexel& t : texels)
                if (dot(t.normal, wo) > 0)
                    mean +=
                        0.5 * std::max(0.0, dot(t.normal, wi)) / static_cast<double>(texels.size());
            texel.diffuse(wi, wo, {&found, 1});
            EXPECT_NEAR(found, mean, 0.01) << in << " " << out;
        }
}

TEST(FilteredTexel, OfNormalsThatCancelHasTheSurfaceNormal) {
    std::vector<SurfaceTexel> texels(4);
    for (std::size_t k = 0; k < 4; ++k) texels[k].normal = {k % 2 == 0 ? 1.0 : -1.0, 0, 0};
    const auto table = ggxTable(17, 0.3, 0.3);
    const MipLayout layout{.weights = 1, .albedos = 1, .order = 17};
    const MipLevel top = filterNormals(2, 2, texels, table, layout).back();
    const FilteredTexel texel(layout, top.texel(0, 0), *table);
    EXPECT_EQ(texel.meanNormalLength(), 0);
    EXPECT_EQ(texel.normal().z, 1);
    for (const Direction h : {Direction{0, 0, 1}, normalised({1, 0, 0.1})})
        for (const MipForm form : {MipForm::harmonics, MipForm::ellipse}) {
            double d = -1;
            texel.density({form}, h, {&d, 1});
            EXPECT_TRUE(std::isfinite(d) && d >= 0) << d;
        }
}

TEST(HalfPrecision, KeepsNumbersToElevenBitsAndNarrowCovariances) {
    const auto table = ggxTables(17);
    const MipLayout layout{.weights = 2, .albedos = 1, .order = 17};
    std::vector<SurfaceTexel> texels = randomTexels(4, 2);
    for (std::size_t k = 0; k < 4; ++k)  // nearly constant: moments would cancel
        texels[k].normal = {0.4 + 1e-3 * static_cast<double>(k % 2),
                            -0.3 + 2e-3 * static_cast<double>(k / 2), 1};
    const MipLevel top = filterNormals(2, 2, texels, table, layout).back();
    const auto texel = top.texel(0, 0);
    std::vector<std::uint16_t> stored(layout.size());
    std::vector<double> decoded(layout.size());
    encodeHalf(layout, texel, stored);
    decodeHalf(layout, stored, decoded);
    const double rounding = std::ldexp(1.0, -11), least = std::ldexp(1.0, -25);
    for (std::size_t i = MipLayout::lobe; i < layout.size(); ++i)
        EXPECT_NEAR(decoded[i], texel[i], rounding * std::abs(texel[i]) + least) << i;
    const auto variance = [](std::span<const double> t, std::size_t a, std::size_t square) {
        return t[MipLayout::planeSquares + square] -
               t[MipLayout::plane + a] * t[MipLayout::plane + a];
    };
    EXPECT_NEAR(variance(decoded, 0, 0) / variance(texel, 0, 0), 1, 0.002);
    EXPECT_NEAR(variance(decoded, 1, 2) / variance(texel, 1, 2), 1, 0.002);
    std::vector<double> large(texel.begin(), texel.end());
    large[layout.harmonics(0)] = 1e6;
    EXPECT_THROW(encodeHalf(layout, large, stored), NumericError);
}

TEST(LobeTable, InterpolatesBetweenEntries) {
    const auto table = ggxTables(33);
    for (const double row : {0.5, 10.5, 20.25, 31.5}) {
        const double alpha = alphaAt(row);
        const auto exact = ggxTable(33, alpha, alpha);
        std::vector<double> a(17), b(17);
        table->zonal({row, 0}, a);
        exact->zonal({0, 0}, b);
        double distance = 0, norm = 0;
        for (std::size_t k = 0; k < a.size(); ++k) {
            distance += (a[k] - b[k]) * (a[k] - b[k]);
            norm += b[k] * b[k];
        }
        EXPECT_LT(std::sqrt(distance / norm), 0.004) << alpha;
        EXPECT_NEAR(table->widths({row, 0})[0], alpha, 0.003 * alpha);
    }
    EXPECT_EQ(table->widths({-3, 0}), table->widths({0, 0}));
    EXPECT_EQ(table->widths({99, 5}), table->widths({32, 0}));
}

TEST(GaussianSums, HaveLeastSquaresUnderTheirSigns) {
    std::mt19937_64 random(8);
    std::vector<std::vector<double>> columns(6, std::vector<double>(10));
    std::vector<double> b(10);
    for (auto& column : columns)
        for (double& v : column) v = uniform(random) - 0.3;
    for (double& v : b) v = uniform(random) - 0.4;
    const std::vector<double> x = nonNegativeLeastSquares(columns, b);
    std::vector<double> rest = b;
    for (std::size_t j = 0; j < 6; ++j)
        for (std::size_t i = 0; i < 10; ++i) rest[i] -= columns[j][i] * x[j];
    int positive = 0, zero = 0;
    for (std::size_t j = 0; j < 6; ++j) {  // the conditions of Karush, Kuhn and Tucker
        double gradient = 0;
        for (std::size_t i = 0; i < 10; ++i) gradient += columns[j][i] * rest[i];
        EXPECT_GE(x[j], 0);
        if (x[j] > 0) {
            EXPECT_NEAR(gradient, 0, 1e-12);
            ++positive;
        } else {
            EXPECT_LT(gradient, 1e-12);
            ++zero;
        }
    }
    EXPECT_GT(positive, 0);
    EXPECT_GT(zero, 0);
}

TEST(GaussianSums, OfGgxAreWithinAHundredth) {
    for (const double alpha : {0.005, 0.02, 0.1, 0.2, 0.3, 0.5})
        EXPECT_LT(ggxTable(3, alpha, alpha)->gaussians({0, 0}).error, 0.01) << alpha;
}

TEST(Orders, AreTheLeastWhoseTailIsBelowTheTolerance) {
    const auto table = ggxTable(33, 0.2, 0.2);
    const MipLayout layout{.weights = 1, .albedos = 0, .order = 33};
    const MipLevel top = filterNormals(2, 2, randomTexels(4, 6), table, layout).back();
    const double* c = top.texels.data() + layout.harmonics(0);
    for (const double tolerance : {0.3, 0.05, 1e-9}) {
        const int order = orderFor(top, tolerance);
        const auto tail = [&](int from) {
            double all = 0, beyond = 0;
            for (std::size_t i = 0; i < evenSlots(33); ++i) {
                all += c[i] * c[i];
                if (i >= evenSlots(from)) beyond += c[i] * c[i];
            }
            return std::sqrt(beyond / all);
        };
        EXPECT_LE(tail(order), tolerance);
        ASSERT_GT(order, 1);
        EXPECT_GT(tail(order - 2), tolerance);
    }
}

}  // namespace
