// Vector code of forms of coefficients and of shading on every instruction set, with operands and
// results that end where memory does.

#include <guarded_array.h>
#include <vector_targets.h>

#include <hshfit/representation/forms/internal/pair_kernels.h>
#include <hshfit/representation/halfway/halfway.h>
#include <hshfit/representation/halfway/internal/halfway_gram.h>
#include <hshfit/transfer/internal/shading_kernels.h>

#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

namespace hshfit {
namespace {

using test::forEveryTarget;
using test::GuardedArray;
using test::Side;

constexpr Side sides[] = {Side::front, Side::back};
constexpr std::size_t counts[] = {1, 2, 3, 4, 5, 7, 8, 9, 15, 16, 17, 31, 32, 33, 64, 65, 81};

double numberAt(std::size_t k) {
    return std::sin(0.3 + 1.7 * static_cast<double>(k));
}

TEST(VectorMemory, BilinearSumsStayWithinTheirBlock) {
    // rows 0 and 1: entries 0 to 1 and 2
    forEveryTarget([] {
        for (const std::size_t channels : {1, 2, 3, 4})
            for (std::size_t count = pairPadding; count <= 3 * pairPadding; count += pairPadding)
                for (const Side side : sides) {
                    BilinearForm form{.channels = channels,
                                      .rowStarts = {0, 2, 3},
                                      .rows = {0, 1},
                                      .columns = {0, 1, 1},
                                      .values = {}};
                    for (std::size_t k = 0; k < 3 * channels; ++k)
                        form.values.push_back(static_cast<float>(numberAt(k)));
                    const GuardedArray<float> rows(2 * count, side, numberAt);
                    const GuardedArray<float> columns(2 * count, side, numberAt);
                    GuardedArray<float> out(channels * count, side);
                    sumBilinear(form, rows.data(), columns.data(), count, out.data());
                    for (std::size_t c = 0; c < channels; ++c)
                        for (std::size_t k = 0; k < count; ++k) {
                            const auto value = [&](std::size_t e) {
                                return double{form.values[e * channels + c]};
                            };
                            const double a = double{columns[k]}, b = double{columns[count + k]};
                            ASSERT_NEAR(out[c * count + k],
                                        double{rows[k]} * (value(0) * a + value(1) * b) +
                                            double{rows[count + k]} * value(2) * b,
                                        1e-6);
                        }
                }
    });
}

TEST(VectorMemory, MixedDotsStayWithinTheirRows) {
    forEveryTarget([] {
        for (const int mixed : {1, 2, 3, 4})
            for (const std::size_t channels : {1, 3, 4})
                for (std::size_t length = 1; length <= 2 * pairPadding + 1; ++length)
                    for (const Side side : sides) {
                        const std::size_t stride =
                            (length + pairPadding - 1) / pairPadding * pairPadding;
                        const GuardedArray<float> basis(2 * length, side, numberAt);
                        const GuardedArray<float> rows(channels * stride, side, [&](std::size_t k) {
                            return k % stride < length ? numberAt(k) : 0.0;
                        });
                        RowMix mix{.count = mixed};
                        for (int r = 0; r < mixed; ++r) {
                            mix.rows[r] = rows.data();
                            mix.weights[r] = static_cast<float>(r + 1);
                        }
                        const RowMix mixes[] = {mix, mix};
                        GuardedArray<float> out(2 * channels, side);
                        dotMixed({.basis = basis.data(),
                                  .length = length,
                                  .stride = stride,
                                  .channels = channels,
                                  .count = 2,
                                  .outStride = 2},
                                 mixes, out.data());
                        for (std::size_t k = 0; k < 2; ++k)
                            for (std::size_t c = 0; c < channels; ++c) {
                                double sum = 0;
                                for (std::size_t i = 0; i < length; ++i)
                                    sum += double{basis[k * length + i]} *
                                           double{rows[c * stride + i]};
                                ASSERT_NEAR(out[c * 2 + k], mixed * (mixed + 1) / 2 * sum, 1e-4);
                            }
                    }
    });
}

TEST(VectorMemory, GramMatricesStayWithinTheirColumns) {
    constexpr std::size_t smooth = 3, stride = 2;
    forEveryTarget([] {
        for (const std::size_t columns : {gramPadding, 2 * gramPadding})
            for (const std::size_t rows : {1, 5})
                for (const Side side : sides) {
                    const GuardedArray<double> terms(rows * columns, side, numberAt);
                    std::vector<HalfwayResidual> residuals(rows * stride);
                    for (std::size_t k = 0; k < residuals.size(); ++k) {
                        const auto n = static_cast<double>(k + 1);
                        residuals[k] = {.smooth = 0.2 * n, .lobe = 1 / n, .error = -n, .weight = n};
                    }
                    GuardedArray<double> space(2 * rows * columns, side),
                        gram(columns * columns, side), slope(columns, side);
                    addResiduals({.terms = terms.data(),
                                  .residuals = residuals.data(),
                                  .count = rows,
                                  .columns = columns,
                                  .smooth = smooth,
                                  .stride = stride},
                                 space.data(), gram.data(), slope.data());
                    const auto derivative = [&](std::size_t k, std::size_t i) {
                        const HalfwayResidual& at = residuals[k * stride];
                        return (i < smooth ? at.smooth : at.lobe) * terms[k * columns + i];
                    };
                    for (std::size_t i = 0; i < columns; ++i) {
                        double sum = 0;
                        for (std::size_t k = 0; k < rows; ++k) {
                            const HalfwayResidual& at = residuals[k * stride];
                            sum += at.weight * at.error * derivative(k, i);
                        }
                        ASSERT_NEAR(slope[i], sum, 1e-12);
                        for (std::size_t j = 0; j <= i; ++j) {
                            double product = 0;
                            for (std::size_t k = 0; k < rows; ++k) {
                                product += residuals[k * stride].weight * derivative(k, i) *
                                           derivative(k, j);
                            }
                            ASSERT_NEAR(gram[i * columns + j], product, 1e-12);
                        }
                    }
                }
    });
}

/// A halfway form of every kind of function, with coefficients that fall.
Representation halfwayForm(std::size_t channels, bool isotropic) {
    Representation r;
    r.halfway = {4, 3, 3};
    r.head.isotropic = isotropic;
    if (channels > 1) {
        std::vector<double> wavelengths;
        for (std::size_t c = 0; c < channels; ++c)
            wavelengths.push_back(400 + 40 * static_cast<double>(c));
        r.head.channels = Channels::spectral(wavelengths);
    }
    const std::size_t terms = HalfwayTerms(r.halfway, halfwaySymmetryOf(r.head)).size();
    HalfwayArray content{.halfway = {.shape = {channels, terms}, .values = {}},
                         .lobe = {0.4, isotropic ? 0.4 : 0.2, 0},
                         .ceilings = std::vector<HalfwayCeiling>(channels, {0.1, 0.1, 2})};
    for (std::size_t k = 0; k < channels * terms; ++k)
        content.halfway.values.push_back(numberAt(k) / static_cast<double>(1 + k % terms));
    r.content = std::move(content);
    return r;
}

TEST(VectorMemory, HalfwayFormsStayWithinTheirPairs) {
    forEveryTarget([] {
        for (const bool isotropic : {false, true})
            for (const std::size_t channels : {1, 2, 3, 4, 7}) {
                const Representation form = halfwayForm(channels, isotropic);
                const HalfwayExpansion slow(form);
                const auto fast = halfwayPairEvaluator(form);
                for (const std::size_t count : counts)
                    for (const Side side : sides) {
                        const GuardedArray<double> across(count, side, [](std::size_t k) {
                            return 0.6 * std::cos(static_cast<double>(k));
                        });
                        const GuardedArray<double> along(count, side, [](std::size_t k) {
                            return 0.6 * std::sin(static_cast<double>(k));
                        });
                        const GuardedArray<double> height(count, side, [](std::size_t k) {
                            return k % 5 == 4 ? -0.8 : 0.8;  // some below the horizon
                        });
                        const DirectionBatch wi{across.data(), along.data(), height.data(), count};
                        const DirectionBatch wo{along.data(), across.data(), height.data(), count};
                        GuardedArray<float> out(channels * count, side);
                        fast->evaluate(wi, wo, out.data());
                        std::vector<double> f(channels);
                        for (std::size_t k = 0; k < count; ++k) {
                            slow.evaluate({along[k], across[k], height[k]},
                                          {&across[k], &along[k], &height[k], 1}, f.data());
                            for (std::size_t c = 0; c < channels; ++c)
                                ASSERT_NEAR(out[c * count + k], f[c], 2e-5 * (1 + f[c]));
                        }
                    }
            }
    });
}

TEST(VectorMemory, ShadingStaysWithinVertices) {
    constexpr int order = 3;
    constexpr std::size_t slots = order * order, elevations = 5, row = elevations + 1;
    forEveryTarget([] {
        for (const std::size_t vertices : counts)
            for (const Side side : sides) {
                const GuardedArray<float> light(slots * vertices, side, numberAt);
                const GuardedArray<float> brdf(slots * vertices, side, numberAt);
                // A table that is the same at all elevations, and views at azimuth 0.
                const GuardedArray<float> table(slots * row, side,
                                                [](std::size_t k) { return numberAt(k / row); });
                const GuardedArray<float> z(vertices, side, [](std::size_t k) {
                    return 0.1 * static_cast<double>(k % 10);
                });
                const GuardedArray<float> cosine(vertices, side, [](std::size_t) { return 1.0; });
                const GuardedArray<float> sine(vertices, side);
                GuardedArray<float> each(vertices, side), one(vertices, side),
                    shaded(vertices, side);
                shadeDots(
                    {brdf.data(), vertices, true, light.data(), slots, vertices, each.data()});
                shadeDots({brdf.data(), 1, false, light.data(), slots, vertices, one.data()});
                shadeTable({.table = table.data(),
                            .order = order,
                            .bilateral = false,
                            .channels = 1,
                            .elevations = elevations,
                            .views = {z.data(), cosine.data(), sine.data(), vertices},
                            .light = light.data(),
                            .out = shaded.data()});
                for (std::size_t v = 0; v < vertices; ++v) {
                    double sum = 0, first = 0, ofTable = 0;
                    for (std::size_t i = 0; i < slots; ++i) {
                        const double l = double{light[i * vertices + v]};
                        sum += double{brdf[i * vertices + v]} * l;
                        first += double{brdf[i]} * l;
                        ofTable += double{table[i * row]} * l;
                    }
                    ASSERT_NEAR(each[v], sum, 1e-5);
                    ASSERT_NEAR(one[v], first, 1e-5);
                    ASSERT_NEAR(shaded[v], z[v] > 0 ? ofTable : 0, 1e-5);
                }
            }
    });
}

}  // namespace
}  // namespace hshfit
