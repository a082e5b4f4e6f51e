// Rounding to whole numbers, against all of them and against rounding one by one.

#include <hshfit/linear_algebra/decompositions.h>
#include <hshfit/material_library/internal/least_in_steps.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace hshfit::material_library {
namespace {

struct System {
    Eigen::MatrixXd gram;
    Eigen::VectorXd best;

    double cost(const Eigen::VectorXd& q) const { return (q - best).dot(gram * (q - best)); }
    Eigen::VectorXd solved(const Eigen::VectorXd& most) const {
        return leastInSteps(gram, gram * best, most);
    }
};

/// Numbers that depend on each other, the best ones of a spread.
System madeOf(Eigen::Index size, double spread, std::mt19937& random) {
    std::normal_distribution<double> number;
    Eigen::MatrixXd rows(size + 2, size);
    for (double& value : rows.reshaped()) value = number(random);
    System made{rows.transpose() * rows, Eigen::VectorXd(size)};
    for (double& value : made.best) value = spread * number(random);
    return made;
}

double leastOfAll(const System& system, const Eigen::VectorXd& most, Eigen::VectorXd& q,
                  Eigen::Index k = 0) {
    if (k == q.size()) return system.cost(q);
    double least = 1e300;
    for (q[k] = -most[k]; q[k] <= most[k]; ++q[k])
        least = std::min(least, leastOfAll(system, most, q, k + 1));
    return least;
}

class RoundedTogether : public testing::TestWithParam<double> {};

TEST_P(RoundedTogether, IsNearlyTheLeastOfAllWithinBounds) {
    std::mt19937 random(4);
    const Eigen::VectorXd most = Eigen::Vector4d(3, 2, 2, 1);
    double ours = 0, least = 0;
    for (int trial = 0; trial < 200; ++trial) {
        const System system = madeOf(4, GetParam(), random);
        const Eigen::VectorXd found = system.solved(most);
        for (Eigen::Index k = 0; k < 4; ++k) {
            EXPECT_LE(std::abs(found[k]), most[k]);
            EXPECT_EQ(found[k], std::round(found[k]));
        }
        Eigen::VectorXd q(4);
        ours += system.cost(found);
        least += leastOfAll(system, most, q);
    }
    EXPECT_LE(ours, 1.05 * least);
}

// Best numbers within the bounds, at them, and far beyond.
INSTANTIATE_TEST_SUITE_P(Spreads, RoundedTogether, testing::Values(0.5, 2.0, 8.0));

TEST(LeastInSteps, LosesLessThanRoundingEachNumberToTheBestThatIsLeft) {
    std::mt19937 random(6);
    const Eigen::VectorXd most = Eigen::VectorXd::Constant(40, 1000);
    double ours = 0, onePath = 0;
    for (int trial = 0; trial < 20; ++trial) {
        const System system = madeOf(40, 20, random);
        const Eigen::MatrixXd upper = Eigen::LLT<Eigen::MatrixXd>(system.gram).matrixU();
        Eigen::VectorXd off = Eigen::VectorXd::Zero(40);
        for (Eigen::Index k = 39; k >= 0; --k)
            off[k] =
                system.best[k] - std::round(system.best[k] + upper.row(k).dot(off) / upper(k, k));
        onePath += system.cost(system.best - off);
        ours += system.cost(system.solved(most));
    }
    EXPECT_LT(ours, 0.8 * onePath);
}

TEST(LeastInSteps, OfWholeNumbersIsThese) {
    std::mt19937 random(7);
    System system = madeOf(60, 30, random);
    system.best = system.best.array().round();
    EXPECT_EQ(system.solved(Eigen::VectorXd::Constant(60, 1000)), system.best);
    // Those beyond the bounds are at them.
    system.gram = Eigen::MatrixXd::Identity(60, 60);
    EXPECT_EQ(system.solved(Eigen::VectorXd::Constant(60, 9)),
              system.best.cwiseMin(9.0).cwiseMax(-9.0));
}

TEST(LeastInSteps, OfNoNumbersIsEmpty) {
    EXPECT_EQ(leastInSteps(Eigen::MatrixXd(0, 0), Eigen::VectorXd(0), Eigen::VectorXd(0)).size(),
              0);
}

}  // namespace
}  // namespace hshfit::material_library
