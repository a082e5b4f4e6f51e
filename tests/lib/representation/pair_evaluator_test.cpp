// The fast path against the reference, for every linear form, basis and instruction set.

#include <hshfit/bases/catalog.h>
#include <hshfit/representation/basis_matrix.h>
#include <hshfit/representation/forms/pair_evaluators.h>
#include <hshfit/representation/forms/represented_brdf.h>
#include <hshfit/representation/halfway/halfway_terms.h>
#include <hshfit/representation/one_pair.h>

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <new>
#include <random>

namespace {

/// Calls of operator new in this program.
std::atomic<std::size_t> allocations = 0;

}  // namespace

// Inlined, malloc and free would look mismatched to the compiler.
[[gnu::noinline]] void* operator new(std::size_t size) {
    ++allocations;
    void* memory = std::malloc(size == 0 ? 1 : size);
    if (!memory) throw std::bad_alloc();
    return memory;
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
    std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}

namespace hshfit {
namespace {

std::unique_ptr<Brdf> openNothing(const std::string&) {
    return nullptr;
}

struct Pairs {
    std::vector<double> x[2], y[2], z[2];

    void add(int side, const Direction& d) {
        x[side].push_back(d.x);
        y[side].push_back(d.y);
        z[side].push_back(d.z);
    }
    DirectionBatch side(int s) const {
        return {x[s].data(), y[s].data(), z[s].data(), x[s].size()};
    }
    Direction at(int s, std::size_t k) const { return {x[s][k], y[s][k], z[s][k]}; }
};

/// Random pairs, the pole, the horizon from both sides and directions below it.
Pairs makePairs(std::size_t count) {
    Pairs pairs;
    std::mt19937 engine(5);
    std::uniform_real_distribution<double> unit(0, 1);
    const double special[] = {0, 1e-9, pi / 4, radians(89.99), pi / 2 - 1e-12, radians(95)};
    for (double a : special) {
        for (double b : special) {
            pairs.add(0, directionFromAngles(a, 0.7));
            pairs.add(1, directionFromAngles(b, -2.9));
        }
    }
    while (pairs.x[0].size() < count) {
        for (int s : {0, 1}) {
            pairs.add(s, directionFromAngles(std::acos(unit(engine)), 2 * pi * unit(engine)));
        }
    }
    return pairs;
}

void describe(CoefficientHead& head, const char* basis, int order, Quantity quantity) {
    head.basis = basis;
    head.order = order;
    head.quantity = quantity;
    head.channels = Channels::rgb();
    head.source = "test";
}

Representation randomRows(const char* basis, int order, const OutgoingSet& set, Quantity quantity) {
    Coefficients c;
    describe(c, basis, order, quantity);
    c.outgoing = set;
    c.isotropic = set.map == OutgoingSet::Map::elevations;
    std::mt19937 engine(1);
    std::normal_distribution<double> normal;
    for (std::size_t i = 0; i < set.size() * 3 * c.slots(); ++i) c.values.push_back(normal(engine));
    return fromCoefficients(c);
}

Representation randomMatrix(const char* name, int order, const ProductSymmetry& symmetry) {
    Representation r;
    describe(r.head, name, order, Quantity::brdf);
    r.head.isotropic = symmetry.isotropic;
    r.head.bilateral = symmetry.bilateral;
    r.head.reciprocal = symmetry.reciprocal;
    const auto terms = productTerms(*bases::make(name, order), symmetry);
    StoredArray matrix{.shape = {3, terms.size()}, .values = {}};
    std::mt19937 engine(2);
    std::normal_distribution<double> normal;
    for (std::size_t i = 0; i < 3 * terms.size(); ++i) matrix.values.push_back(normal(engine));
    r.content = MatrixArray{std::move(matrix)};
    return r;
}

std::vector<Representation> everyForm() {
    std::vector<Representation> forms;
    for (const char* basis : {"hsh", "sh", "zernike", "makhotkin", "esh", "h-basis"}) {
        const int order = std::min(7, bases::find(basis).maxOrder);
        for (Quantity quantity : {Quantity::brdf, Quantity::brdfCosine}) {
            forms.push_back(randomRows(basis, order, OutgoingSet::elevations(9), quantity));
            forms.push_back(randomRows(basis, order, OutgoingSet::parabolic(8, 6), quantity));
        }
        forms.push_back(randomRows(basis, order, OutgoingSet::direction(0.5, 1), Quantity::brdf));
        for (int bits = 0; bits < 8; ++bits) {
            const int low = std::min(order, 4);
            forms.push_back(randomMatrix(basis, low, {bits % 2 > 0, bits / 2 % 2 > 0, bits > 3}));
        }
    }
    forms.push_back(randomMatrix("hsh", 12, {true, true, true}));
    return forms;
}

/// Largest difference from the reference, relative to the largest value of each pair's cosine.
void expectSame(const Representation& form, const Pairs& pairs) {
    const auto fast = pairEvaluator(form, openNothing);
    const auto exact = reconstruct(form, openNothing);
    const std::size_t count = pairs.x[0].size();
    std::vector<float> values(3 * count, -1);
    fast->evaluate(pairs.side(0), pairs.side(1), values.data());
    // Cancellation in random sums: the size of what is added up is the yardstick.
    const double scale = 30.0 * form.head.order * form.head.order;
    for (std::size_t k = 0; k < count; ++k) {
        const Direction wi = pairs.at(0, k), wo = pairs.at(1, k);
        const std::vector<double> f = evaluate(*exact, wi, wo);
        const double cosine = form.head.quantity == Quantity::brdfCosine ? wi.z : 1;
        for (std::size_t c = 0; c < 3; ++c) {
            if (wi.z <= 0 || wo.z <= 0) {
                EXPECT_EQ(values[c * count + k], 0);
            } else {
                EXPECT_NEAR(values[c * count + k] * cosine, f[c] * cosine, 3e-6 * scale)
                    << kindName(form.kind()) << ' ' << form.head.basis << " pair " << k;
            }
        }
    }
}

TEST(PairEvaluator, AgreesWithTheReferenceOnEveryInstructionSet) {
    const Pairs pairs = makePairs(150);
    for (std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
        hwy::SetSupportedTargetsForTest(target);
        for (const Representation& form : everyForm()) expectSame(form, pairs);
    }
    hwy::SetSupportedTargetsForTest(0);
}

TEST(PairEvaluator, GivesAPairTheSameBitsInAnyBatch) {
    const Pairs pairs = makePairs(300);
    const std::size_t count = pairs.x[0].size();
    for (const Representation& form : everyForm()) {
        const auto fast = pairEvaluator(form, openNothing);
        std::vector<float> whole(3 * count);
        fast->evaluate(pairs.side(0), pairs.side(1), whole.data());
        for (std::size_t k : {std::size_t{0}, std::size_t{37}, count - 1}) {
            float one[3];
            evaluate(*fast, pairs.at(0, k), pairs.at(1, k), one);
            for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(one[c], whole[c * count + k]);
        }
    }
}

/// An isotropic halfway form of small random numbers.
Representation randomHalfway() {
    Representation r;
    r.halfway = {4, 3, 2};
    r.head.isotropic = r.head.bilateral = r.head.reciprocal = true;
    r.head.channels = Channels::rgb();
    r.head.source = "test";
    const HalfwayTerms terms(r.halfway, {true, true, true});
    StoredArray array{.shape = {3, terms.size()}, .values = {}};
    std::mt19937 engine(3);
    std::uniform_real_distribution<double> small(-0.05, 0.05);
    for (std::size_t i = 0; i < 3 * terms.size(); ++i) array.values.push_back(small(engine));
    r.content = HalfwayArray{array, {0.25, 0.25, 0}, std::vector<HalfwayCeiling>(3, {1, 1, 100})};
    return r;
}

/// The second pair of a form may lie anywhere: memory depends on the form alone.
TEST(PairEvaluator, AllocatesNothingForOnePairAfterTheFirst) {
    const Pairs pairs = makePairs(60);
    std::vector<Representation> forms = everyForm();
    forms.push_back(randomRows("hsh", 24, OutgoingSet::elevations(9), Quantity::brdf));
    forms.push_back(randomRows("lsosh", 5, OutgoingSet::elevations(9), Quantity::brdf));
    forms.push_back(randomMatrix("lsosh", 4, {true, true, true}));
    forms.push_back(randomHalfway());
    for (const Representation& form : forms) {
        const auto fast = pairEvaluator(form, openNothing);
        float one[3];
        evaluate(*fast, {0, 0, 1}, {0, 0, 1}, one);
        const std::size_t before = allocations;
        for (std::size_t k = 0; k < pairs.x[0].size(); ++k)
            evaluate(*fast, pairs.at(0, k), pairs.at(1, k), one);
        EXPECT_EQ(allocations - before, 0U)
            << kindName(form.kind()) << ' ' << form.head.basis << ' ' << form.head.order;
    }
    // The counter sees what a reconstruction in double precision allocates.
    const auto exact = reconstruct(forms.front(), openNothing);
    std::vector<double> f(3);
    const std::size_t before = allocations;
    const Direction up{0, 0, 1};
    exact->eval(up, {&up.x, &up.y, &up.z, 1}, f.data());
    EXPECT_GT(allocations - before, 0U);
}

TEST(PairEvaluator, TakesAnEmptyBatch) {
    for (const Representation& form : everyForm()) {
        pairEvaluator(form, openNothing)->evaluate({}, {}, nullptr);
    }
}

}  // namespace
}  // namespace hshfit
