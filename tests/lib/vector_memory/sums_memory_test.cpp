// Vector code of projections on every instruction set, against plain loops, with operands and
// results that end where memory does.

#include <guarded_array.h>
#include <vector_targets.h>

#include <hshfit/projection/internal/ring_kernels.h>
#include <hshfit/projection/lane_products.h>

#include <fmt/format.h>

#include <cmath>
#include <vector>

namespace hshfit {
namespace {

using test::forEveryTarget;
using test::GuardedArray;
using test::Side;

constexpr Side sides[] = {Side::front, Side::back};
constexpr std::size_t mostCount = 17;  // two vectors of doubles and one more

double numberAt(std::size_t k) {
    return std::sin(0.3 + 1.7 * static_cast<double>(k));
}

TEST(VectorMemory, ProductsStayWithinTheirMatrices) {
    forEveryTarget([] {
        for (std::size_t rows = 1; rows <= 13; ++rows)
            for (std::size_t columns = laneGroup; columns <= 9 * laneGroup; columns += laneGroup)
                for (std::size_t depth = 0; depth <= 9; ++depth)
                    for (const Side side : sides) {
                        const GuardedArray<double> a(rows * depth, side, numberAt);
                        const GuardedArray<double> b(depth * columns, side, numberAt);
                        GuardedArray<double> out(rows * columns, side, numberAt);
                        addProducts({a.data(), rows, depth}, {b.data(), columns, columns}, depth,
                                    out.data(), columns);
                        for (std::size_t i = 0; i < rows * columns; ++i) {
                            double sum = numberAt(i);
                            for (std::size_t k = 0; k < depth; ++k)
                                sum += a[i / columns * depth + k] * b[k * columns + i % columns];
                            ASSERT_NEAR(out[i], sum, 1e-14) << rows << " x " << columns;
                        }
                    }
    });
}

TEST(VectorMemory, SumsOverThetaStayWithinTheirOrder) {
    constexpr std::size_t rings = 3, channels = 2;
    forEveryTarget([] {
        for (int order = 1; order <= 18; ++order)
            for (const Side side : sides) {
                const auto columns = static_cast<std::size_t>(2 * order - 1);
                std::vector<std::size_t> columnOf;
                std::size_t lanes = 0;
                for (int m = 0; m < order; ++m) {
                    columnOf.push_back(static_cast<std::size_t>(m));
                    columnOf.push_back(static_cast<std::size_t>(m == 0 ? 0 : order + m - 1));
                    lanes += thetaLanes(order, m);
                }
                const GuardedArray<double> spectrum(rings * channels * columns, side, numberAt);
                const GuardedArray<double> theta(rings * lanes, side, numberAt);
                GuardedArray<double> out(2 * channels * lanes, side);
                addThetaSums({.spectrum = spectrum.data(),
                              .rings = rings,
                              .channels = channels,
                              .columns = columns,
                              .columnOf = columnOf.data(),
                              .order = order,
                              .firstM = 0,
                              .lastM = order,
                              .even = false,
                              .theta = theta.data()},
                             out.data());
                const double *from = theta.data(), *to = out.data();
                for (int m = 0; m < order; ++m) {
                    const std::size_t width = thetaLanes(order, m);
                    for (std::size_t i = 0; i < (m == 0 ? 1 : 2) * channels * width; ++i) {
                        const std::size_t row = i / width, kind = row / channels;
                        double sum = 0;
                        for (std::size_t r = 0; r < rings; ++r)
                            sum += spectrum[(r * channels + row % channels) * columns +
                                            columnOf[2 * static_cast<std::size_t>(m) + kind]] *
                                   from[r * width + i % width];
                        ASSERT_NEAR(to[i], sum, 1e-14) << order << " " << m;
                    }
                    from += rings * width;
                    to += 2 * channels * width;
                }
            }
    });
}

struct Folded {
    GuardedArray<double> c0, c1, s1, s0;
    Folded(std::size_t count, Side side)
        : c0(count, side), c1(count, side), s1(count, side), s0(count, side) {}
    QuadrantFold out() { return {c0.data(), c1.data(), s1.data(), s0.data()}; }
};

TEST(VectorMemory, FoldsStayWithinTheirRings) {
    forEveryTarget([] {
        for (std::size_t count = 1; count <= mostCount; ++count)
            for (const Side side : sides) {
                const GuardedArray<double> ring(4 * count, side, numberAt);
                Folded whole(count, side), half(count, side);
                const double squares = foldRing(ring.data(), count, whole.out());
                const GuardedArray<double> start(2 * count, side, numberAt);
                const double halfSquares = foldHalfRing(start.data(), count, half.out());
                double sum = 0, halfSum = 0;
                for (std::size_t k = 0; k < 4 * count; ++k) {
                    sum += ring[k] * ring[k];
                    if (k < 2 * count) halfSum += ring[k] * ring[k];
                }
                ASSERT_NEAR(squares, sum, 1e-13);
                ASSERT_NEAR(halfSquares, halfSum, 1e-13);
                for (std::size_t k = 0; k < count; ++k) {
                    const double a = ring[k], b = ring[count + k], c = ring[2 * count + k],
                                 d = ring[3 * count + k];
                    ASSERT_NEAR(whole.c0[k], a + b + c + d, 1e-14);
                    ASSERT_NEAR(whole.c1[k], a - b + c - d, 1e-14);
                    ASSERT_NEAR(whole.s1[k], a + b - c - d, 1e-14);
                    ASSERT_NEAR(whole.s0[k], a - b - c + d, 1e-14);
                    ASSERT_NEAR(half.c0[k], a + b, 1e-14);
                    ASSERT_NEAR(half.c1[k], a - b, 1e-14);
                }
            }
    });
}

TEST(VectorMemory, SqueezedFoldsStayWithinTheirRings) {
    forEveryTarget([] {
        for (std::size_t count = 1; count <= mostCount; ++count)
            for (const Side side : sides)
                for (const bool both : {false, true}) {
                    const GuardedArray<double> values((both ? 2 : 1) * count, side, numberAt);
                    const GuardedArray<double> weights(count, side, numberAt);
                    GuardedArray<double> even(count, side), odd(count, side);
                    const double squares =
                        foldSqueezedRing(values.data(), weights.data(), count, even.data(),
                                         both ? odd.data() : nullptr);
                    double sum = 0;
                    for (std::size_t k = 0; k < count; ++k) {
                        const double a = values[k], b = both ? values[count + k] : 0;
                        sum += weights[k] * (a * a + b * b);
                        ASSERT_NEAR(even[k], a + b, 1e-14);
                        ASSERT_NEAR(odd[k], both ? a - b : 0, 1e-14);
                    }
                    ASSERT_NEAR(squares, sum, 1e-13);
                }
    });
}

TEST(VectorMemory, DirectionsStayWithinTheirRings) {
    constexpr double sine = 0.6, cosine = 0.8;
    forEveryTarget([&] {
        for (std::size_t count = 1; count <= mostCount; ++count)
            for (const Side side : sides)
                for (const std::size_t copies : {1, 2, 4}) {
                    const bool squeezed = copies < 4;
                    const GuardedArray<double> c(count, side, [](std::size_t k) {
                        return std::cos(0.1 * static_cast<double>(k));
                    });
                    const GuardedArray<double> s(count, side, [](std::size_t k) {
                        return std::sin(0.1 * static_cast<double>(k));
                    });
                    GuardedArray<double> x(copies * count, side), y(copies * count, side),
                        z(copies * count, side);
                    const RingDirections ring{c.data(), s.data(), count, copies, 0.28, 0.96};
                    if (squeezed)
                        fillSqueezedRing(ring, sine, cosine, x.data(), y.data(), z.data());
                    else
                        fillRing(ring, sine, cosine, x.data(), y.data(), z.data());
                    for (std::size_t k = 0; k < copies * count; ++k) {
                        const std::size_t copy = k / count, j = k % count;
                        const double across = copy == 0 ? 1 : -1;
                        const double wantedX = squeezed ? 0.28 * c[j] - across * 0.96 * s[j]
                                                        : (copy % 2 == 0 ? 1 : -1) * c[j];
                        const double wantedY = squeezed ? 0.96 * c[j] + across * 0.28 * s[j]
                                                        : (copy < 2 ? 1 : -1) * s[j];
                        ASSERT_NEAR(x[k], sine * wantedX, 1e-15);
                        ASSERT_NEAR(y[k], sine * wantedY, 1e-15);
                        ASSERT_EQ(z[k], cosine);
                    }
                }
    });
}

TEST(VectorMemory, InterleavedFunctionsStayWithinRowsAndRings) {
    forEveryTarget([] {
        for (const std::size_t functions : {1, 3, 4, 5, 8, 11, 16, 23, 24})
            for (std::size_t count = 1; count <= mostCount; ++count)
                for (const Side side : sides) {
                    const GuardedArray<double> rows(functions * count, side, numberAt);
                    GuardedArray<double> out(lanesOfFunctions * count, side);
                    interleaveFunctions(rows.data(), functions, count, count, nullptr, out.data());
                    for (std::size_t k = 0; k < out.size(); ++k) {
                        const std::size_t f = k % lanesOfFunctions, at = k / lanesOfFunctions;
                        ASSERT_EQ(out[k], f < functions ? rows[f * count + at] : 0.0);
                    }
                }
        for (std::size_t azimuths = 4; azimuths <= 36; azimuths += 4)
            for (const Side side : sides) {
                const std::size_t values = azimuths * lanesOfFunctions, quarter = azimuths / 4;
                const GuardedArray<double> ring(values, side, numberAt);
                const GuardedArray<double> mirror(values, side, numberAt);
                GuardedArray<double> sum(values, side), difference(values, side);
                foldFunctions(ring.data(), mirror.data(), azimuths, sum.data(), difference.data());
                const auto at = [&](std::size_t j, std::size_t f) {
                    return ring[j * lanesOfFunctions + f];
                };
                for (std::size_t k = 0; k < quarter * lanesOfFunctions; ++k) {
                    const std::size_t j = k / lanesOfFunctions, f = k % lanesOfFunctions;
                    // The even part of a ring and its equal: twice the sum of the four quadrants.
                    ASSERT_NEAR(sum[k],
                                2 * (at(j, f) + at(azimuths / 2 - 1 - j, f) +
                                     at(azimuths - 1 - j, f) + at(azimuths / 2 + j, f)),
                                1e-14);
                }
                for (const double each : difference.all()) ASSERT_EQ(each, 0);
            }
    });
}

}  // namespace
}  // namespace hshfit
