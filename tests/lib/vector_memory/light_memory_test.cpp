// Vector code that transforms pictures on every instruction set, against plain sums, with rows and
// results that end where memory does.

#include <guarded_array.h>
#include <vector_targets.h>

#include <hshfit/light/internal/picture_spectra.h>

#include <cmath>
#include <numbers>

namespace hshfit {
namespace {

using std::numbers::pi;
using test::forEveryTarget;
using test::GuardedArray;
using test::Side;

constexpr Side sides[] = {Side::front, Side::back};

double numberAt(std::size_t k) {
    return std::sin(0.3 + 1.7 * static_cast<double>(k));
}

template <class Plan>
void checkRows(const Plan& plan, int order, std::size_t width, std::size_t count, Side side) {
    const SpectrumColumns columns(order);
    const GuardedArray<float> rows(count * 3 * width, side, numberAt);
    GuardedArray<double> out(count * 3 * columns.all, side), squares(count * 3, side);
    pictureSpectra(plan, columns, rows.data(), count, out.data(), squares.data());
    for (std::size_t k = 0; k < 3 * count; ++k) {
        const auto value = [&](std::size_t column) {
            return double{rows[(k / 3 * width + column) * 3 + k % 3]};
        };
        double square = 0;
        for (std::size_t j = 0; j < width; ++j) square += value(j) * value(j);
        ASSERT_NEAR(squares[k], square, 1e-12) << width << ", row " << k / 3;
        for (std::size_t m = 0; m < columns.order; ++m) {
            double cosine = 0, sine = 0;
            for (std::size_t j = 0; j < width; ++j) {
                const double angle = 2 * pi * static_cast<double>(m) *
                                     (static_cast<double>(j) + 0.5) / static_cast<double>(width);
                cosine += value(j) * std::cos(angle);
                sine += value(j) * std::sin(angle);
            }
            ASSERT_NEAR(out[k * columns.all + columns.of(m, false)], cosine, 1e-12) << width;
            ASSERT_NEAR(out[k * columns.all + columns.of(m, true)], sine, 1e-12) << width;
        }
    }
}

TEST(VectorMemory, SpectraStayWithinRowsOfPictures) {
    forEveryTarget([] {
        for (const int order : {1, 2, 5, 9})
            for (const std::size_t count : {1, 2, 3, 5, 8, 9, 17})
                for (const Side side : sides) {
                    for (const std::size_t width : {1, 3, 6, 10, 24, 48})
                        checkRows(FourierPlan(width), order, width, count, side);
                    for (const std::size_t width : {32, 64, 96})
                        checkRows(ShortPlan(order, width), order, width, count, side);
                    if (testing::Test::HasFatalFailure()) return;
                }
    });
}

TEST(VectorMemory, SumsOverColatitudesStayWithinTheirGroup) {
    constexpr std::size_t group = SpectrumColumns::group, stride = 3 * group;
    forEveryTarget([] {
        for (const std::size_t rows : {1, 2, 3, 10, 32})
            for (const bool sine : {false, true})
                for (const Side side : sides) {
                    const std::size_t degrees = (rows + 1) / 2;
                    const FourierPlan plan(rows);
                    const GuardedArray<double> in((rows - 1) * stride + group, side, numberAt);
                    const GuardedArray<double> factors(degrees, side, numberAt);
                    GuardedArray<double> out((degrees - 1) * stride + group, side);
                    colatitudeSums(plan, sine, in.data(), stride, degrees, factors.data(),
                                   out.data());
                    for (std::size_t j = 0; j < degrees; ++j)
                        for (std::size_t i = 0; i < group; ++i) {
                            double sum = 0;
                            for (std::size_t r = 0; r < rows; ++r) {
                                const double angle = pi * static_cast<double>(j) *
                                                     (static_cast<double>(r) + 0.5) /
                                                     static_cast<double>(rows);
                                sum +=
                                    in[r * stride + i] * (sine ? std::sin(angle) : std::cos(angle));
                            }
                            ASSERT_NEAR(out[j * stride + i], factors[j] * sum, 1e-13) << rows;
                        }
                }
    });
}

TEST(VectorMemory, SumsOfPixelsStayWithinARow) {
    forEveryTarget([] {
        for (std::size_t width = 1; width <= 65; ++width)
            for (const Side side : sides) {
                const GuardedArray<float> row(3 * width, side, numberAt);
                double sum = 0;
                for (std::size_t k = 0; k < row.size(); ++k) sum += double{row[k]};
                ASSERT_NEAR(sumPictureRow(row.data(), width), sum, 1e-4) << width;
            }
    });
}

}  // namespace
}  // namespace hshfit
