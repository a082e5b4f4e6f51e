// Projections that are kept from run to run in a folder.

#include "lib/formula_brdf.h"
#include "temporary_folder.h"

#include <hshfit/error.h>
#include <hshfit/representation/named_arrays.h>
#include <hshfit/tradeoff/kept_projections.h>

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

namespace hshfit::tradeoff {
namespace {

namespace fs = std::filesystem;
using test::FormulaBrdf;

class KeptProjectionsTest : public testing::Test {
protected:
    void SetUp() override {
        folder_.path = temporary_.path();
        folder_.contentOf = [this](const Brdf&, const std::string& specification) {
            return content_ + specification;
        };
        folder_.tell = [this](const std::string& remark) { remarks_.push_back(remark); };
    }

    KeptProjections keeping(std::vector<std::string> bases = {}, double tolerance = 1e-4) const {
        return {f_,
                {.projection = {.tolerance = tolerance},
                 .bases = std::move(bases),
                 .maxOrder = 4,
                 .folder = &folder_}};
    }
    /// Whether f was evaluated since the last call.
    bool hasEvaluated() { return evaluations_.exchange(0) > 0; }

    std::atomic<std::size_t> evaluations_ = 0;
    FormulaBrdf f_{
        [this](const Direction& wi, const Direction& wo) {
            ++evaluations_;
            if (!(wi.z > 0) || !(wo.z > 0)) return 0.0;
            const double cosine = wi.z * wo.z - wi.x * wo.x - wi.y * wo.y;
            return 0.05 + 0.4 * std::pow((1 + cosine) / 2, 6);
        },
        {},
        {.nonNegative = true, .reciprocal = true, .isotropic = true, .mirrorSymmetric = true}};
    test::TemporaryFolder temporary_;
    ProjectionFolder folder_;
    std::string content_ = "one";
    std::vector<std::string> remarks_;
};

std::vector<Form> eachKind() {
    Form outgoing, both, halfway;
    outgoing.outgoing = "4";
    outgoing.order = both.order = 4;
    both.kind = Representation::Kind::basis;
    both.reciprocal = halfway.reciprocal = true;
    halfway.kind = Representation::Kind::halfway;
    halfway.halfway = {3, 2, 1};
    return {outgoing, both, halfway};
}

std::vector<std::vector<double>> numbersOf(ProjectionSource& source) {
    std::vector<std::vector<double>> numbers;
    for (Form form : eachKind()) {
        form.precision = Precision::float64;
        const Representation made = represent(source, form);
        for (const auto& [name, array] : namedArrays(made)) numbers.push_back(array->values);
        numbers.push_back({made.head.error, made.head.tolerance});
    }
    return numbers;
}

TEST_F(KeptProjectionsTest, AreTakenWithTheSameBits) {
    const auto direct = projecting(f_, {.tolerance = 1e-4});
    const auto expected = numbersOf(*direct);
    KeptProjections first = keeping();
    EXPECT_EQ(numbersOf(first), expected);
    EXPECT_TRUE(hasEvaluated());
    KeptProjections second = keeping();
    EXPECT_EQ(numbersOf(second), expected);
    EXPECT_FALSE(hasEvaluated());
    EXPECT_TRUE(remarks_.empty());
}

TEST_F(KeptProjectionsTest, OfASearchShareTheHalfwayFormAlone) {
    KeptProjections whole = keeping();
    numbersOf(whole);
    const auto files = [&] {
        return std::distance(fs::directory_iterator(folder_.path), fs::directory_iterator());
    };
    const auto before = files();
    KeptProjections search = keeping({"hsh", "zernike"});
    const auto numbers = numbersOf(search);
    // Coefficients and matrices in both bases.
    EXPECT_EQ(files(), before + 4);
    hasEvaluated();
    KeptProjections again = keeping({"hsh", "zernike"});
    EXPECT_EQ(numbersOf(again), numbers);
    EXPECT_FALSE(hasEvaluated());
    KeptProjections other = keeping({"hsh"});
    numbersOf(other);
    EXPECT_TRUE(hasEvaluated());
}

TEST_F(KeptProjectionsTest, DependOnContentAndTolerance) {
    KeptProjections first = keeping();
    numbersOf(first);
    hasEvaluated();
    KeptProjections finer = keeping({}, 1e-5);
    numbersOf(finer);
    EXPECT_TRUE(hasEvaluated());
    content_ = "other";
    KeptProjections changed = keeping();
    numbersOf(changed);
    EXPECT_TRUE(hasEvaluated());
}

TEST_F(KeptProjectionsTest, KeepTheReasonOfAFailure) {
    const Form form = eachKind()[1];
    const auto reasonOf = [&](KeptProjections source) {
        try {
            source.both(form);
        } catch (const NumericError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    const auto few = [&] {
        return KeptProjections(
            f_, {.projection = {.tolerance = 1e-12, .maxEvaluations = 64}, .folder = &folder_});
    };
    const std::string reason = reasonOf(few());
    EXPECT_NE(reason, "");
    hasEvaluated();
    EXPECT_EQ(reasonOf(few()), reason);
    EXPECT_FALSE(hasEvaluated());
}

}  // namespace
}  // namespace hshfit::tradeoff
