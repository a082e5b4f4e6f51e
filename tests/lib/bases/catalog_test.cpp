#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>

#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

namespace hshfit {
namespace {

const std::vector<Direction> directions = {
    {0, 0, 1},  directionFromAngles(1e-12, 2), directionFromAngles(0.4, -2.7),
    {0, -1, 0}, directionFromAngles(1.2, 0.5), directionFromAngles(radians(89.99), 3.1),
};

std::vector<double> valuesAt(const Basis& basis, const Direction& d) {
    std::vector<double> values(static_cast<std::size_t>(basis.slots()));
    basis.evaluate(d, values.data());
    return values;
}

TEST(BasisCatalog, RowsMakeWhatTheySay) {
    std::set<std::string_view> names;
    for (const bases::Entry& entry : bases::catalog()) {
        EXPECT_TRUE(names.insert(entry.name).second) << entry.name;
        EXPECT_FALSE(entry.help.empty());
        EXPECT_FALSE(entry.source.empty());
        EXPECT_EQ(bases::find(entry.name).name, entry.name);
        const auto basis = bases::make(entry.name, 2);
        EXPECT_EQ(basis->name(), entry.name);
        EXPECT_EQ(basis->order(), 2);
        EXPECT_THROW(bases::make(entry.name, 0), UsageError);
        EXPECT_THROW(bases::make(entry.name, entry.maxOrder + 1), UsageError);
    }
}

TEST(BasisCatalog, UnknownNameListsTheKnownOnes) {
    try {
        bases::find("hsg");
        FAIL();
    } catch (const UsageError& error) {
        for (const bases::Entry& entry : bases::catalog())
            EXPECT_NE(std::string(error.what()).find(entry.name), std::string::npos);
    }
}

TEST(BasisCatalog, SelectsByList) {
    EXPECT_EQ(bases::select("all").size(), bases::catalog().size());
    const auto rows = bases::select("esh,hsh,esh");
    ASSERT_EQ(rows.size(), 2u);
    EXPECT_EQ(rows[0]->name, "esh");
    EXPECT_EQ(rows[1]->name, "hsh");
    EXPECT_THROW(bases::select("hsh,"), UsageError);
    EXPECT_THROW(bases::select(""), UsageError);
}

TEST(BasisCatalog, CountsFunctions) {
    for (const bases::Entry& entry : bases::catalog()) {
        const int top = std::min(40, entry.maxOrder);
        const auto basis = entry.make(top, {});
        for (int n = 1; n <= top; ++n) {
            int expected = n * n;
            if (entry.name == "esh" || entry.name == "zernike") expected = n * (n + 1) / 2;
            if (entry.name == "h-basis") expected = n == 3 ? 6 : n * n;
            EXPECT_EQ(basis->functionCount(n), expected) << entry.name << " order " << n;
        }
    }
}

TEST(BasisCatalog, LowerOrdersArePrefixesWhereARowSaysSo) {
    for (const bases::Entry& entry : bases::catalog()) {
        const auto small = entry.make(std::min(5, entry.maxOrder - 1), {});
        const auto large = entry.make(std::min(7, entry.maxOrder), {});
        double change = 0;
        for (const Direction& d : directions) {
            const auto a = valuesAt(*small, d), b = valuesAt(*large, d);
            for (std::size_t i = 0; i < a.size(); ++i) {
                change = std::max(change, std::abs(a[i] - b[i]));
            }
        }
        // Inner products with the same functions: the same coefficients.
        EXPECT_EQ(entry.nested, entry.orthonormal && change < 1e-13) << entry.name << change;
    }
}

TEST(BasisCatalog, CurvesDifferInColourAndInGrey) {
    std::set<std::string> colours;
    std::set<std::pair<int, int>> strokes;
    for (const bases::Entry& entry : bases::catalog()) {
        colours.insert(entry.style.colour);
        strokes.insert({entry.style.dash, entry.style.mark});
    }
    EXPECT_EQ(colours.size(), bases::catalog().size());
    EXPECT_EQ(strokes.size(), bases::catalog().size());
}

TEST(BasisCatalog, FunctionsItLacksAreZero) {
    for (const bases::Entry& entry : bases::catalog()) {
        const auto basis = entry.make(std::min(9, entry.maxOrder), {});
        for (const Direction& d : directions) {
            const auto values = valuesAt(*basis, d);
            for (int l = 0; l < basis->order(); ++l)
                for (int m = -l; m <= l; ++m)
                    EXPECT_TRUE(basis->has(l, m) || values[slotOf(l, m)] == 0) << entry.name;
        }
    }
}

TEST(BasisCatalog, CondonShortleyTurnsOddAzimuthsOnly) {
    for (const bases::Entry& entry : bases::catalog()) {
        const int order = std::min(6, entry.maxOrder);
        const auto plain = entry.make(order, {});
        const auto phased = entry.make(order, {.condonShortley = true});
        EXPECT_TRUE(phased->condonShortley());
        for (const Direction& d : directions) {
            const auto a = valuesAt(*plain, d), b = valuesAt(*phased, d);
            for (int l = 0; l < order; ++l)
                for (int m = -l; m <= l; ++m)
                    EXPECT_EQ(b[slotOf(l, m)], (m % 2 ? -1 : 1) * a[slotOf(l, m)]);
        }
    }
}

TEST(BasisCatalog, SignsOfTheFirstFunctions) {
    const Direction d = directionFromAngles(0.5, 0.3);  // x, y > 0
    for (const bases::Entry& entry : bases::catalog()) {
        const auto values = valuesAt(*entry.make(2, {}), d);
        EXPECT_GT(values[slotOf(1, 1)], 0) << entry.name;   // like x
        EXPECT_GT(values[slotOf(1, -1)], 0) << entry.name;  // like y
    }
}

TEST(BasisCatalog, BatchEqualsSingleDirections) {
    std::vector<double> x, y, z;
    for (int k = 0; k < 150; ++k) {
        const Direction d = directions[static_cast<std::size_t>(k * k % 6)];
        x.push_back(d.x), y.push_back(d.y), z.push_back(d.z);
    }
    for (const bases::Entry& entry : bases::catalog()) {
        const auto basis = entry.make(std::min(12, entry.maxOrder), {});
        const auto slots = static_cast<std::size_t>(basis->slots());
        std::vector<double> batch(x.size() * slots);
        basis->evaluate(DirectionBatch{x.data(), y.data(), z.data(), x.size()}, batch.data());
        for (std::size_t k = 0; k < x.size(); ++k) {
            const auto single = valuesAt(*basis, {x[k], y[k], z[k]});
            for (std::size_t i = 0; i < slots; ++i) ASSERT_EQ(batch[k * slots + i], single[i]);
        }
    }
}

TEST(BasisCatalog, ThetaTimesAzimuthIsTheFunction) {
    const Direction d = directionFromAngles(0.9, 2.4);
    const Elevation<double> e = elevationOf(d);
    for (const bases::Entry& entry : bases::catalog()) {
        const int order = std::min(12, entry.maxOrder);
        const auto basis = entry.make(order, {.condonShortley = true});
        const auto values = valuesAt(*basis, d);
        std::vector<double> azimuths(static_cast<std::size_t>(2 * order - 1));
        azimuthParts(d, order, true, azimuths.data());
        for (int m = 1 - order; m < order; ++m) {
            const double expected = m == 0  ? 1 / std::sqrt(2 * pi)
                                    : m > 0 ? std::cos(m * 2.4) / std::sqrt(pi)
                                            : std::sin(-m * 2.4) / std::sqrt(pi);
            EXPECT_NEAR(azimuths[order - 1 + m], azimuthSign(m, true) * expected, 1e-14);
            std::vector<double> parts(static_cast<std::size_t>(order - std::abs(m)));
            basis->theta(std::abs(m), {&e, 1}, parts.data());
            for (int l = std::abs(m); l < order; ++l)
                EXPECT_NEAR(values[slotOf(l, m)], parts[l - std::abs(m)] * azimuths[order - 1 + m],
                            1e-14);
        }
    }
}

// SH and ESH are functions on the whole sphere; the others end at the horizon.
TEST(BasisCatalog, BelowTheHorizon) {
    const Direction above = directionFromAngles(1.1, 0.7), below{above.x, above.y, -above.z};
    for (const bases::Entry& entry : bases::catalog()) {
        const auto basis = entry.make(std::min(8, entry.maxOrder), {});
        const bool sphere = entry.name == "sh" || entry.name == "esh" || entry.name == "lsosh";
        const auto up = valuesAt(*basis, above), down = valuesAt(*basis, below);
        for (int l = 0; l < basis->order(); ++l)
            for (int m = -l; m <= l; ++m) {
                const double parity = (l + m) % 2 ? -1 : 1;
                EXPECT_NEAR(down[slotOf(l, m)], sphere ? parity * up[slotOf(l, m)] : 0, 1e-14)
                    << entry.name;
            }
    }
}

}  // namespace
}  // namespace hshfit
