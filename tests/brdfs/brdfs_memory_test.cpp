// Vector code of models, tables and fits on every instruction set, with directions and results that
// end where memory does. Values equal the values of the same pairs evaluated alone, which other
// tests compare to scalar code.

#include <brdfs/catalog.h>
#include <brdfs/fit/column_products.h>
#include <brdfs/fit/parametric_sum.h>
#include <brdfs/measured_files.h>
#include <brdfs/models_grid.h>
#include <brdfs/tensor_writer.h>
#include <guarded_array.h>
#include <vector_targets.h>

#include <cmath>
#include <set>

namespace hshfit::brdfs {
namespace {

using test::forEveryTarget;
using test::GuardedArray;
using test::Side;

constexpr Side sides[] = {Side::front, Side::back};

Direction directionAt(std::size_t k) {
    const auto turn = static_cast<double>(k);
    return directionFromAngles(std::fmod(0.1 + 0.37 * turn, 1.5), 0.9 * turn);
}
double numberAt(std::size_t k) {
    return std::sin(0.3 + 1.7 * static_cast<double>(k));
}

struct Batch {
    GuardedArray<double> x, y, z;
    Batch(std::size_t count, Side side)
        : x(count, side, [](std::size_t k) { return directionAt(k).x; }),
          y(count, side, [](std::size_t k) { return directionAt(k).y; }),
          z(count, side, [](std::size_t k) { return directionAt(k).z; }) {}
    DirectionBatch from(std::size_t first) const {
        return {x.data() + first, y.data() + first, z.data() + first, x.size() - first};
    }
};

void checkValues(const Brdf& brdf, std::size_t count) {
    const std::size_t channels = brdf.channels().count(), last = count - 1;
    const Direction wo = directionFromAngles(0.7, 0.3);
    for (const Side side : sides) {
        const Batch wi(count, side);
        GuardedArray<double> all(channels * count, side), one(channels, side);
        brdf.eval(wo, wi.from(0), all.data());
        brdf.eval(wo, wi.from(last), one.data());
        for (std::size_t c = 0; c < channels; ++c)
            ASSERT_EQ(all[c * count + last], one[c]) << brdf.name() << ", " << count;
    }
}

TEST(VectorMemory, ModelsStayWithinDirectionsAndValues) {
    forEveryTarget([] {
        std::set<std::string> seen;
        for (const Case& row : modelGrid()) {
            if (!seen.insert(row.spec.substr(0, row.spec.find(':'))).second) continue;
            const auto brdf = openModel(row.spec);
            for (std::size_t count = 1; count <= 17; ++count) checkValues(*brdf, count);
        }
        EXPECT_EQ(seen.size(), models().size());
    });
}

TEST(VectorMemory, MeasuredTablesStayWithinDirectionsAndValues) {
    const test::TemporaryFile merl(
        test::merlFile([](int c, int h, int d, int p) { return 1.0 + c + h + d + p; }));
    const test::TemporaryFile rgl(test::tensorFile(test::rglFields({})));
    forEveryTarget([&] {
        for (const std::string& path : {merl.path(), rgl.path()}) {
            const auto brdf = open(path);
            for (std::size_t count = 1; count <= 17; ++count) checkValues(*brdf, count);
            for (const std::size_t count : {63, 64, 65}) checkValues(*brdf, count);
        }
    });
}

TEST(VectorMemory, ColumnsOfFitsStayWithinPairsAndColumns) {
    forEveryTarget([] {
        std::size_t checked = 0;
        for (const Model& model : models()) {
            const ParametricSum sum(model.name, true);
            if (!sum.byFormula(0)) continue;
            ++checked;
            std::vector<double> shapes;
            for (const ShapeParameter& shape : sum.shapes())
                shapes.push_back(0.5 * (shape.free.startLow + shape.free.startHigh));
            const auto columns = sum.formulaColumns(0, shapes, true);
            const std::size_t linears = sum.linears().size(),
                              slopes = shapes.size() * (1 + linears);
            for (std::size_t count = 1; count <= 17; ++count)
                for (const Side side : sides) {
                    const Batch wi(count, side);
                    GuardedArray<Direction> wo(count, side);
                    for (std::size_t k = 0; k < count; ++k)
                        wo[k] = directionFromAngles(0.1 + 0.07 * static_cast<double>(k), 0);
                    GuardedArray<double> base(count, side), linear(linears * count, side),
                        slope(slopes * count, side);
                    columns->fill({.wi = wi.from(0), .wo = wo.data()}, base.data(), linear.data(),
                                  slope.data());
                    const std::size_t last = count - 1;
                    GuardedArray<double> base1(1, side), linear1(linears, side),
                        slope1(slopes, side);
                    columns->fill({.wi = wi.from(last), .wo = wo.data() + last}, base1.data(),
                                  linear1.data(), slope1.data());
                    ASSERT_EQ(base[last], base1[0]) << model.name;
                    for (std::size_t i = 0; i < linears; ++i)
                        ASSERT_EQ(linear[i * count + last], linear1[i]) << model.name;
                    for (std::size_t i = 0; i < slopes; ++i)
                        ASSERT_EQ(slope[i * count + last], slope1[i]) << model.name;
                }
        }
        EXPECT_GT(checked, 10U);
    });
}

TEST(VectorMemory, ProductsOfColumnsStayWithinThem) {
    forEveryTarget([] {
        for (std::size_t length = 1; length <= 17; ++length)
            for (const std::size_t left : {1, 2, 3, 4, 7})
                for (const std::size_t right : {1, 3, 4, 5, 9})
                    for (const Side side : sides) {
                        const GuardedArray<double> a(left * length, side, numberAt);
                        const GuardedArray<double> b(right * length, side, numberAt);
                        GuardedArray<double> out(left * right, side), gram(left * left, side);
                        const ColumnSpan columns{a.data(), left, length};
                        addProducts(columns, {b.data(), right, length}, length, out.data(), left);
                        addGram(columns, length, gram.data(), left);
                        const auto product = [&](const double* x, const double* y) {
                            double sum = 0;
                            for (std::size_t k = 0; k < length; ++k) sum += x[k] * y[k];
                            return sum;
                        };
                        for (std::size_t i = 0; i < left; ++i) {
                            const double* x = a.data() + i * length;
                            for (std::size_t j = 0; j < right; ++j)
                                ASSERT_NEAR(out[i + j * left], product(x, b.data() + j * length),
                                            1e-13);
                            for (std::size_t j = 0; j <= i; ++j)
                                ASSERT_NEAR(gram[i + j * left], product(x, a.data() + j * length),
                                            1e-13);
                        }
                    }
    });
}

}  // namespace
}  // namespace hshfit::brdfs
