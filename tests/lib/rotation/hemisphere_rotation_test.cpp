// Rotation on the hemisphere: every way of it for every basis against brute-force quadrature, and
// the errors of the published ways.

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/quadrature/quadrature.h>
#include <hshfit/rotation/basis_change.h>
#include <hshfit/rotation/hemisphere_rotation.h>
#include <hshfit/rotation/internal/lune.h>
#include <hshfit/rotation/sh_rotation.h>

#include <lib/rotation/random.h>

#include <gtest/gtest.h>

#include <map>

namespace {

using namespace hshfit;
using hshfit::test::distance;
using hshfit::test::normOf;
using hshfit::test::Random;

std::vector<const bases::Entry*> rows() {
    std::vector<const bases::Entry*> result;
    for (const bases::Entry& entry : bases::catalog()) result.push_back(&entry);
    return result;
}
std::vector<const bases::Entry*> orthonormal() {
    std::vector<const bases::Entry*> result = rows();
    std::erase_if(result, [](const bases::Entry* entry) { return !entry->orthonormal; });
    return result;
}
std::string nameOf(const testing::TestParamInfo<const bases::Entry*>& info) {
    std::string name(info.param->name);
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}

/// Relative Frobenius distance.
double apart(const std::vector<double>& a, const std::vector<double>& b) {
    return distance(a, b) / normOf(b);
}

/// Eq. 14 by brute force: y-polar coordinates, tanh-sinh in both, no use of symmetry.
std::vector<double> bruteForce(const Basis& basis, double beta) {
    struct Node {
        double low, high, weight;  // distances from the ends of [0, 1]
    };
    std::vector<Node> nodes;
    const double h = 1.0 / 32;
    for (int k = -static_cast<int>(3.2 / h); k <= static_cast<int>(3.2 / h); ++k) {
        const double u = pi * std::sinh(k * h), share = 1 / (1 + std::exp(-u));
        const double rest = 1 / (1 + std::exp(u));
        nodes.push_back({share, rest, h * pi * std::cosh(k * h) * share * rest});
    }
    const auto slots = static_cast<std::size_t>(basis.slots());
    std::vector<double> result(slots * slots, 0.0), to(slots), from(slots);
    const double length = pi - beta;
    for (const Node& t : nodes)
        for (const Node& a : nodes) {
            const double sine = std::sin(pi * std::min(t.low, t.high));
            const double y = t.low < 0.5 ? std::cos(pi * t.low) : -std::cos(pi * t.high);
            const double after = length * a.high, before = length * a.low;
            basis.evaluate(Direction{sine * std::cos(after), y, sine * std::sin(after)}, to.data());
            basis.evaluate(Direction{-sine * std::cos(before), y, sine * std::sin(before)},
                           from.data());
            double weight = t.weight * pi * a.weight * length * sine;
            if (basis.inner() == Basis::Inner::projectedSolidAngle)
                weight *= sine * std::sin(after);
            for (std::size_t i = 0; i < slots; ++i)
                for (std::size_t j = 0; j < slots; ++j)
                    result[i * slots + j] += weight * to[i] * from[j];
        }
    return result;
}

class RotationOnTheHemisphere : public testing::TestWithParam<const bases::Entry*> {};

/// Bases whose matrix is the integral itself; the others solve a Gram system.
class RotationInAnOrthonormalBasis : public RotationOnTheHemisphere {};

TEST_P(RotationInAnOrthonormalBasis, MatchesBruteForceQuadrature) {
    const auto basis = GetParam()->make(std::min(4, GetParam()->maxOrder), {});
    const HemisphereRotation rotate(*basis);
    for (const double beta : {0.01, 0.6, 2.5}) {
        const std::vector<double> found = rotate.matrix(Rotation::euler(0, beta, 0));
        const std::vector<double> expected = bruteForce(*basis, beta);
        double worst = 0;
        for (std::size_t i = 0; i < found.size(); ++i)
            worst = std::max(worst, std::abs(found[i] - expected[i]));
        EXPECT_LT(worst, 1e-12) << beta;
    }
}

TEST_P(RotationOnTheHemisphere, MoreNodesChangeNothing) {
    const int order = std::min(12, GetParam()->maxOrder);
    const auto basis = GetParam()->make(order, {});
    Random random(2);
    const std::vector<double> c = random.vector(static_cast<std::size_t>(basis->slots()));
    const linear_algebra::RowMajor column =
        Eigen::Map<const Eigen::VectorXd>(c.data(), basis->slots());
    for (const double beta : {1e-9, 1e-5, 1e-3, 0.1, 1.0, pi / 2, 3.0, pi - 1e-4}) {
        const LuneIntegrals once = luneIntegrals(*basis, beta, column);
        const LuneIntegrals twice = luneIntegrals(*basis, beta, column, LuneFunctions::basis, 1.7);
        EXPECT_LT((once.moments - twice.moments).norm(), 1e-12 * normOf(c)) << beta;
        EXPECT_NEAR(once.energy[0], twice.energy[0], 1e-12 * normOf(c) * normOf(c)) << beta;
        EXPECT_NEAR(once.stayed[0], twice.stayed[0], 1e-12 * normOf(c) * normOf(c)) << beta;
    }
}

/// Narrow lunes, along which functions of high degree turn many times, as the square root of the
/// height above the horizon.
TEST(LuneOfHsh, MoreNodesChangeNothingAtHighOrder) {
    const auto basis = bases::make("hsh", 100);
    Random random(3);
    const std::vector<double> c = random.vector(static_cast<std::size_t>(basis->slots()));
    const linear_algebra::RowMajor column =
        Eigen::Map<const Eigen::VectorXd>(c.data(), basis->slots());
    for (const double beta : {2.88, 3.1, 3.14}) {
        const LuneIntegrals once = luneIntegrals(*basis, beta, column);
        const LuneIntegrals more = luneIntegrals(*basis, beta, column, LuneFunctions::basis, 1.5);
        EXPECT_LT((once.moments - more.moments).norm(), 1e-13 * normOf(c)) << beta;
    }
}

TEST_P(RotationOnTheHemisphere, TurnsAboutZMoveTheFunction) {
    const auto basis =
        GetParam()->make(std::min(8, GetParam()->maxOrder), {.condonShortley = true});
    const HemisphereRotation rotate(*basis);
    Random random(4);
    std::vector<double> c = random.vector(static_cast<std::size_t>(basis->slots()));
    for (int l = 0; l < basis->order(); ++l)
        for (int m = -l; m <= l; ++m)
            if (!basis->has(l, m)) c[static_cast<std::size_t>(slotOf(l, m))] = 0;
    const Rotation r = Rotation::euler(0.7, 0, 0.4);
    const HemisphereRotated turned = rotate.rotate(r, c);
    std::vector<double> at(c.size()), before(c.size());
    for (int k = 0; k < 10; ++k) {
        Direction d = random.direction();
        d.z = std::abs(d.z);
        basis->evaluate(d, at.data());
        basis->evaluate(r.inverse()(d), before.data());
        double f = 0, g = 0;
        for (std::size_t i = 0; i < c.size(); ++i) {
            f += c[i] * before[i];
            g += turned.values[i] * at[i];
        }
        EXPECT_NEAR(f, g, 1e-12 * normOf(c));
    }
    EXPECT_LT(turned.lostEnergy, 1e-11);
    EXPECT_LT(turned.error, 1e-5);
}

TEST_P(RotationOnTheHemisphere, LossAndErrorAreThoseOfTheFunction) {
    // By counting over a fine grid of directions.
    const auto basis = GetParam()->make(std::min(5, GetParam()->maxOrder), {});
    const bool projected = basis->inner() == Basis::Inner::projectedSolidAngle;
    Random random(5);
    std::vector<double> c = random.vector(static_cast<std::size_t>(basis->slots()));
    const Rotation r = Rotation::euler(0.3, 0.8, -1);
    const HemisphereRotated found = HemisphereRotation(*basis).rotate(r, c);
    double energy = 0, stayed = 0, distance = 0;
    std::vector<double> at(c.size()), before(c.size());
    constexpr int rings = 300, azimuths = 600;
    for (int i = 0; i < rings; ++i)
        for (int j = 0; j < azimuths; ++j) {
            const double z = (i + 0.5) / rings, s = std::sqrt(1 - z * z);
            const double phi = 2 * pi * (j + 0.5) / azimuths;
            const Direction d{s * std::cos(phi), s * std::sin(phi), z};
            const Direction source = r.inverse()(d);
            basis->evaluate(d, at.data());
            basis->evaluate(source, before.data());
            double here = 0, rotated = 0, result = 0;
            for (std::size_t k = 0; k < c.size(); ++k) {
                here += c[k] * at[k];
                rotated += source.z > 0 ? c[k] * before[k] : 0;
                result += found.values[k] * at[k];
            }
            energy += here * here * (projected ? z : 1);
            if (r(d).z > 0) stayed += here * here * (projected ? z : 1);
            distance += (rotated - result) * (rotated - result) * (projected ? z : 1);
        }
    EXPECT_NEAR(found.lostEnergy, 1 - stayed / energy, 3e-3);
    EXPECT_NEAR(found.error, std::sqrt(distance / energy), 3e-3);
}

INSTANTIATE_TEST_SUITE_P(Catalog, RotationOnTheHemisphere, testing::ValuesIn(rows()), nameOf);
INSTANTIATE_TEST_SUITE_P(Catalog, RotationInAnOrthonormalBasis, testing::ValuesIn(orthonormal()),
                         nameOf);

/// The table of the published ways: relative Frobenius errors against Eq. 14.
TEST(RotationOfHsh, ErrorsOfThePaperShift) {
    const std::map<int, std::vector<double>> shift = {{4, {0.25, 0.45, 0.68}},
                                                      {8, {0.55, 0.85, 1.03}}};
    for (const auto& [order, expected] : shift) {
        const auto basis = bases::make("hsh", order);
        const HemisphereRotation exact(*basis),
            paper(*basis, {.method = HemisphereMethod::paperShift});
        for (std::size_t k = 0; k < 3; ++k) {
            const Rotation r = Rotation::euler(0, radians(std::array{15, 30, 60}[k]), 0);
            EXPECT_NEAR(apart(paper.matrix(r), exact.matrix(r)), expected[k], 0.01)
                << order << " " << k;
        }
    }
}

TEST(RotationOfHsh, ErrorsOfTheWayThroughShByItsBands) {
    const std::map<std::pair<int, int>, double> published = {
        {{4, 8}, 0.038}, {{4, 16}, 0.004}, {{4, 32}, 0.0004}, {{8, 16}, 0.030}, {{8, 32}, 0.002}};
    const Rotation r = Rotation::euler(0, radians(30), 0);
    for (const auto& [orders, expected] : published) {
        const auto [order, bands] = orders;
        const auto hsh = bases::make("hsh", order), sh = bases::make("sh", bands);
        const BasisChange to(*hsh, *sh), back(*sh, *hsh);
        const auto slots = static_cast<std::size_t>(order) * order;
        std::vector<double> identity(slots * slots, 0.0), columns(slots * slots);
        for (std::size_t i = 0; i < slots; ++i) identity[i * slots + i] = 1;
        std::vector<double> middle(slots * static_cast<std::size_t>(bands) * bands);
        to.apply(slots, identity.data(), middle.data());
        back.apply(slots, ShRotation(bands).rotate(r, middle).data(), columns.data());
        std::vector<double> matrix(columns.size());
        for (std::size_t i = 0; i < slots; ++i)
            for (std::size_t j = 0; j < slots; ++j) matrix[i * slots + j] = columns[j * slots + i];
        EXPECT_NEAR(apart(matrix, HemisphereRotation(*hsh).matrix(r)), expected, 0.15 * expected)
            << order << " " << bands;
    }
}

TEST(RotationOfHsh, PaperShiftMovesThePole) {
    // The one property that it has: a narrow lobe at the pole goes to beta.
    const auto basis = bases::make("hsh", 30);
    std::vector<double> c(900, 0.0), at(900);
    for (int l = 0; l < 30; ++l)
        c[static_cast<std::size_t>(slotOf(l, 0))] =
            std::sqrt(2 * l + 1.0) * std::exp(-0.02 * l * l);
    const HemisphereRotation paper(*basis, {.method = HemisphereMethod::paperShift});
    const std::vector<double> moved = paper.values(Rotation::euler(0, radians(40), 0), c);
    double best = -1, angle = 0;
    for (int k = 0; k < 90; ++k) {
        basis->evaluate(directionFromAngles(radians(k), 0), at.data());
        double value = 0;
        for (std::size_t i = 0; i < 900; ++i) value += moved[i] * at[i];
        if (value > best) best = value, angle = k;
    }
    EXPECT_NEAR(angle, 40, 1);
    EXPECT_THROW(paper.values(Rotation::euler(0, 2, 0), c), UsageError);
}

TEST(RotationOfHsh, WayThroughShConvergesToTheExactOne) {
    const auto basis = bases::make("hsh", 4);
    const Rotation r = Rotation::euler(0.2, radians(30), 1);
    const std::vector<double> exact = HemisphereRotation(*basis).matrix(r);
    double last = 1;
    for (const double tolerance : {1e-2, 1e-3, 1e-5}) {
        const HemisphereRotation rotate(
            *basis, {.method = HemisphereMethod::throughSh, .tolerance = tolerance});
        const double error = apart(rotate.matrix(r), exact);
        EXPECT_LT(error, tolerance);
        EXPECT_LT(error, last);
        last = error;
    }
}

TEST(RotationOfHsh, TablesConvergeWithTheSquareOfTheStep) {
    const auto basis = bases::make("hsh", 4);
    std::vector<double> errors;
    for (const int tables : {19, 37, 73, 145}) {
        const HemisphereRotation rotate(*basis,
                                        {.method = HemisphereMethod::table, .tables = tables});
        EXPECT_EQ(rotate.tableBytes(), static_cast<std::size_t>(tables) * (100 + 36) * 8);
        double worst = 0;
        for (int k = 0; k < 40; ++k) {
            const Rotation turned = Rotation::euler(0, radians(20 + k * 1.37), 0);
            worst = std::max(
                worst, apart(rotate.matrix(turned), HemisphereRotation(*basis).matrix(turned)));
        }
        errors.push_back(worst);
    }
    for (std::size_t k = 1; k < errors.size(); ++k) EXPECT_LT(errors[k], errors[k - 1] / 3);
}

TEST(RotationOfHsh, RefusesOtherBasesAnglesAndOrders) {
    const auto zernike = bases::make("zernike", 4), lsosh = bases::make("lsosh", 4);
    using Options = HemisphereRotationOptions;
    EXPECT_THROW(HemisphereRotation(*zernike, Options{.method = HemisphereMethod::paperShift}),
                 UsageError);
    EXPECT_THROW(HemisphereRotation(*lsosh, Options{.method = HemisphereMethod::throughSh}),
                 UsageError);
    EXPECT_THROW(HemisphereRotation(*bases::make("hsh", 151)), UsageError);
    EXPECT_THROW(
        HemisphereRotation(*zernike, Options{.method = HemisphereMethod::table, .tables = 1}),
        UsageError);
    EXPECT_THROW(HemisphereRotation(*bases::make("hsh", 33)).matrix(Rotation()), UsageError);
    EXPECT_THROW(hemisphereMethod("shift"), UsageError);
    // Nothing is left of a function that is turned over.
    const HemisphereRotated gone = HemisphereRotation(*zernike).rotate(
        Rotation::euler(0, pi, 0), std::vector<double>(16, 1.0));
    EXPECT_EQ(normOf(gone.values), 0);
    EXPECT_EQ(gone.lostEnergy, 1);
    EXPECT_EQ(HemisphereRotation(*zernike).rotate(Rotation(), std::vector<double>(16)).error, 0);
}

}  // namespace
