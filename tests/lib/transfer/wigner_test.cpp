#include <hshfit/error.h>
#include <hshfit/transfer/wigner.h>

#include <random>

#include <gsl/gsl_sf_coupling.h>
#include <gtest/gtest.h>
#include <boost/multiprecision/mpfr.hpp>

namespace hshfit {
namespace {

using Real = boost::multiprecision::number<boost::multiprecision::mpfr_float_backend<3000>,
                                           boost::multiprecision::et_off>;

const Real& factorial(int n) {
    static std::vector<Real> table{1};
    while (static_cast<int>(table.size()) <= n) table.push_back(table.back() * table.size());
    return table[n];
}

/// Racah's sum (DLMF 34.2.4) in 3000 digits.
Real racah(int j1, int j2, int j3, int m1, int m2, int m3) {
    const Real triangle = factorial(j1 + j2 - j3) * factorial(j1 - j2 + j3) *
                          factorial(-j1 + j2 + j3) / factorial(j1 + j2 + j3 + 1);
    const Real root = sqrt(triangle * factorial(j1 + m1) * factorial(j1 - m1) * factorial(j2 + m2) *
                           factorial(j2 - m2) * factorial(j3 + m3) * factorial(j3 - m3));
    Real sum = 0;
    for (int s = 0; s <= j1 + j2 - j3; ++s) {
        const int rest[] = {j1 + j2 - j3 - s, j1 - m1 - s, j2 + m2 - s, j3 - j2 + m1 + s,
                            j3 - j1 - m2 + s};
        if (*std::min_element(std::begin(rest), std::end(rest)) < 0) continue;
        Real term = factorial(s);
        for (const int n : rest) term *= factorial(n);
        sum += (s % 2 == 0 ? 1 : -1) / term;
    }
    return ((j1 - j2 - m3) % 2 == 0 ? 1 : -1) * root * sum;
}

TEST(Wigner, AllSymbolsToEightMatchGsl) {
    for (int l2 = 0; l2 <= 8; ++l2) {
        for (int l3 = 0; l3 <= 8; ++l3) {
            for (int m2 = -l2; m2 <= l2; ++m2) {
                for (int m3 = -l3; m3 <= l3; ++m3) {
                    for (int l1 = 0; l1 <= l2 + l3 + 1; ++l1) {
                        const double exact = gsl_sf_coupling_3j(2 * l1, 2 * l2, 2 * l3,
                                                                2 * (-m2 - m3), 2 * m2, 2 * m3);
                        EXPECT_NEAR(wigner3j(l1, l2, l3, -m2 - m3, m2, m3), exact, 1e-14)
                            << l1 << " " << l2 << " " << l3 << " " << m2 << " " << m3;
                    }
                }
            }
        }
    }
    EXPECT_EQ(wigner3j(2, 2, 2, 1, 1, 1), 0);
    EXPECT_EQ(wigner3j(2, 1, 1, 3, -2, -1), 0);
    WignerFamily family;
    EXPECT_THROW(family.compute(3, 2, 4, 0), UsageError);
    EXPECT_THROW(family.compute(3, 2, 0, -3), UsageError);
}

void expectFamily(int l2, int l3, int m2, int m3, double tolerance, std::mt19937& random) {
    SCOPED_TRACE(testing::Message() << l2 << " " << l3 << " " << m2 << " " << m3);
    WignerFamily family;
    family.compute(l2, l3, m2, m3);
    double largest = 0;
    for (const double value : family.values) largest = std::max(largest, std::abs(value));
    const int last = l2 + l3;
    std::uniform_int_distribution<int> inside(family.first, last);
    for (const int l1 :
         {family.first, std::min(family.first + 1, last), inside(random), inside(random), last}) {
        const Real exact = racah(l1, l2, l3, -m2 - m3, m2, m3);
        const double value = family.values[static_cast<std::size_t>(l1 - family.first)];
        EXPECT_LE(static_cast<double>(abs(exact - value)), tolerance * largest) << l1;
        // The ends of the family, orders of magnitude below its middle, keep their digits.
        if (abs(exact) < 1e-8 && abs(exact) > 1e-290) {
            EXPECT_LE(static_cast<double>(abs(value / exact - 1)), 1e-10) << l1;
        }
    }
}

TEST(Wigner, RandomFamiliesTo1000MatchSumsIn3000Digits) {
    std::mt19937 random(3);
    for (const auto& [most, tolerance] : {std::pair(100, 1e-13), {1000, 1e-12}}) {
        for (int k = 0; k < 30; ++k) {
            const int l2 = std::uniform_int_distribution<int>(0, most)(random);
            const int l3 = std::uniform_int_distribution<int>(0, most)(random);
            const int m2 = std::uniform_int_distribution<int>(-l2, l2)(random);
            const int m3 = std::uniform_int_distribution<int>(-l3, l3)(random);
            expectFamily(l2, l3, m2, m3, tolerance, random);
        }
        // Where terms of the recurrence vanish, and at the ends of m.
        for (const auto& [l2, l3, m2, m3] : {std::array{most, most, 0, 0},
                                             {most, most, 7, 7},
                                             {most, most, 7, -7},
                                             {most, most, most, most},
                                             {most, most, most, -most},
                                             {most, most, 0, most},
                                             {most, most - 1, 0, 0},
                                             {most, 1, most, -1},
                                             {most, 0, 5, 0},
                                             {0, most, 0, 5},
                                             {most, most / 2, most, -most / 2},
                                             {most, most / 2, 0, 0},
                                             {0, 0, 0, 0}}) {
            expectFamily(l2, l3, m2, m3, tolerance, random);
        }
    }
}

}  // namespace
}  // namespace hshfit
