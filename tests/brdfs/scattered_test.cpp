// Scattered samples: the charts, the interpolation and its limits.

#include <brdfs/catalog.h>
#include <brdfs/measured/scattered/interpolant.h>
#include <brdfs/measured/scattered/scattered.h>

#include <hshfit/accuracy/health.h>

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace hshfit::brdfs {
namespace {

class Directions {
public:
    Direction above(double lowest = 0.05) {
        const double z = lowest + (1 - lowest) * uniform_(engine_),
                     phi = 2 * pi * uniform_(engine_);
        const double r = std::sqrt(1 - z * z);
        return {r * std::cos(phi), r * std::sin(phi), z};
    }
    double number() { return uniform_(engine_); }

private:
    std::mt19937_64 engine_{20261121};
    std::uniform_real_distribution<double> uniform_;
};

Direction flipped(const Direction& d) {
    return {d.x, -d.y, d.z};
}

void expectSame(const Point& a, const Point& b, double tolerance) {
    EXPECT_LE(distance(a, b), tolerance)
        << a[0] << ' ' << a[1] << ' ' << a[2] << " against " << b[0] << ' ' << b[1] << ' ' << b[2];
}

TEST(Chart, symmetriesActBySigns) {
    Directions random;
    for (int k = 0; k < 200; ++k) {
        const Direction i = random.above(), o = random.above();
        const double turn = 2 * pi * random.number();
        const Point p = chartPoint(Chart::isotropic, i, o);
        expectSame(p, chartPoint(Chart::isotropic, rotateAboutZ(i, turn), rotateAboutZ(o, turn)),
                   1e-14);
        expectSame({p[0], -p[1], -p[2]}, chartPoint(Chart::isotropic, o, i), 1e-14);
        expectSame({p[0], p[1], -p[2]}, chartPoint(Chart::isotropic, flipped(i), flipped(o)),
                   1e-14);
        const Point q = chartPoint(Chart::anisotropic, i, o);
        expectSame({q[0], q[1], -q[2], -q[3]}, chartPoint(Chart::anisotropic, o, i), 1e-14);
    }
}

// The promise of the header: a small turn of one direction near the mirror configuration moves the
// point by about that angle.
TEST(Chart, distancesAreAnglesNearTheMirrorConfiguration) {
    const double step = radians(1);
    for (const double theta : {5.0, 30.0, 45.0}) {
        const Direction o = directionFromAngles(radians(theta), 0);
        for (const Chart chart : {Chart::isotropic, Chart::anisotropic}) {
            const Point mirror = chartPoint(chart, mirrored(o), o);
            const double moved = distance(
                mirror, chartPoint(chart, directionFromAngles(radians(theta) + step, pi), o));
            EXPECT_NEAR(moved / step, 1, 0.12) << theta;
        }
    }
}

struct Field {
    std::vector<Point> points;
    std::vector<double> values;
};

/// A smooth field of two channels at random points of the unit cube.
template <class Function>
Field sampled(int dimensions, std::size_t count, const Function& f) {
    Directions random;
    Field field;
    for (std::size_t k = 0; k < count; ++k) {
        Point x{};
        for (int d = 0; d < dimensions; ++d) x[static_cast<std::size_t>(d)] = random.number();
        field.points.push_back(x);
        field.values.push_back(f(x));
        field.values.push_back(2 - f(x));
    }
    return field;
}

TEST(ScatterInterpolant, takesTheValuesAtNodes) {
    const auto f = [](const Point& x) { return std::sin(5 * x[0]) * std::cos(3 * x[1]) + x[2]; };
    for (int dimensions = 1; dimensions <= 4; ++dimensions) {
        const Field field = sampled(dimensions, 300, f);
        const ScatterInterpolant interpolant(dimensions, field.points, field.values, 2);
        for (std::size_t k = 0; k < field.points.size(); ++k) {
            double out[2];
            interpolant.evaluate(field.points[k], 1, out, 1);
            // Nodes nearer than 2e-4 are one, which in one dimension some are.
            EXPECT_NEAR(out[0], field.values[2 * k], dimensions == 1 ? 2e-3 : 1e-12);
            EXPECT_NEAR(out[0] + out[1], 2, 1e-12);
        }
    }
}

TEST(ScatterInterpolant, reproducesLinearDataBetweenEvenNodes) {
    std::vector<Point> points;
    std::vector<double> values;
    for (int k = 0; k <= 20; ++k) {
        points.push_back({0.1 * k});
        values.push_back(3 - 0.2 * k);
    }
    const ScatterInterpolant interpolant(1, points, values, 1);
    for (double x = 0.3; x < 1.7; x += 0.013) {
        double out = 0;
        interpolant.evaluate({x}, 1, &out, 1);
        EXPECT_NEAR(out, 3 - 2 * x, 1e-12);
    }
}

// Between random nodes the limits of Q cut linear functions off here and there.
TEST(ScatterInterpolant, nearlyReproducesLinearDataBetweenRandomNodes) {
    const auto f = [](const Point& x) { return 1 + x[0] - 2 * x[1] + 0.5 * x[2] + 3 * x[3]; };
    for (int dimensions = 1; dimensions <= 4; ++dimensions) {
        const Field field = sampled(dimensions, 3000, f);
        const ScatterInterpolant interpolant(dimensions, field.points, field.values, 2);
        Directions random;
        double worst = 0;
        for (int k = 0; k < 300; ++k) {
            Point x{};
            for (int d = 0; d < dimensions; ++d) {
                x[static_cast<std::size_t>(d)] = 0.3 + 0.4 * random.number();
            }
            double out[2];
            interpolant.evaluate(x, 1, out, 1);
            worst = std::max(worst, std::fabs(out[0] - f(x)));
        }
        const double range[] = {0, 1, 3, 3.5, 6.5};  // over the cube
        EXPECT_LT(worst, 0.01 * range[dimensions]) << dimensions;
    }
}

TEST(ScatterInterpolant, isContinuousAndStaysInTheRangeOfTheData) {
    const auto f = [](const Point& x) { return x[0] > 0.5 ? 1.0 : 0.0; };
    const Field field = sampled(3, 400, f);
    const ScatterInterpolant interpolant(3, field.points, field.values, 2);
    double last = 0;
    const int steps = 100000;
    for (int k = 0; k <= steps; ++k) {
        const double t = static_cast<double>(k) / steps;
        double out[2];
        interpolant.evaluate({t, 0.3 + 0.4 * t, 0.9 - 0.8 * t, 0}, 1, out, 1);
        EXPECT_GE(out[0], 0);
        EXPECT_LE(out[0], 1);
        // The slope of a step between nodes some 0.05 apart is about 20; a jump would be more.
        if (k > 0) {
            EXPECT_LT(std::fabs(out[0] - last), 0.01) << t;
        }
        last = out[0];
    }
}

TEST(ScatterInterpolant, doesNotDependOnTheOrderOfThePoints) {
    const auto f = [](const Point& x) { return x[0] * x[0] + x[1]; };
    Field field = sampled(3, 200, f), reversed;
    for (std::size_t k = field.points.size(); k-- > 0;) {
        reversed.points.push_back(field.points[k]);
        reversed.values.insert(reversed.values.end(),
                               {field.values[2 * k], field.values[2 * k + 1]});
    }
    const ScatterInterpolant a(3, field.points, field.values, 2);
    const ScatterInterpolant b(3, reversed.points, reversed.values, 2);
    Directions random;
    for (int k = 0; k < 100; ++k) {
        const Point x{random.number(), random.number(), random.number(), 0};
        double first[2], second[2];
        a.evaluate(x, 9, first, 1);
        b.evaluate(x, 9, second, 1);
        EXPECT_EQ(first[0], second[0]);
    }
}

TEST(ScatterInterpolant, coincidentPointsBecomeTheirMean) {
    std::vector<Point> points(100, Point{0.5, 0.5, 0, 0});
    std::vector<double> values(100, 1.0);
    values[0] = 101;
    points.push_back({0.9, 0.5, 0, 0});
    values.push_back(7);
    const ScatterInterpolant interpolant(2, points, values, 1);
    EXPECT_EQ(interpolant.nodes(), 2u);
    double out = 0;
    interpolant.evaluate({0.5, 0.5, 0, 0}, 1, &out, 1);
    EXPECT_NEAR(out, 2, 1e-12);
}

/// A goniometer's grid: incidences 0 .. 75 by 15 degrees, outgoing directions by 5.
Samples goniometer(const Brdf& brdf, double firstPhi = -180, double lastPhi = 175) {
    Samples samples;
    samples.channels = brdf.channels();
    for (double ti = 0; ti <= 75; ti += 15) {
        for (double to = 0; to <= 80; to += 5) {
            for (double po = firstPhi; po <= lastPhi; po += 5) {
                const Direction wi = directionFromAngles(radians(ti), 0);
                const Direction wo = directionFromAngles(radians(to), radians(po));
                samples.add(wi, wo, evaluate(brdf, wi, wo), {"test", "sample", samples.size()});
            }
        }
    }
    return samples;
}

TEST(Scattered, aConstantIsReproducedWhereItWasMeasuredAndFadesBeyond) {
    const auto lambert = openModel("lambert:kd=.5");
    const Scattered brdf(goniometer(*lambert), {.reach = radians(6)}, "test");
    EXPECT_TRUE(brdf.laws().isotropic);  // one incident azimuth implies it
    Directions random;
    int covered = 0, faded = 0;
    for (int k = 0; k < 3000; ++k) {
        const Direction i = random.above(0), o = random.above(0);
        const double f = evaluate(brdf, i, o)[0];
        unsigned char inside = 0;
        brdf.coverage(o, {&i.x, &i.y, &i.z, 1}, &inside);
        covered += inside;
        if (inside) {
            EXPECT_NEAR(f, 0.5 / pi, 1e-12);
        } else {
            EXPECT_LT(f, 0.5 / pi);
            EXPECT_GE(f, 0);
            ++faded;
        }
    }
    EXPECT_GT(covered, 2000);
    EXPECT_GT(faded, 20);
    // Both directions at 89 degrees, 14 from the last incidence: far beyond 1.5 reach.
    const Direction low = directionFromAngles(radians(89), 1),
                    other = directionFromAngles(radians(89), 2.5);
    EXPECT_EQ(evaluate(brdf, low, other)[0], 0);
}

TEST(Scattered, keepsTheLawsThatItClaims) {
    const auto ggx = openModel("ggx:alpha=.4,F0=.6");
    const Scattered brdf(goniometer(*ggx, 0, 180), {}, "test");
    EXPECT_TRUE(brdf.laws().reciprocal && brdf.laws().mirrorSymmetric && brdf.laws().isotropic);
    Directions random;
    for (int k = 0; k < 500; ++k) {
        const Direction i = random.above(0), o = random.above(0);
        const double f = evaluate(brdf, i, o)[0], turn = 6 * random.number();
        EXPECT_GE(f, 0);
        EXPECT_EQ(f, evaluate(brdf, o, i)[0]);
        EXPECT_NEAR(f, evaluate(brdf, flipped(i), flipped(o))[0], 1e-9 * (1 + f));
        EXPECT_NEAR(f, evaluate(brdf, rotateAboutZ(i, turn), rotateAboutZ(o, turn))[0],
                    1e-6 * (1 + f));
    }
}

// Between samples 15 and 5 degrees apart the lobe of a rough metal is followed: no other
// interpolation serves as reference, so the model itself does.
TEST(Scattered, followsALobeBetweenItsSamples) {
    const auto ggx = openModel("ggx:alpha=.4,F0=.6");
    const Scattered brdf(goniometer(*ggx), {}, "test");
    Directions random;
    double missed = 0, total = 0;
    for (int k = 0; k < 4000; ++k) {
        const Direction i = random.above(0.26), o = random.above(0.26);  // up to 75 degrees
        const double expected = evaluate(*ggx, i, o)[0], got = evaluate(brdf, i, o)[0];
        missed += (got - expected) * (got - expected);
        total += expected * expected;
    }
    EXPECT_LT(std::sqrt(missed / total), 0.1);
    RecordProperty("relativeError", std::to_string(std::sqrt(missed / total)));
    std::printf("relative error between the samples: %.4f\n", std::sqrt(missed / total));
}

TEST(Scattered, anisotropicSamplesKeepTheirAxes) {
    const auto ward = openModel("ward:kd=.2,ks=.3,ax=.3,ay=.6");
    Samples samples;
    samples.channels = ward->channels();
    Directions random;
    for (int k = 0; k < 20000; ++k) {
        const Direction i = random.above(0.2), o = random.above(0.2);
        samples.add(i, o, evaluate(*ward, i, o), {"test", "sample", samples.size()});
    }
    const Scattered brdf(std::move(samples), {}, "test");
    EXPECT_FALSE(brdf.laws().isotropic);
    double missed = 0, total = 0;
    for (int k = 0; k < 2000; ++k) {
        const Direction i = random.above(0.4), o = random.above(0.4);
        const double expected = evaluate(*ward, i, o)[0], got = evaluate(brdf, i, o)[0];
        missed += (got - expected) * (got - expected);
        total += expected * expected;
        EXPECT_EQ(got, evaluate(brdf, o, i)[0]);
    }
    std::printf("relative error between the samples: %.4f\n", std::sqrt(missed / total));
    EXPECT_LT(std::sqrt(missed / total), 0.15);
}

/// f of a pair that is larger by `factor` for wi above wo than for the exchanged pair.
Samples contradicting(double factor) {
    Samples samples;
    samples.channels = Channels::grey();
    for (double ti = 10; ti <= 70; ti += 10)
        for (double to = 10; to <= 70; to += 10)
            for (double po = -170; po <= 180; po += 10) {
                const double f = (2 + std::cos(radians(po))) * (ti > to ? factor : 1);
                samples.add(directionFromAngles(radians(ti), 0),
                            directionFromAngles(radians(to), radians(po)), {&f, 1},
                            {"test", "sample", samples.size()});
            }
    return samples;
}

// The defect of pairs of values v and factor v is (factor - 1) / (factor + 1), diluted by pairs of
// one elevation, which agree.
TEST(Scattered, keepsBothOfTwoSamplesThatContradictEachOther) {
    const Scattered brdf(contradicting(3.6), {}, "test");
    EXPECT_FALSE(brdf.laws().reciprocal);
    const Direction low = directionFromAngles(radians(60), 0.0);
    const Direction high = directionFromAngles(radians(20), radians(50));
    const double f = 2 + std::cos(radians(50));
    EXPECT_NEAR(evaluate(brdf, low, high)[0], 3.6 * f, 1e-9);
    EXPECT_NEAR(
        evaluate(brdf, rotateAboutZ(high, -radians(50)), rotateAboutZ(low, -radians(50)))[0], f,
        1e-9);
    const auto both = brdf.bothOrders();
    ASSERT_TRUE(both);
    EXPECT_NEAR(both->largestRatio, 3.6, 1e-12);
    EXPECT_GT(both->defect, 0.4);
    EXPECT_LT(both->defect, 2.6 / 4.6);
    ASSERT_TRUE(both->worst);
    EXPECT_NEAR(std::max(both->worst->value, both->worst->exchanged) /
                    std::min(both->worst->value, both->worst->exchanged),
                3.6, 1e-12);
    EXPECT_GT(examine(brdf).reciprocityDefect, 0.1);

    const Scattered agreeing(contradicting(1), {}, "test");
    EXPECT_TRUE(agreeing.laws().reciprocal);
    ASSERT_TRUE(agreeing.bothOrders());
    EXPECT_EQ(agreeing.bothOrders()->pairs, both->pairs);
    EXPECT_EQ(agreeing.bothOrders()->defect, 0);
    EXPECT_EQ(examine(agreeing).reciprocityDefect, 0);
    EXPECT_FALSE(Scattered(contradicting(2), {.exchange = false}, "test").bothOrders());
}

// A hint for the quadrature, from the samples: as wide as the lobe, about its centre.
TEST(Scattered, showsTheLobesOfItsSamples) {
    const auto lobesOf = [](double (*f)(const Direction&, const Direction&)) {
        Samples samples;
        samples.channels = Channels::grey();
        // At normal incidence the mirror direction is the way back.
        for (double ti = 20; ti <= 60; ti += 20)
            for (double to = 0; to <= 80; to += 1)
                for (double po = -180; po < 180; po += 6) {
                    const Direction wi = directionFromAngles(radians(ti), 0);
                    const Direction wo = directionFromAngles(radians(to), radians(po));
                    const double value = f(wi, wo);
                    samples.add(wi, wo, {&value, 1}, {"test", "sample", samples.size()});
                }
        return Scattered(std::move(samples), {}, "test").lobes(directionFromAngles(0.5, 1));
    };
    EXPECT_TRUE(lobesOf([](const Direction&, const Direction&) { return 1.0; }).empty());
    const auto back = lobesOf([](const Direction& i, const Direction& o) {
        return 0.1 + std::exp(-std::pow(std::acos(std::min(1.0, dot(i, o))) / radians(3), 2));
    });
    ASSERT_EQ(back.size(), 1u);
    EXPECT_EQ(back[0].about, Lobe::About::axis);
    EXPECT_GE(back[0].width, radians(2));  // half of the peak is at 2.5 degrees
    EXPECT_LE(back[0].width, radians(4));
    EXPECT_NEAR(dot(back[0].axis, directionFromAngles(0.5, 1)), 1, 1e-12);
    const auto mirror = lobesOf([](const Direction& i, const Direction& o) {
        const double slope = std::hypot(i.x + o.x, i.y + o.y) / (i.z + o.z);
        return 0.1 + std::exp(-std::pow(slope / 0.1, 2));
    });
    ASSERT_EQ(mirror.size(), 1u);
    EXPECT_EQ(mirror[0].about, Lobe::About::halfway);
    EXPECT_GE(mirror[0].width, radians(4));
    EXPECT_LE(mirror[0].width, radians(8));
}

TEST(Scattered, noSampleAboveTheHorizonIsAnError) {
    Samples samples;
    samples.channels = Channels::grey();
    const double one[] = {1.0};
    samples.add({0, 0, -1}, {0, 0, 1}, one, {"test", "sample", 0});
    EXPECT_EQ(samples.census.belowHorizon, 1u);
    EXPECT_THROW(Scattered(std::move(samples), {}, "test"), InputError);
}

}  // namespace
}  // namespace hshfit::brdfs
