// Rings of clustered azimuths against functions whose azimuth transforms are known in closed form.

#include <hshfit/brdf/directions.h>
#include <hshfit/projection/internal/rings.h>
#include <hshfit/quadrature/azimuth_tables.h>
#include <hshfit/quadrature/ring_points.h>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace hshfit {
namespace {

/// The Poisson kernel about an azimuth,
///     f = (1 - r^2) / ((1 - r)^2 + 4 r sin^2((phi - phi0) / 2))
/// = 1 + 2 sum over m of r^m cos(m (phi - phi0)), with a pole at a distance of -ln r; its square
/// integrates to 2 pi (1 + r^2) / (1 - r^2).
class PoissonBrdf final : public Brdf {
public:
    PoissonBrdf(double gap, double azimuth)
        : gap_(gap), x_(std::cos(azimuth)), y_(std::sin(azimuth)) {}
    std::string name() const override { return "poisson"; }
    const Channels& channels() const override { return channels_; }
    const Laws& laws() const override { return laws_; }
    void eval(const Direction&, DirectionBatch wi, double* out) const override {
        const double r = 1 - gap_;
        for (std::size_t k = 0; k < wi.count; ++k) {
            const double s = std::hypot(wi.x[k], wi.y[k]);
            const double dx = wi.x[k] / s - x_, dy = wi.y[k] / s - y_;
            out[k] = gap_ * (1 + r) / (gap_ * gap_ + r * (dx * dx + dy * dy));
        }
    }

private:
    double gap_, x_, y_;
    Channels channels_ = Channels::grey();
    Laws laws_;
};

HemisphereGrid oneRing(const AzimuthSpacing& spacing, double azimuth, std::size_t rings = 1) {
    HemisphereGrid grid;
    for (std::size_t r = 0; r < rings; ++r) {
        const double mu = 0.3 + 0.1 * static_cast<double>(r);
        grid.elevations.push_back({mu, 1 - mu});
        grid.sines.push_back(std::sqrt(1 - mu * mu));
        grid.weights.push_back(1);
    }
    grid.panels = {{.firstRing = 0,
                    .rings = rings,
                    .azimuths = {spacing, std::cos(azimuth), std::sin(azimuth)}}};
    return grid;
}

struct Case {
    double gap, azimuth;
    AzimuthSpacing spacing;
};

TEST(Rings, ClusteredAzimuthsTransformAPoleExactly) {
    // Errors fall as exp(-azimuths * distance): enough azimuths for 1e-15.
    const std::vector<Case> cases = {{0.5, 0.7, {128, 0}},      {0.5, 0.7, {160, 1}},
                                     {1e-2, -2.4, {512, 3}},    {1e-4, 1.1, {4096, 6}},
                                     {1e-4, pi / 2, {4096, 7}}, {1e-6, 3.0, {32768, 10}}};
    constexpr int order = 12;
    const AzimuthTables tables(order);
    const Direction wo{0, 0, 1};
    for (const Case& c : cases) {
        const PoissonBrdf brdf(c.gap, c.azimuth);
        for (const std::size_t rings : {1u, 2u, 3u, 7u}) {
            RingSpectrum spectrum;
            sampleRings(brdf, wo, oneRing(c.spacing, c.azimuth, rings), Quantity::brdf, tables,
                        false, spectrum);
            const double r = 1 - c.gap, energy = 2 * pi * (1 + r * r) / (c.gap * (1 + r));
            for (std::size_t ring = 0; ring < rings; ++ring) {
                EXPECT_NEAR(spectrum.squares[ring] / energy, 1, 1e-9) << c.gap << " " << rings;
                EXPECT_NEAR(spectrum.part(ring, 0, 0), std::sqrt(2 * pi), 1e-9);
                for (int m = 1; m < order; ++m) {
                    const double size = 2 * std::sqrt(pi) * std::pow(r, m);
                    EXPECT_NEAR(spectrum.part(ring, 0, m), size * std::cos(m * c.azimuth), 1e-9)
                        << c.gap << " " << m;
                    EXPECT_NEAR(spectrum.part(ring, 0, -m), size * std::sin(m * c.azimuth), 1e-9)
                        << c.gap << " " << m;
                }
            }
        }
    }
}

TEST(Rings, HalfOfAnEvenRingGivesTheSameTransform) {
    constexpr int order = 9;
    const AzimuthTables tables(order);
    for (const double azimuth : {0.0, pi}) {
        const PoissonBrdf brdf(1e-3, azimuth);
        // The centre exactly on the axis, as the projector makes it.
        HemisphereGrid grid = oneRing({1024, 4}, azimuth, 3);
        grid.panels[0].azimuths.centreY = 0;
        RingSpectrum whole, half;
        sampleRings(brdf, {0, 0, 1}, grid, Quantity::brdfCosine, tables, false, whole);
        sampleRings(brdf, {0, 0, 1}, grid, Quantity::brdfCosine, tables, true, half);
        EXPECT_EQ(2 * half.evaluations, whole.evaluations);
        for (std::size_t ring = 0; ring < 3; ++ring) {
            EXPECT_NEAR(half.squares[ring] / whole.squares[ring], 1, 1e-11);
            for (int m = 0; m < order; ++m)
                EXPECT_NEAR(half.part(ring, 0, m), whole.part(ring, 0, m), 1e-11) << m;
        }
    }
}

TEST(Rings, PointsAreThoseOfTheTransform) {
    const PoissonBrdf brdf(1e-2, 2.0);
    const HemisphereGrid grid = oneRing({256, 3}, 2.0);
    RingPoints points(grid);
    ASSERT_TRUE(points.next());
    double area = 0, integral = 0, side = 0;
    std::vector<double> f(points.count());
    brdf.eval({0, 0, 1}, points.directions(), f.data());
    for (std::size_t j = 0; j < points.count(); ++j) {
        const Direction d = points.direction(j);
        EXPECT_NEAR(d.x * d.x + d.y * d.y + d.z * d.z, 1, 1e-14);
        area += points.weight(j);
        integral += points.weight(j) * f[j];
        if (j < points.count() / 2) side += points.weight(j);
        const double cross = std::cos(2.0) * d.y - std::sin(2.0) * d.x;
        EXPECT_EQ(cross > 0, j < points.count() / 2) << j;
    }
    EXPECT_NEAR(area, 2 * pi, 1e-12);
    EXPECT_NEAR(side, pi, 1e-12);
    EXPECT_NEAR(integral, 2 * pi, 1e-6);
    EXPECT_FALSE(points.next());
}

/// More tables than there is room for: those that are not kept are the same.
TEST(Rings, TablesBeyondTheCacheAreBitwiseIdentical) {
    constexpr int order = 200;  // 400 columns, and 8 M values in 40 or so of the largest tables
    const AzimuthTables tables(order);
    for (std::size_t k = 0; k < 60; ++k) {
        const AzimuthSpacing spacing{1200 - 4 * k, 3};
        const auto table = tables.find(spacing);
        ASSERT_TRUE(table) << k;
        AzimuthTable fresh;
        fresh.fill(order, spacing, 0, tableSize(spacing));
        EXPECT_EQ(table->count, fresh.count);
        EXPECT_EQ(table->cosine, fresh.cosine);
        EXPECT_EQ(table->weights, fresh.weights);
        EXPECT_EQ(table->rows, fresh.rows);
    }
    EXPECT_FALSE(tables.find({1 << 20, 3}));
}

/// The panel across a halfway lobe's peak: azimuths grow at most like the root of 1 / width.
TEST(Rings, AzimuthsGrowWithTheRootOfTheWidth) {
    const Direction wo = directionFromAngles(radians(60), 0.4);
    const auto azimuths = [&](double width, bool squeezed) {
        const std::vector<Lobe> lobes = {{Lobe::About::halfway, width}};
        HemisphereGrid grid;
        const double u = std::sqrt(wo.z);
        appendPanel(grid, u - width, u + width, {lobes, wo, u - width, u + width},
                    {.order = 7, .level = 2, .squeezed = squeezed});
        return static_cast<double>(grid.panels[0].azimuths.spacing.azimuths);
    };
    for (const double width : {1e-1, 1e-2, 1e-3, 1e-4}) {
        EXPECT_LE(azimuths(width / 10, true), azimuths(width, true) * std::sqrt(10) * 1.5) << width;
        EXPECT_LE(azimuths(width, true), azimuths(width, false)) << width;
    }
    EXPECT_LE(azimuths(1e-4, true) * 30, azimuths(1e-4, false));
}

/// Nowhere fewer azimuths than a BRDF without lobes gets: something that no lobe announces is seen
/// as well as with equispaced azimuths.
TEST(Rings, ClusteredAzimuthsAreNowhereSparserThanWithoutLobes) {
    const Direction wo = directionFromAngles(radians(70), 0);
    for (const double width : {0.3, 0.1, 1e-2, 1e-3})
        for (const int order : {1, 7, 30})
            for (const int level : {0, 3, 6}) {
                const std::vector<Lobe> lobes = {{Lobe::About::halfway, width}};
                HemisphereGrid with, without;
                const GridOptions options{.order = order, .level = level, .squeezed = true};
                appendPanel(with, 0.5, 0.6, {lobes, wo, 0.5, 0.6}, options);
                appendPanel(without, 0.5, 0.6, {{}, wo, 0.5, 0.6}, options);
                const AzimuthSpacing& spacing = with.panels[0].azimuths.spacing;
                EXPECT_GE(static_cast<double>(spacing.azimuths) * spacing.kappa(),
                          static_cast<double>(without.panels[0].azimuths.spacing.azimuths) - 4);
            }
}

}  // namespace
}  // namespace hshfit
