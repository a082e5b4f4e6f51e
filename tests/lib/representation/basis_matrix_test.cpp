#include <hshfit/representation/basis_matrix.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/quadrature/quadrature.h>

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace hshfit {
namespace {

const ProductSymmetry symmetries[] = {
    {false, false, false}, {false, false, true}, {false, true, false}, {false, true, true},
    {true, false, false},  {true, false, true},  {true, true, false},  {true, true, true}};

const StoredArray& matrixOf(const Representation& r) {
    return std::get<MatrixArray>(r.content).matrix;
}

TEST(ProductTerms, NumberAsThePublishedZernikeForm) {
    // Isotropic, bilateral and reciprocal (Koenderink & van Doorn 1998).
    const std::size_t counts[] = {1, 2, 5, 8, 14, 20, 30, 40, 55, 70, 91, 112, 140};
    for (int n = 0; n <= 12; ++n) {
        const auto basis = bases::make("zernike", n + 1);
        EXPECT_EQ(productTerms(*basis, {true, true, true}).size(), counts[n]) << n;
        // Reciprocal alone: M (M + 1) / 2 of M = (n + 1)(n + 2) / 2 functions.
        const std::size_t m = static_cast<std::size_t>((n + 1) * (n + 2) / 2);
        EXPECT_EQ(productTerms(*basis, {false, false, true}).size(), m * (m + 1) / 2) << n;
    }
}

TEST(ProductTerms, AreCountedWithoutListing) {
    for (const auto& entry : bases::catalog()) {
        const auto basis = bases::make(entry.name, std::min(6, entry.maxOrder));
        for (const ProductSymmetry& symmetry : symmetries) {
            EXPECT_EQ(productTermCount(*basis, symmetry), productTerms(*basis, symmetry).size())
                << entry.name;
        }
    }
}

TEST(ProductTerms, OfALowerOrderAreAPrefix) {
    for (const auto& entry : bases::catalog()) {
        if (!entry.nested || entry.maxOrder < 5) continue;
        const auto large = bases::make(entry.name, 5), small = bases::make(entry.name, 3);
        for (const ProductSymmetry& symmetry : symmetries) {
            const auto all = productTerms(*large, symmetry), some = productTerms(*small, symmetry);
            ASSERT_LE(some.size(), all.size());
            EXPECT_TRUE(std::equal(some.begin(), some.end(), all.begin())) << entry.name;
        }
    }
}

/// Nodes and weights over the hemisphere that integrate products of four functions of low order.
struct Nodes {
    std::vector<Direction> directions;
    std::vector<double> weights;

    explicit Nodes(const Basis& basis) {
        const GaussRule& rule = gaussLegendre(40);
        constexpr int azimuths = 16;
        for (std::size_t r = 0; r < rule.nodes.size(); ++r) {
            const double u = (1 + rule.nodes[r]) / 2, mu = u * u;
            double weight = rule.weights[r] * u * 2 * pi / azimuths;
            if (basis.inner() == Basis::Inner::projectedSolidAngle) weight *= mu;
            for (int j = 0; j < azimuths; ++j) {
                directions.push_back(
                    directionFromAngles(std::acos(mu), (j + 0.3) * 2 * pi / azimuths));
                weights.push_back(weight);
            }
        }
    }
};

/// Gram matrix of all terms over both hemispheres. As the integral over wi and wo of products of
/// sums of products, it follows from the basis values at the nodes.
std::vector<double> gram(const Basis& basis, const ProductSymmetry& symmetry) {
    const auto terms = productTerms(basis, symmetry);
    const Nodes nodes(basis);
    std::vector<std::vector<double>> values;
    for (const Direction& d : nodes.directions) {
        values.emplace_back(basis.slots());
        basis.evaluate(d, values.back().data());
    }
    std::vector<double> sums(terms.size() * terms.size(), 0.0), at(terms.size());
    for (std::size_t a = 0; a < values.size(); ++a) {
        for (std::size_t b = 0; b < values.size(); ++b) {
            evaluateProducts(terms, symmetry, values[a].data(), values[b].data(), at.data());
            const double weight = nodes.weights[a] * nodes.weights[b];
            for (std::size_t s = 0; s < terms.size(); ++s) {
                for (std::size_t t = s; t < terms.size(); ++t) {
                    sums[s * terms.size() + t] += weight * at[s] * at[t];
                }
            }
        }
    }
    return sums;
}

TEST(ProductTerms, AreOrthonormalOverBothHemispheres) {
    for (const auto& entry : bases::catalog()) {
        // SH and LSOSH are not orthonormal over the hemisphere.
        if (!entry.orthonormal || entry.maxOrder < 2 || entry.name == "sh") continue;
        const auto basis = bases::make(entry.name, 2);
        for (const ProductSymmetry& symmetry : symmetries) {
            const std::vector<double> sums = gram(*basis, symmetry);
            const auto n = static_cast<std::size_t>(std::lround(std::sqrt(sums.size())));
            for (std::size_t s = 0; s < n; ++s) {
                for (std::size_t t = s; t < n; ++t) {
                    EXPECT_NEAR(sums[s * n + t], s == t ? 1 : 0, 1e-7)
                        << entry.name << ' ' << s << ' ' << t;
                }
            }
        }
    }
}

TEST(ProductTerms, ContractToTheSameSum) {
    std::mt19937 engine(3);
    std::normal_distribution<double> normal;
    for (const char* name : {"hsh", "zernike", "makhotkin", "esh"}) {
        const auto basis = bases::make(name, 4);
        for (const ProductSymmetry& symmetry : symmetries) {
            const auto terms = productTerms(*basis, symmetry);
            std::vector<double> values(terms.size()), products(terms.size());
            for (double& value : values) value = normal(engine);
            const Direction wi = directionFromAngles(0.9, 2.1), wo = directionFromAngles(0.4, -1.3);
            std::vector<double> atWi(basis->slots()), atWo(basis->slots());
            std::vector<double> c(basis->slots(), 0.0);
            basis->evaluate(wi, atWi.data());
            basis->evaluate(wo, atWo.data());
            evaluateProducts(terms, symmetry, atWi.data(), atWo.data(), products.data());
            contractWithOutgoing(terms, symmetry, values.data(), atWo.data(), c.data());
            double direct = 0, contracted = 0;
            for (std::size_t t = 0; t < terms.size(); ++t) direct += values[t] * products[t];
            for (int i = 0; i < basis->slots(); ++i) contracted += c[i] * atWi[i];
            EXPECT_NEAR(contracted, direct, 1e-12 * std::sqrt(terms.size())) << name;
        }
    }
}

/// A sum of product functions, as a BRDF with the laws that its terms give it.
class InSpan final : public Brdf {
public:
    InSpan(const Basis& basis, const ProductSymmetry& symmetry, unsigned seed)
        : basis_(basis), symmetry_(symmetry), terms_(productTerms(basis, symmetry)) {
        std::mt19937 engine(seed);
        std::normal_distribution<double> normal;
        for (std::size_t t = 0; t < terms_.size(); ++t) values_.push_back(normal(engine));
        laws_.isotropic = symmetry.isotropic;
        laws_.mirrorSymmetric = symmetry.bilateral;
        laws_.reciprocal = symmetry.reciprocal;
    }
    std::string name() const override { return "in-span"; }
    const Channels& channels() const override { return channels_; }
    const Laws& laws() const override { return laws_; }
    void eval(const Direction& wo, DirectionBatch wi, double* out) const override {
        std::vector<double> atWi(basis_.slots()), atWo(basis_.slots()), products(terms_.size());
        basis_.evaluate(wo, atWo.data());
        for (std::size_t k = 0; k < wi.count; ++k) {
            basis_.evaluate(Direction{wi.x[k], wi.y[k], wi.z[k]}, atWi.data());
            evaluateProducts(terms_, symmetry_, atWi.data(), atWo.data(), products.data());
            out[k] = 0;
            for (std::size_t t = 0; t < terms_.size(); ++t) out[k] += values_[t] * products[t];
        }
    }
    const std::vector<double>& values() const { return values_; }

private:
    const Basis& basis_;
    ProductSymmetry symmetry_;
    std::vector<ProductTerm> terms_;
    std::vector<double> values_;
    Channels channels_;
    Laws laws_;
};

TEST(ProjectBoth, ReturnsTheCoefficientsOfFunctionsInItsSpan) {
    for (const char* name : {"hsh", "zernike", "makhotkin", "makhotkin-flux", "esh", "h-basis"}) {
        const auto basis = bases::make(name, 3);
        for (const ProductSymmetry& symmetry : symmetries) {
            const InSpan brdf(*basis, symmetry, 7);
            const Representation r = projectBoth(brdf, *basis, symmetry.reciprocal);
            const std::vector<double>& found = matrixOf(r).values;
            ASSERT_EQ(found.size(), brdf.values().size());
            for (std::size_t t = 0; t < found.size(); ++t) {
                EXPECT_NEAR(found[t], brdf.values()[t], 2e-4) << name << " term " << t;
            }
        }
    }
}

TEST(ProjectBoth, ReciprocalIsTheSymmetricPart) {
    const auto basis = bases::make("hsh", 3);
    const ProductSymmetry all{true, true, false}, half{true, true, true};
    const InSpan brdf(*basis, all, 9);  // not reciprocal
    const Representation r = projectBoth(brdf, *basis, true);
    const auto terms = productTerms(*basis, half);
    std::vector<double> at(terms.size()), atWi(basis->slots()), atWo(basis->slots());
    for (const auto& [a, b] : {std::pair(0.3, 1.2), std::pair(0.9, 0.2)}) {
        const Direction wi = directionFromAngles(a, 0.5), wo = directionFromAngles(b, -1);
        basis->evaluate(wi, atWi.data());
        basis->evaluate(wo, atWo.data());
        evaluateProducts(terms, half, atWi.data(), atWo.data(), at.data());
        double sum = 0;
        for (std::size_t t = 0; t < at.size(); ++t) sum += at[t] * matrixOf(r).values[t];
        EXPECT_NEAR(sum, (evaluate(brdf, wi, wo)[0] + evaluate(brdf, wo, wi)[0]) / 2, 1e-4);
    }
}

TEST(ProjectBoth, TruncatesToAPrefix) {
    const auto basis = bases::make("zernike", 4), lower = bases::make("zernike", 2);
    const InSpan brdf(*basis, {true, true, true}, 11);
    const Representation whole = projectBoth(brdf, *basis, true);
    const Representation direct = projectBoth(brdf, *lower, true);
    const Representation cut = truncated(whole, 2);
    ASSERT_EQ(matrixOf(cut).shape, matrixOf(direct).shape);
    for (std::size_t t = 0; t < matrixOf(cut).values.size(); ++t) {
        EXPECT_NEAR(matrixOf(cut).values[t], matrixOf(direct).values[t], 1e-4);
    }
}

TEST(ProjectBoth, RefusesWhatHasNoMeaning) {
    const auto lsosh = bases::make("lsosh", 3), hsh = bases::make("hsh", 2);
    const InSpan brdf(*hsh, {true, true, true}, 1);
    EXPECT_THROW(projectBoth(brdf, *lsosh, false), UsageError);
    ProjectionOptions cosine;
    cosine.quantity = Quantity::brdfCosine;
    EXPECT_THROW(projectBoth(brdf, *hsh, true, cosine), UsageError);
    EXPECT_THROW(truncated(projectBoth(brdf, *hsh, true), 3), UsageError);
}

}  // namespace
}  // namespace hshfit
