#include <hshfit/representation/factoring/factoring.h>

#include <hshfit/error.h>
#include <hshfit/representation/change.h>
#include <hshfit/representation/factoring_blocks.h>
#include <hshfit/representation/named_arrays.h>
#include <hshfit/representation/split.h>
#include <lib/representation/representation_measures.h>

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include <cmath>
#include <map>

namespace hshfit {
namespace {

using namespace test;

/// Singular values of the reconstruction's own values, by Jacobi's method: rows [outgoing, channel]
/// with the roots of the solid angles, columns nodes with the roots of the weights.
Eigen::VectorXd denseSpectrum(const Representation& r) {
    const auto basis = bases::make(r.head.basis, r.head.order);
    const HemisphereNodes nodes(basis->inner(), 20, 20);
    const auto brdf = reconstruct(r, opensNothing);
    const auto channels = static_cast<Eigen::Index>(brdf->channels().count());
    const auto count = static_cast<Eigen::Index>(nodes.size());
    Eigen::MatrixXd dense(static_cast<Eigen::Index>(r.head.outgoing.size()) * channels, count);
    std::vector<double> f(nodes.size() * brdf->channels().count());
    for (std::size_t o = 0; o < r.head.outgoing.size(); ++o) {
        brdf->eval(r.head.outgoing.directions[o], nodes.batch(), f.data());
        for (Eigen::Index c = 0; c < channels; ++c) {
            for (Eigen::Index k = 0; k < count; ++k) {
                dense(static_cast<Eigen::Index>(o) * channels + c, k) =
                    f[static_cast<std::size_t>(c * count + k)] *
                    std::sqrt(r.head.outgoing.solidAngles[o] *
                              nodes.weights[static_cast<std::size_t>(k)]);
            }
        }
    }
    return Eigen::JacobiSVD<Eigen::MatrixXd>(dense).singularValues();
}

double tailOf(const Eigen::VectorXd& sigma, int rank) {
    return sigma.tail(std::max<Eigen::Index>(sigma.size() - rank, 0)).norm() / sigma.norm();
}

int rankOf(const Representation& rows) {
    return static_cast<int>(std::get<CoefficientFactors>(rows.content).left.columns());
}

/// The block of that name where it is kept as a `Part`.
template <class Part>
bool blockOf(const Representation& matrix, const std::string& name) {
    const auto& blocks = std::get<MatrixFactors>(matrix.content).blocks;
    return std::ranges::any_of(blocks, [&](const MatrixBlock& block) {
        return block.name == name && std::holds_alternative<Part>(block.part);
    });
}

TEST(Factoring, OfRowsIsTheOptimumForEveryBasis) {
    const FormulaBrdf round = glossy(20), along = brushed();
    for (const auto& entry : bases::catalog()) {
        for (const bool isotropic : {true, false}) {
            const Brdf& brdf = isotropic ? static_cast<const Brdf&>(round) : along;
            const auto basis = basisOf(entry, isotropic ? 7 : 4);
            const auto set = isotropic ? OutgoingSet::elevations(9) : OutgoingSet::parabolic(6, 6);
            const Representation before = perOutgoing(brdf, *basis, set);
            const Eigen::VectorXd sigma = denseSpectrum(before);
            for (const int rank : {1, 2, 4}) {
                const Representation after = factored(before, {.rank = rank});
                const double change = after.steps.at(0).change;
                EXPECT_NEAR(change, tailOf(sigma, rank), 1e-7) << entry.name << rank;
                EXPECT_NEAR(change, measuredChange(before, after), 1e-7) << entry.name << rank;
                EXPECT_LE(rankOf(after), rank);
            }
        }
    }
}

TEST(Factoring, TakesTheLeastRankWithinAnError) {
    const auto basis = bases::make("hsh", 8);
    const Representation before = perOutgoing(glossy(50), *basis, OutgoingSet::elevations(12));
    const Eigen::VectorXd sigma = denseSpectrum(before);
    for (const double error : {0.3, 0.1, 0.03, 1e-3}) {
        const Representation after = factored(before, {.error = error});
        const int rank = rankOf(after);
        EXPECT_LE(after.steps.at(0).change, error);
        EXPECT_GT(tailOf(sigma, rank - 1), error) << rank;
    }
}

TEST(Factoring, OfTwoChannelsSharesTheRightPart) {
    // The second channel is half of the first: no rank is spent on it.
    const auto formula = [](const Direction& wi, const Direction& wo) {
        return wi.z * wo.z + std::pow(std::max(wi.z + wo.x * wi.x, 0.0), 3);
    };
    const FormulaBrdf grey(formula),
        two(formula, {}, {.isotropic = false}, Channels::spectral({500, 600}));
    const auto basis = bases::make("hsh", 5);
    const auto set = OutgoingSet::parabolic(5, 5);
    const auto one = perOutgoing(FormulaBrdf(formula, {}, {.isotropic = false}), *basis, set);
    const auto both = perOutgoing(two, *basis, set);
    for (const int rank : {1, 2, 3}) {
        EXPECT_NEAR(factored(one, {.rank = rank}).steps.at(0).change,
                    factored(both, {.rank = rank}).steps.at(0).change, 1e-9);
    }
}

/// Whole matrices of functions of wo and wi by what the terms mean, evaluated as sums: the
/// coefficients over wi that each single function of wo contributes.
std::map<std::string, Eigen::MatrixXd> denseBlocks(const Representation& matrix) {
    const auto basis = bases::make(matrix.head.basis, matrix.head.order);
    const auto symmetry = symmetryOf(matrix);
    const auto terms = productTerms(*basis, symmetry);
    const auto slots = static_cast<Eigen::Index>(basis->slots());
    std::map<std::string, Eigen::MatrixXd> blocks;
    for (Eigen::Index row = 0; row < slots; ++row) {
        std::vector<double> atWo(static_cast<std::size_t>(slots), 0.0), c = atWo;
        atWo[static_cast<std::size_t>(row)] = 1;
        contractWithOutgoing(terms, symmetry, matrixValues(matrix).data(), atWo.data(), c.data());
        for (Eigen::Index column = 0; column < slots; ++column) {
            const int l = static_cast<int>(std::sqrt(static_cast<double>(column) + 0.5));
            const int m = static_cast<int>(column) - l * (l + 1);
            // Isotropic: cosine and sine terms of one |m| hold the same numbers over sqrt 2.
            const int n = std::abs(m);
            const std::string name = symmetry.isotropic
                                         ? std::to_string(m)
                                         : std::string(m < 0 ? "s" : "c") + std::to_string(n % 2);
            auto& block = blocks[name];
            if (block.size() == 0) block = Eigen::MatrixXd::Zero(slots, slots);
            block(row, column) = c[static_cast<std::size_t>(column)];
        }
    }
    return blocks;
}

TEST(Factoring, OfBothDirectionsIsTheOptimumOfEachBlock) {
    const FormulaBrdf round = glossy(15), along = brushed();
    for (const char* name : {"hsh", "zernike", "makhotkin"}) {
        for (const bool isotropic : {true, false}) {
            const auto basis = bases::make(name, isotropic ? 6 : 4);
            const Brdf& brdf = isotropic ? static_cast<const Brdf&>(round) : along;
            for (const bool reciprocal : {false, true}) {
                const Representation before = bothIn(brdf, *basis, reciprocal);
                double total = 0;
                const auto blocks = denseBlocks(before);
                for (const auto& [m, block] : blocks) total += block.squaredNorm();
                for (const int rank : {1, 2}) {
                    const Representation after = factored(before, {.rank = rank});
                    const double change = after.steps.at(0).change;
                    EXPECT_NEAR(change, measuredChange(before, after), 1e-7) << name;
                    double lost = 0;
                    for (const auto& [m, block] : blocks) {
                        // Blocks that are smaller whole stay so.
                        const bool sine = isotropic && m[0] == '-';
                        if (blockOf<WholeBlock>(after, m.substr(sine ? 1 : 0))) continue;
                        const Eigen::VectorXd sigma =
                            Eigen::JacobiSVD<Eigen::MatrixXd>(block).singularValues();
                        lost += sigma.tail(sigma.size() - rank).squaredNorm();
                    }
                    EXPECT_NEAR(change, std::sqrt(lost / total), 1e-9) << name << rank;
                    EXPECT_LE(after.numbers(), before.numbers()) << name;
                }
            }
        }
    }
}

TEST(Factoring, OfBothDirectionsKeepsToAnError) {
    const auto basis = bases::make("hsh", 6);
    for (const bool reciprocal : {false, true}) {
        const Representation before = bothIn(glossy(15), *basis, reciprocal);
        for (const double error : {0.2, 0.05, 1e-3}) {
            const Representation after = factored(before, {.error = error});
            EXPECT_LE(after.steps.at(0).change, error + 1e-12);
            if (error > 0.1) {
                EXPECT_GT(after.steps.at(0).change, 0);
            }
        }
        // All ranks: everything is there again.
        EXPECT_LT(factored(before, {.rank = 100}).steps.at(0).change, 1e-12);
    }
}

TEST(Factoring, KeepsReciprocity) {
    const auto basis = bases::make("zernike", 6);
    const Representation after = factored(bothIn(glossy(15), *basis, true), {.rank = 1});
    ASSERT_TRUE(blockOf<SymmetricBlock>(after, "0"));
    const auto brdf = reconstruct(after, opensNothing);
    std::mt19937 random(3);
    for (int k = 0; k < 1000; ++k) {
        const Direction wi = randomDirection(random), wo = randomDirection(random);
        EXPECT_NEAR(evaluate(*brdf, wi, wo)[0], evaluate(*brdf, wo, wi)[0], 1e-12);
    }
}

TEST(Factoring, ReadersOfBlocksRefuseWhatDoesNotFit) {
    const auto basis = bases::make("hsh", 5);
    const Representation good = factored(bothIn(glossy(15), *basis, false), {.rank = 1});
    ASSERT_TRUE(blockOf<ProductBlock>(good, "0"));
    Representation bad = good;
    bad.content = MatrixFactors{};
    EXPECT_THROW(matrixValues(bad), InputError);
    for (std::size_t b = 0; b < std::get<MatrixFactors>(good.content).blocks.size(); ++b) {
        bad = good;
        std::get<MatrixFactors>(bad.content).blocks[b].name = "other";
        EXPECT_THROW(matrixValues(bad), InputError) << b;
        bad = good;
        std::get<MatrixFactors>(bad.content).blocks[b].part = SymmetricBlock{};
        EXPECT_THROW(matrixValues(bad), InputError) << b;
    }
    for (std::size_t a = 0; a < namedArrays(good).size(); ++a) {
        for (const std::size_t side : {0, 1}) {
            bad = good;
            const auto [name, array] = namedArrays(bad)[a];
            array->values.resize(array->values.size() + array->shape[1 - side]);
            ++array->shape[side];
            EXPECT_THROW(matrixValues(bad), InputError) << name << side;
        }
    }
}

TEST(Factoring, NamesOfArraysLeadBackToTheirPlaces) {
    const auto basis = bases::make("hsh", 5);
    const Representation rows = perOutgoing(glossy(15), *basis, OutgoingSet::elevations(4));
    for (const Representation& before :
         {rows, factored(rows, {.rank = 2}), bothIn(glossy(15), *basis, false),
          factored(bothIn(glossy(15), *basis, false), {.rank = 1}),
          factored(bothIn(glossy(15), *basis, true), {.rank = 1})}) {
        std::vector<Named<StoredArray>> arrays;
        for (const auto& [name, array] : namedArrays(before)) arrays.push_back({name, *array});
        Representation after = before;
        after.content = contentOf(before.kind(), arrays);
        EXPECT_EQ(after.content.index(), before.content.index());
        const auto found = namedArrays(after);
        ASSERT_EQ(found.size(), arrays.size());
        for (std::size_t a = 0; a < arrays.size(); ++a) {
            EXPECT_EQ(found[a].name, arrays[a].name);
            EXPECT_EQ(found[a].array->values, arrays[a].array.values);
        }
        EXPECT_THROW(contentOf(Representation::Kind::halfway, arrays), InputError);
        arrays.push_back(arrays.front());
        EXPECT_THROW(contentOf(before.kind(), arrays), InputError) << "twice";
        arrays.pop_back();
        arrays.front().name = "other";
        EXPECT_THROW(contentOf(before.kind(), arrays), InputError);
    }
}

TEST(Factoring, NonNegativeFactorsAreNonNegative) {
    for (const char* name : {"hsh", "makhotkin"}) {
        const auto basis = bases::make(name, 5);
        const Representation before =
            perOutgoing(glossy(30, 0.02), *basis, OutgoingSet::elevations(6));
        double last = 1;
        for (const int rank : {1, 2, 3}) {
            const Representation after = factored(before, {.rank = rank, .nonNegative = true});
            const double change = after.steps.at(0).change;
            EXPECT_NEAR(change, measuredChange(before, after), 1e-7);
            EXPECT_GE(change, factored(before, {.rank = rank}).steps.at(0).change - 1e-9);
            EXPECT_LT(change, last) << name << rank;
            last = change;
            const auto& [left, right] = std::get<CoefficientFactors>(after.content);
            for (const double u : left.values) EXPECT_GE(u, 0);
            std::vector<double> row(static_cast<std::size_t>(basis->slots())), at = row;
            std::mt19937 random(5);
            for (std::size_t r = 0; r < right.rows(); ++r) {
                std::fill(row.begin(), row.end(), 0.0);
                double squares = 0;
                for (std::size_t k = 0; k < right.columns(); ++k) {
                    row[static_cast<std::size_t>(after.slots[k])] =
                        right.values[r * right.columns() + k];
                    squares += std::pow(right.values[r * right.columns() + k], 2);
                }
                for (int k = 0; k < 10000; ++k) {
                    basis->evaluate(randomDirection(random), at.data());
                    double value = 0;
                    for (std::size_t i = 0; i < row.size(); ++i) value += row[i] * at[i];
                    ASSERT_GE(value, -1e-5 * std::sqrt(squares)) << name << rank << r;
                }
            }
        }
    }
}

TEST(Factoring, OneNonNegativeProductIsFound) {
    // f = g(wi) h(wo), both positive and g within the basis: nothing is lost at rank 1.
    const FormulaBrdf brdf(
        [](const Direction& wi, const Direction& wo) { return (0.2 + wi.z * wi.z) * (1 + wo.z); },
        {}, {.isotropic = true, .mirrorSymmetric = true});
    const auto basis = bases::make("hsh", 4);
    const Representation before = perOutgoing(brdf, *basis, OutgoingSet::elevations(6));
    EXPECT_LT(factored(before, {.rank = 1, .nonNegative = true}).steps.at(0).change, 1e-5);
}

TEST(Factoring, ASearchThatStopsEarlySaysSo) {
    const auto basis = bases::make("hsh", 4);
    const Representation before = perOutgoing(glossy(5), *basis, OutgoingSet::elevations(6));
    const auto said = [&](int mostSweeps) {
        return factored(before, {.rank = 3, .nonNegative = true, .mostSweeps = mostSweeps})
            .steps.at(0)
            .what;
    };
    EXPECT_EQ(said(1), "non-negative rank 3, not settled in 1 sweeps");
    EXPECT_EQ(said(1000), "non-negative rank 3");
}

TEST(Factoring, RefusesWhatItCannotDo) {
    const auto basis = bases::make("hsh", 3);
    const Representation rows = perOutgoing(glossy(5), *basis, OutgoingSet::elevations(4));
    const Representation both = bothIn(glossy(5), *basis, false);
    EXPECT_THROW(factored(rows, {}), UsageError);
    EXPECT_THROW(factored(rows, {.rank = -1}), UsageError);
    EXPECT_THROW(factored(rows, {.error = 0.1, .nonNegative = true}), UsageError);
    EXPECT_THROW(factored(both, {.rank = 1, .nonNegative = true}), UsageError);
    EXPECT_THROW(factored(factored(rows, {.rank = 1}), {.rank = 1}), UsageError);
}

TEST(SliceSpectrum, OfAProductIsOneValue) {
    const FormulaBrdf brdf(
        [](const Direction& wi, const Direction& wo) { return (0.2 + wi.z) * std::sqrt(wo.z); });
    const SliceSpectrum spectrum = sliceSpectrum(brdf, OutgoingSet::elevations(5));
    EXPECT_TRUE(spectrum.converged);
    EXPECT_LT(spectrum.relativeError(1), 1e-6);
    EXPECT_DOUBLE_EQ(spectrum.relativeError(0), 1);
    // |g|^2 = integral of (0.2 + z)^2 over the hemisphere; |h|^2 = sum of solid angles times z.
    const auto set = OutgoingSet::elevations(5);
    double h = 0;
    for (std::size_t o = 0; o < set.size(); ++o) h += set.solidAngles[o] * set.directions[o].z;
    const double g = 2 * pi * (0.04 + 0.2 + 1.0 / 3);
    EXPECT_NEAR(spectrum.values[0], std::sqrt(g * h), 1e-9);
}

TEST(SliceSpectrum, BoundsEveryBasis) {
    // No product of rank r in any basis is nearer to the source than the bound.
    const FormulaBrdf brdf = glossy(5);
    const auto set = OutgoingSet::elevations(8);
    for (const auto& entry : bases::catalog()) {
        const auto basis = basisOf(entry, 8);
        const SliceSpectrum bound = sliceSpectrum(brdf, set, Quantity::brdf, basis->inner());
        ASSERT_TRUE(bound.converged);
        const HemisphereNodes nodes(basis->inner(), 60, 64);
        const Representation whole = perOutgoing(brdf, *basis, set);
        for (const int rank : {1, 2, 3}) {
            const auto fit = reconstruct(factored(whole, {.rank = rank}), opensNothing);
            std::vector<double> f(nodes.size()), g(nodes.size());
            double error = 0, norm = 0;
            for (std::size_t o = 0; o < set.size(); ++o) {
                brdf.eval(set.directions[o], nodes.batch(), f.data());
                fit->eval(set.directions[o], nodes.batch(), g.data());
                for (std::size_t k = 0; k < f.size(); ++k) {
                    const double weight = set.solidAngles[o] * nodes.weights[k];
                    error += weight * std::pow(f[k] - g[k], 2);
                    norm += weight * f[k] * f[k];
                }
            }
            EXPECT_GE(std::sqrt(error / norm),
                      bound.relativeError(static_cast<std::size_t>(rank)) - 1e-4)
                << entry.name << rank;
            if (entry.name == "hsh") {
                EXPECT_LT(std::sqrt(error / norm),
                          bound.relativeError(static_cast<std::size_t>(rank)) + 0.1);
            }
        }
    }
}

std::unique_ptr<Brdf> opensLambert(const std::string& spec) {
    const double kd = std::stod(spec.substr(spec.find('=') + 1));
    return std::make_unique<FormulaBrdf>(
        [=](const Direction& wi, const Direction& wo) {
            return wi.z > 0 && wo.z > 0 ? kd / pi : 0.0;
        },
        FormulaBrdf::Predicate{},
        Laws{.nonNegative = true, .reciprocal = true, .isotropic = true, .mirrorSymmetric = true});
}

TEST(SplitTest, TakesOutTheLambertTermOfASum) {
    // The half vector's cosine is at least 0.5^0.5 in the search, but its 300th power is nothing.
    for (const double kd : {0.7, 0.123, 1e-3}) {
        const FormulaBrdf brdf = glossy(300, kd);
        const Split split = takeOut(brdf, "diffuse", opensLambert);
        EXPECT_EQ(split.added.rfind("lambert:kd=", 0), 0u);
        EXPECT_NEAR(diffuseAlbedo(brdf).at(0), kd, 2e-6 * kd);
        EXPECT_LE(diffuseAlbedo(brdf).at(0), kd * (1 + 1e-12));
        EXPECT_TRUE(split.remainder->laws().nonNegative);
    }
}

TEST(SplitTest, LeavesNothingNegativeAndAddsUp) {
    const FormulaBrdf smooth = glossy(2, 0.2), along = brushed();
    for (const Brdf* brdf : {static_cast<const Brdf*>(&smooth), static_cast<const Brdf*>(&along)}) {
        const Split split = takeOut(*brdf, "diffuse", opensLambert);
        ASSERT_FALSE(split.added.empty());
        const auto added = opensLambert(split.added);
        EXPECT_EQ(split.remainder->laws().isotropic, brdf->laws().isotropic);
        std::mt19937 random(9);
        double least = 1e300;
        for (int k = 0; k < 100000; ++k) {
            const Direction wi = randomDirection(random), wo = randomDirection(random);
            if (wi.z < std::cos(radians(89)) || wo.z < std::cos(radians(89))) continue;
            const double rest = evaluate(*split.remainder, wi, wo)[0];
            least = std::min(least, rest);
            EXPECT_NEAR(rest + evaluate(*added, wi, wo)[0], evaluate(*brdf, wi, wo)[0], 1e-14);
        }
        EXPECT_GE(least, 0);
        // The largest: hardly more would make it negative.
        EXPECT_LT(least, 0.01 * std::stod(split.added.substr(11)) + 1e-3);
    }
}

TEST(SplitTest, WithoutADiffusePartTakesNothingOut) {
    const FormulaBrdf brdf(
        [](const Direction& wi, const Direction& wo) { return wi.z * wo.z * std::abs(wi.x); }, {},
        {.nonNegative = true, .isotropic = false});
    const Split split = takeOut(brdf, "diffuse", opensLambert);
    EXPECT_EQ(split.added, "");
    EXPECT_EQ(addedTo(*split.remainder), nullptr);
    const Direction wi = directionFromAngles(0.4, 1), wo = directionFromAngles(1.1, 2);
    EXPECT_EQ(evaluate(*split.remainder, wi, wo), evaluate(brdf, wi, wo));
    EXPECT_TRUE(split.remainder->laws().nonNegative);
}

TEST(SplitTest, RefusesOtherChannels) {
    const FormulaBrdf brdf = glossy(5);
    const auto open = [](const std::string&) {
        return std::make_unique<FormulaBrdf>([](const Direction&, const Direction&) { return 1.0; },
                                             FormulaBrdf::Predicate{}, Laws{},
                                             Channels::spectral({500, 600}));
    };
    EXPECT_THROW(takeOut(brdf, "two wavelengths", open), UsageError);
}

}  // namespace
}  // namespace hshfit
