// Change of basis: matrix C against published values, many digits and other quadratures.

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/quadrature/quadrature.h>
#include <hshfit/rotation/basis_change.h>

#include <lib/rotation/random.h>

#include <gtest/gtest.h>
#include <boost/multiprecision/mpfr.hpp>
#include <nlohmann/json.hpp>

#include <fstream>

#include "places.h"

namespace {

using namespace hshfit;
using hshfit::test::Random;

BasisChange changeOf(const std::string& from, int fromOrder, const std::string& to, int toOrder) {
    return {*bases::make(from, fromOrder), *bases::make(to, toOrder)};
}

double at(const BasisChange& change, int l, int k, int m) {
    const std::vector<double> block = change.block(m);
    return block[static_cast<std::size_t>((l - std::abs(m)) * (change.fromOrder() - std::abs(m)) +
                                          k - std::abs(m))];
}

TEST(BasisChange, ShToHshHasTheClosedForms) {
    const BasisChange c = changeOf("sh", 5, "hsh", 5);
    const double s = std::asinh(1.0), r2 = std::sqrt(2.0);
    EXPECT_NEAR(at(c, 0, 0, 0), 1 / r2, 1e-15);
    EXPECT_NEAR(at(c, 0, 1, 0), std::sqrt(6.0) / 4, 1e-15);
    EXPECT_NEAR(at(c, 1, 1, 0), r2 / 4, 1e-15);
    EXPECT_NEAR(at(c, 1, 2, 0), std::sqrt(30.0) / 8, 1e-15);
    EXPECT_NEAR(at(c, 2, 2, 0), r2 / 8, 1e-15);
    EXPECT_NEAR(at(c, 0, 2, 0), 0, 1e-15);
    for (int l = 1; l < 5; ++l)
        for (int k = 0; k < l; ++k) EXPECT_NEAR(at(c, l, k, 0), 0, 1e-15);
    for (const int sign : {1, -1}) {
        EXPECT_NEAR(at(c, 1, 1, sign), 11.0 / 8 - 9 * s / (8 * r2), 1e-15);
        EXPECT_NEAR(at(c, 2, 2, 2 * sign), 7 * r2 / 16, 1e-15);
    }
}

/// The integral of H Y 2 cos(theta): a weight that Eq. 18 does not have.
TEST(BasisChange, PrintedMatrixOfTheHshPaperHasAnotherWeight) {
    const std::string file = hshfit::test::sharedFolder() + "/oracles/basis_values.json";
    if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is absent";
    const auto oracle = nlohmann::json::parse(std::ifstream(file));
    const std::vector<double> c = changeOf("sh", 3, "hsh", 3).dense();
    const auto number = [&](const char* key, int sh, int hsh) {
        return std::stod(oracle[key][sh][hsh].get<std::string>());
    };
    const auto hsh = bases::make("hsh", 3), sh = bases::make("sh", 3);
    double furthest = 0;
    for (int i = 0; i < 9; ++i)
        for (int j = 0; j < 9; ++j) {
            const double ours = c[static_cast<std::size_t>(9 * j + i)];  // row HSH j, column SH i
            EXPECT_NEAR(ours, number("C_eq18_rowsSH_colsHSH", i, j), 1e-15) << i << " " << j;
            double weighted = 0;  // by a rule that shares nothing with the library
            const GaussRule& rule = gaussLegendre(40);
            for (int a = 0; a < 16; ++a)
                for (std::size_t b = 0; b < rule.nodes.size(); ++b) {
                    const double theta = pi / 4 * (1 + rule.nodes[b]);
                    const Direction d = directionFromAngles(theta, 2 * pi * (a + 0.5) / 16);
                    double y[9], h[9];
                    sh->evaluate(d, y);
                    hsh->evaluate(d, h);
                    weighted += rule.weights[b] * pi / 4 * 2 * pi / 16 * y[i] * h[j] *
                                std::sin(theta) * 2 * std::cos(theta);
                }
            const double printed = number("C_printed_weight_2cos_rowsSH_colsHSH", i, j);
            EXPECT_NEAR(weighted, printed, 1e-5) << i << " " << j;
            furthest = std::max(furthest, std::abs(ours - printed));
        }
    EXPECT_GT(furthest, 0.3);  // the printed matrix is no approximation of C
}

using Real = boost::multiprecision::number<
    boost::multiprecision::mpfr_float_backend<50, boost::multiprecision::allocate_stack>>;

/// Nodes u in (0, 1) and weights in 50 digits.
std::vector<std::pair<Real, Real>> rule50(int n) {
    std::vector<std::pair<Real, Real>> result;
    const GaussRule& first = gaussLegendre(n);
    for (int i = 0; i < (n + 1) / 2; ++i) {
        Real x = first.nodes[static_cast<std::size_t>(i)], slope;
        for (int step = 0; step < 3; ++step) {
            Real p = 1, last = 0;
            for (int k = 0; k < n; ++k) {
                const Real next = ((2 * k + 1) * x * p - k * last) / (k + 1);
                last = p;
                p = next;
            }
            slope = n * (last - x * p) / ((1 - x) * (1 + x));
            if (step < 2) x -= p / slope;
        }
        const Real weight = 1 / ((1 - x) * (1 + x) * slope * slope);
        result.emplace_back((1 + x) / 2, weight);
        if (2 * i + 1 < n) result.emplace_back((1 - x) / 2, weight);
    }
    return result;
}

/// T_l^m of HSH or SH at one node for l < order, by the plain recurrence in 50 digits.
std::vector<Real> functions50(bool hemisphere, int m, int order, const Real& u) {
    const Real mu = u * u, x = hemisphere ? 2 * mu - 1 : mu;
    const Real square = (1 - x) * (1 + x);
    Real p = hemisphere ? 1 : sqrt(Real(1) / 2);
    for (int k = 1; k <= m; ++k) p *= sqrt(square * (2 * k + 1) / (2 * k));
    std::vector<Real> result{p};
    Real last = 0, beside = 0;
    for (int l = m + 1; l < order; ++l) {
        const Real b = sqrt(Real(l * l - m * m) / Real(4 * l * l - 1));
        const Real next = (x * p - beside * last) / b;
        last = p, p = next, beside = b;
        result.push_back(p);
    }
    return result;
}

TEST(BasisChange, ShToHshAtOrder1000AgreesWith50Digits) {
    const int order = 1000;
    const BasisChange change = changeOf("sh", order, "hsh", order);
    const auto rule = rule50(2 * order + 60);
    double worst = 0;
    for (const int m : {0, 1, 500}) {
        const std::vector<double> block = change.block(m);
        const int size = order - m;
        // Columns of low, middling and high degree, every row of them that the rule integrates.
        const std::vector<int> columns = {0, 1, size / 3, size - 1};
        std::vector<std::vector<Real>> sums(columns.size(),
                                            std::vector<Real>(static_cast<std::size_t>(size)));
        for (const auto& [u, weight] : rule) {
            const std::vector<Real> h = functions50(true, m, order, u);
            const std::vector<Real> y = functions50(false, m, order, u);
            for (std::size_t c = 0; c < columns.size(); ++c) {
                const Real factor = 2 * u * weight * y[static_cast<std::size_t>(columns[c])];
                for (int row = 0; row < size; row += 7)
                    sums[c][static_cast<std::size_t>(row)] +=
                        factor * h[static_cast<std::size_t>(row)];
            }
        }
        for (std::size_t c = 0; c < columns.size(); ++c)
            for (int row = 0; row < size; row += 7) {
                // Degree 2 (l + l') + 1 in u, and 2 x 52 more for the root of 1 + mu.
                if (2 * (row + columns[c] + 2 * m) + 106 > 2 * static_cast<int>(rule.size()))
                    continue;
                const double error =
                    std::abs(block[static_cast<std::size_t>(row * size + columns[c])] -
                             static_cast<double>(sums[c][static_cast<std::size_t>(row)]));
                worst = std::max(worst, error);
            }
    }
    EXPECT_LT(worst, 2e-13);
}

/// Every pair of the catalog.
class ChangeOfEveryPair
    : public testing::TestWithParam<std::tuple<const bases::Entry*, const bases::Entry*>> {};

std::vector<const bases::Entry*> rows() {
    std::vector<const bases::Entry*> result;
    for (const bases::Entry& entry : bases::catalog()) result.push_back(&entry);
    return result;
}

std::string nameOf(
    const testing::TestParamInfo<std::tuple<const bases::Entry*, const bases::Entry*>>& info) {
    std::string name = std::string(std::get<0>(info.param)->name) + "_to_" +
                       std::string(std::get<1>(info.param)->name);
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}

/// <a_l, b_k> for one m over the hemisphere, in mu = sin^4(t): other nodes than the library's.
double product(const Basis& a, int l, const Basis& b, int k, int m, bool projected) {
    const GaussRule& rule = gaussLegendre(120);
    std::vector<Elevation<double>> points;
    for (const double x : rule.nodes) {
        const double t = pi / 4 * (1 + x), s = std::sin(t) * std::sin(t), c = std::cos(t);
        points.push_back({s * s, c * c * (1 + s)});
    }
    std::vector<double> left(points.size() * static_cast<std::size_t>(a.order() - m));
    std::vector<double> right(points.size() * static_cast<std::size_t>(b.order() - m));
    a.theta(m, points, left.data());
    b.theta(m, points, right.data());
    double sum = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double t = pi / 4 * (1 + rule.nodes[i]), s = std::sin(t);
        sum += rule.weights[i] * pi / 4 * 4 * s * s * s * std::cos(t) *
               left[static_cast<std::size_t>(l - m) * points.size() + i] *
               right[static_cast<std::size_t>(k - m) * points.size() + i] *
               (projected ? points[i].mu : 1);
    }
    return sum;
}

TEST_P(ChangeOfEveryPair, EntriesAreInnerProductsOverTheHemisphere) {
    const auto [fromRow, toRow] = GetParam();
    const auto from = fromRow->make(std::min(7, fromRow->maxOrder), {});
    const auto to = toRow->make(std::min(6, toRow->maxOrder), {.condonShortley = true});
    const BasisChange change(*from, *to);
    const bool projected = to->inner() == Basis::Inner::projectedSolidAngle;
    for (int m = 0; m < std::min(from->order(), to->order()); ++m) {
        const std::vector<double> block = change.block(-m);
        const auto columns = static_cast<std::size_t>(from->order() - m);
        ASSERT_EQ(block.size(), columns * static_cast<std::size_t>(to->order() - m));
        const double sign = m % 2 == 0 ? 1 : -1;
        for (int k = m; k < from->order(); ++k)
            for (int l = m; l < to->order(); ++l) {
                const double expected = sign * product(*to, l, *from, k, m, projected);
                double found = 0;
                if (toRow->orthonormal) {
                    found = block[static_cast<std::size_t>(l - m) * columns +
                                  static_cast<std::size_t>(k - m)];
                } else {
                    // The normal equations of the least-squares fit: G C has the moments.
                    for (int i = m; i < to->order(); ++i)
                        found += product(*to, l, *to, i, m, projected) *
                                 block[static_cast<std::size_t>(i - m) * columns +
                                       static_cast<std::size_t>(k - m)];
                }
                EXPECT_NEAR(found, expected, toRow->orthonormal ? 1e-13 : 1e-11)
                    << l << " " << k << " " << m;
            }
    }
}

TEST_P(ChangeOfEveryPair, VectorsAreMultipliedByTheMatrix) {
    const auto [fromRow, toRow] = GetParam();
    const auto from = fromRow->make(std::min(4, fromRow->maxOrder), {});
    const auto to = toRow->make(std::min(6, toRow->maxOrder), {});
    const BasisChange change(*from, *to);
    const std::vector<double> c = change.dense();
    const auto n = static_cast<std::size_t>(from->slots()),
               rows = static_cast<std::size_t>(to->slots());
    Random random(3);
    const std::vector<double> in = random.vector(2 * n), back = random.vector(2 * rows);
    std::vector<double> out(2 * rows), out2(2 * n);
    change.apply(2, in.data(), out.data());
    change.applyTransposed(2, back.data(), out2.data());
    for (std::size_t v = 0; v < 2; ++v) {
        for (std::size_t i = 0; i < rows; ++i) {
            double sum = 0;
            for (std::size_t j = 0; j < n; ++j) sum += c[i * n + j] * in[v * n + j];
            EXPECT_NEAR(out[v * rows + i], sum, 1e-13);
        }
        for (std::size_t j = 0; j < n; ++j) {
            double sum = 0;
            for (std::size_t i = 0; i < rows; ++i) sum += c[i * n + j] * back[v * rows + i];
            EXPECT_NEAR(out2[v * n + j], sum, 1e-12);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Catalog, ChangeOfEveryPair,
                         testing::Combine(testing::ValuesIn(rows()), testing::ValuesIn(rows())),
                         nameOf);

TEST(BasisChange, EveryRuleIsExactAtHighOrders) {
    // Entries of kept blocks, and vectors through the nodes, by a rule of three times the nodes.
    for (const auto& [from, to] :
         {std::pair("sh", "zernike"), std::pair("zernike", "hsh"), std::pair("makhotkin", "esh"),
          std::pair("hsh", "makhotkin-flux"), std::pair("esh", "sh")}) {
        const auto a = bases::make(from, 301), b = bases::make(to, 300);
        const BasisChange change(*a, *b);
        const bool projected = b->inner() == Basis::Inner::projectedSolidAngle;
        const GaussRule& rule = gaussLegendre(1800);
        std::vector<Elevation<double>> points;
        for (const double x : rule.nodes)
            points.push_back({(1 + x) * (1 + x) / 4, (1 - x) / 2 * (3 + x) / 2});
        Random random(11);
        const std::vector<double> c = random.vector(301 * 301);
        std::vector<double> changed(300 * 300);
        change.apply(1, c.data(), changed.data());
        for (const int m : {0, 1, 2, 90, 251}) {
            std::vector<double> left(points.size() * static_cast<std::size_t>(300 - m));
            std::vector<double> right(points.size() * static_cast<std::size_t>(301 - m));
            b->theta(m, points, left.data());
            a->theta(m, points, right.data());
            std::vector<double> f(points.size(), 0.0);
            for (int k = m; k < 301; ++k)
                for (std::size_t i = 0; i < points.size(); ++i)
                    f[i] += c[static_cast<std::size_t>(slotOf(k, -m))] *
                            right[static_cast<std::size_t>(k - m) * points.size() + i];
            const std::vector<double> block = change.block(m);
            double worst = 0;
            for (int l = m; l < 300; l += 7) {
                double moment = 0, entry = 0;
                for (std::size_t i = 0; i < points.size(); ++i) {
                    const double value = rule.weights[i] * (1 + rule.nodes[i]) / 2 *
                                         (projected ? points[i].mu : 1) *
                                         left[static_cast<std::size_t>(l - m) * points.size() + i];
                    moment += value * f[i];
                    entry += value * right[static_cast<std::size_t>(300 - m) * points.size() + i];
                }
                worst = std::max(
                    {worst,
                     std::abs(moment - changed[static_cast<std::size_t>(slotOf(l, -m))]) / 10,
                     std::abs(entry -
                              block[static_cast<std::size_t>((l - m + 1) * (301 - m) - 1)])});
            }
            EXPECT_LT(worst, 1e-13) << from << " " << to << " " << m;
        }
    }
}

/// The recurrence of docs/explanation/rotation.md over the degree of the SH, from the first column.
double errorOfRecurrence(const BasisChange& c, int m, int order) {
    const int size = c.toOrder() - m;
    const auto beside = [m](int l) {
        return l == m ? 0 : std::sqrt((double(l) * l - double(m) * m) / (4.0 * l * l - 1));
    };
    const std::vector<double> block = c.block(m);
    const auto exact = [&](int l, int k) {
        return block[static_cast<std::size_t>((l - m) * (c.fromOrder() - m) + k - m)];
    };
    std::vector<double> now, last(static_cast<std::size_t>(size), 0.0);
    for (int l = m; l < c.toOrder(); ++l) now.push_back(exact(l, m));
    double worst = 0;
    for (int k = m; k + 1 < order; ++k) {
        std::vector<double> next(now.size());
        for (int l = m; l + 1 < c.toOrder() - (k - m); ++l) {
            const auto i = static_cast<std::size_t>(l - m);
            const double below = l > m ? beside(l) * now[i - 1] : 0;
            next[i] = ((beside(l + 1) * now[i + 1] + below + now[i]) / 2 - beside(k) * last[i]) /
                      beside(k + 1);
            if (l < order) worst = std::max(worst, std::abs(next[i] - exact(l, k + 1)));
        }
        last = now;
        now = next;
    }
    return worst;
}

TEST(BasisChange, RecurrenceOverTheDegreeOfShIsStableForSmallOrdersAlone) {
    const BasisChange c = changeOf("sh", 100, "hsh", 200);
    EXPECT_LT(errorOfRecurrence(c, 0, 100), 1e-12);
    EXPECT_LT(errorOfRecurrence(c, 1, 100), 1e-12);
    EXPECT_GT(errorOfRecurrence(c, 10, 100), 1e-9);
    EXPECT_GT(errorOfRecurrence(c, 20, 100), 1e-5);
}

TEST(BasisChange, TransposeLeadsBackAndTheInverseWouldNot) {
    const BasisChange forth = changeOf("sh", 8, "hsh", 8), back = changeOf("hsh", 8, "sh", 8);
    const std::vector<double> c = forth.dense(), b = back.dense();
    for (std::size_t i = 0; i < 64; ++i)
        for (std::size_t j = 0; j < 64; ++j) EXPECT_NEAR(c[64 * i + j], b[64 * j + i], 1e-15);
    // C^T C of the constant on the hemisphere is not the constant: SH of order 8 ring at the
    // horizon.
    std::vector<double> one(64, 0.0), there(64), again(64);
    one[0] = 1;
    back.apply(1, one.data(), there.data());
    forth.apply(1, there.data(), again.data());
    EXPECT_LT(again[0], 0.98);
    EXPECT_GT(again[0], 0.9);
}

TEST(BasisChange, IsTheIdentityOnEveryOrthonormalBasis) {
    for (const bases::Entry& entry : bases::catalog()) {
        if (!entry.orthonormal || entry.name == "sh") continue;
        const int order = std::min(9, entry.maxOrder);
        const auto basis = entry.make(order, {});
        const BasisChange change(*basis, *basis);
        for (int m = 0; m < order; ++m)
            for (int l = m; l < order; ++l)
                for (int k = m; k < order; ++k)
                    EXPECT_NEAR(at(change, l, k, m), l == k && basis->has(l, m) ? 1 : 0, 3e-14)
                        << entry.name << " " << l << " " << k << " " << m;
    }
}

TEST(BasisChange, RefusesMatricesTooLargeToPrint) {
    EXPECT_THROW(changeOf("sh", 120, "hsh", 120).dense(), UsageError);
}

}  // namespace
