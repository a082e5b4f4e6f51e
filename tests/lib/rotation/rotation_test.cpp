// The rotation of directions: every way to make one, against its definition.

#include <hshfit/error.h>
#include <hshfit/rotation/rotation.h>

#include <lib/rotation/random.h>

#include <gtest/gtest.h>

#include <limits>

namespace {

using namespace hshfit;
using hshfit::test::Random;

constexpr double rounding = 4e-16;

void expectNear(const Direction& a, const Direction& b, double tolerance = 4 * rounding) {
    EXPECT_NEAR(a.x, b.x, tolerance);
    EXPECT_NEAR(a.y, b.y, tolerance);
    EXPECT_NEAR(a.z, b.z, tolerance);
}

void expectNear(const Rotation& a, const Rotation& b, double tolerance = 4 * rounding) {
    for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(a.matrix()[i], b.matrix()[i], tolerance) << i;
}

TEST(Rotation, EulerAnglesTurnAboutZThenYThenZ) {
    // About y, z goes towards x; about z, x goes towards y.
    expectNear(Rotation::euler(0, pi / 2, 0)({0, 0, 1}), {1, 0, 0});
    expectNear(Rotation::euler(pi / 2, 0, 0)({1, 0, 0}), {0, 1, 0});
    expectNear(Rotation::euler(pi / 2, pi / 2, 0)({0, 0, 1}), {0, 1, 0});
    const Rotation all = Rotation::euler(0.3, 1.1, -2.0);
    expectNear(
        all, Rotation::euler(0.3, 0, 0) * Rotation::euler(0, 1.1, 0) * Rotation::euler(-2.0, 0, 0));
}

TEST(Rotation, AxisAndAngleFollowRodrigues) {
    Random random(1);
    for (int i = 0; i < 100; ++i) {
        const Direction n = random.direction(), d = random.direction();
        const double angle = 3 * random.normal(), c = std::cos(angle), s = std::sin(angle);
        const Direction cross{n.y * d.z - n.z * d.y, n.z * d.x - n.x * d.z, n.x * d.y - n.y * d.x};
        const double along = dot(n, d) * (1 - c);
        expectNear(Rotation::aboutAxis({7 * n.x, 7 * n.y, 7 * n.z}, angle)(d),
                   {c * d.x + s * cross.x + along * n.x, c * d.y + s * cross.y + along * n.y,
                    c * d.z + s * cross.z + along * n.z});
    }
    expectNear(Rotation::aboutAxis({0, 0, 1}, 0.7), Rotation::euler(0.7, 0, 0));
    expectNear(Rotation::aboutAxis({0, 1e-300, 0}, 0.7), Rotation::euler(0, 0.7, 0));
    expectNear(Rotation::aboutAxis({0, 1e300, 0}, 0.7), Rotation::euler(0, 0.7, 0));
}

TEST(Rotation, QuaternionsMultiplyAsRotationsDo) {
    Random random(2);
    for (int i = 0; i < 100; ++i) {
        const double a[4] = {random.normal(), random.normal(), random.normal(), random.normal()};
        const double b[4] = {random.normal(), random.normal(), random.normal(), random.normal()};
        const Rotation product =
            Rotation::fromQuaternion(a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
                                     a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
                                     a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
                                     a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]);
        expectNear(product, Rotation::fromQuaternion(a[0], a[1], a[2], a[3]) *
                                Rotation::fromQuaternion(b[0], b[1], b[2], b[3]));
        expectNear(Rotation::fromQuaternion(a[0], a[1], a[2], a[3]),
                   Rotation::fromQuaternion(-2 * a[0], -2 * a[1], -2 * a[2], -2 * a[3]));
    }
}

TEST(Rotation, UpGoesToADirectionAlongTheShortestArc) {
    Random random(3);
    for (int i = 0; i < 100; ++i) {
        Direction up = random.direction();
        if (i % 4 == 1) up = {1e-9 * up.x, 1e-9 * up.y, i % 8 == 1 ? -1.0 : 1.0};
        if (i % 4 == 2) up = {1e-200 * up.x, 1e-200 * up.y, -1.0};
        const Rotation r = Rotation::zTo(up);
        expectNear(r({0, 0, 1}), up, i % 4 == 0 ? 4 * rounding : 1e-15);
        EXPECT_NEAR(angleOf(r), polarAngle(up), 1e-15);
        // The axis of the shortest arc is horizontal and perpendicular to both.
        const double across = std::hypot(up.x, up.y);
        if (across > 1e-100)
            expectNear(r({-up.y / across, up.x / across, 0}), {-up.y / across, up.x / across, 0});
    }
    expectNear(Rotation::zTo({0, 0, -3})({0, 0, 1}), {0, 0, -1});
}

TEST(Rotation, TurnsGiveTheRotationBack) {
    Random random(4);
    std::vector<Rotation> rotations = {
        Rotation(), Rotation::euler(0.4, pi, 0.2), Rotation::euler(2, 1e-9, -1.5),
        Rotation::euler(2, 1e-200, 1), Rotation::euler(1, pi - 1e-10, 2.5)};
    for (int i = 0; i < 100; ++i) rotations.push_back(random.rotation());
    for (const Rotation& r : rotations) {
        const Rotation::Turns t = r.turns();
        EXPECT_GE(t.sinBeta, 0);
        EXPECT_NEAR(1 - t.cosBeta, t.oneMinusCosBeta, rounding);
        expectNear(
            r, Rotation::euler(std::atan2(t.sinAlpha, t.cosAlpha), std::atan2(t.sinBeta, t.cosBeta),
                               std::atan2(t.sinGamma, t.cosGamma)));
    }
}

TEST(Rotation, InverseUndoesAndLongProductsStayOrthonormal) {
    Random random(5);
    Rotation product;
    for (int i = 0; i < 1000; ++i) product = random.rotation() * product;
    expectNear(product * product.inverse(), Rotation());
}

TEST(Rotation, RefusesWhatIsNoRotation) {
    const double nan = std::numeric_limits<double>::quiet_NaN(), inf = 1 / 0.0;
    EXPECT_THROW(Rotation::euler(nan, 0, 0), UsageError);
    EXPECT_THROW(Rotation::euler(0, inf, 0), UsageError);
    EXPECT_THROW(Rotation::aboutAxis({0, 0, 0}, 1), UsageError);
    EXPECT_THROW(Rotation::aboutAxis({0, 0, 1}, nan), UsageError);
    EXPECT_THROW(Rotation::aboutAxis({inf, 0, 1}, 1), UsageError);
    EXPECT_THROW(Rotation::fromQuaternion(0, 0, 0, 0), UsageError);
    EXPECT_THROW(Rotation::zTo({0, nan, 1}), UsageError);
    EXPECT_THROW(Rotation::fromMatrix({1, 0, 0, 0, 1, 0, 0, 0, -1}), UsageError);
    EXPECT_THROW(Rotation::fromMatrix({2, 0, 0, 0, 1, 0, 0, 0, 1}), UsageError);
    EXPECT_THROW(Rotation::fromMatrix({1, 0, 0, 0, 1, 0, 0, 0, nan}), UsageError);
    // Seven digits of a caller's matrix are made exact.
    const Rotation r = Rotation::fromMatrix({0.8, 0.6, 0, -0.6, 0.8, 1e-7, 0, 0, 1});
    expectNear(r * r.inverse(), Rotation());
    expectNear(Direction{1, 0, 0}, r(r.inverse()({1, 0, 0})));
}

}  // namespace
