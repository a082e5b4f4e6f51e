// Tabulated n and k of named metals: against an independent formula, other measurements and
// published colours, and in place of ior and k of a model.

#include <brdfs/analytic/fresnel.h>
#include <brdfs/catalog.h>
#include <brdfs/catalog/metal_spec.h>
#include <brdfs/presets/metals.h>
#include <hshfit/brdf/internal/cie_1931.h>
#include <hshfit/error.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace hshfit::brdfs {
namespace {

double normalReflectance(std::complex<double> n) {
    return std::norm((n - 1.0) / (n + 1.0));
}

double tabulatedReflectance(const Metal& metal, double nanometres) {
    const MetalRow row = indexAt(metal, nanometres);
    return normalReflectance({row.n, row.k});
}

/// Lorentz-Drude parameters of Rakic et al. 1998 (10.1364/AO.37.005271, table 2), in eV.
struct LorentzDrude {
    std::string_view metal;
    double plasma;
    std::vector<double> strength, width, frequency;  ///< the first is Drude's term
    double agreement;  ///< with the tables from 800 nm on; films of several laboratories differ

    double reflectance(double nanometres) const {
        const double energy = 1239.84193 / nanometres;
        std::complex<double> epsilon = 1;
        for (std::size_t i = 0; i < strength.size(); ++i)
            epsilon +=
                strength[i] * plasma * plasma /
                (frequency[i] * frequency[i] - energy * std::complex<double>(energy, width[i]));
        return normalReflectance(std::sqrt(epsilon));
    }
};
const std::vector<LorentzDrude> formulas{
    {"silver",
     9.01,
     {0.845, 0.065, 0.124, 0.011, 0.840, 5.646},
     {0.048, 3.886, 0.452, 0.065, 0.916, 2.419},
     {0, 0.816, 4.481, 8.185, 9.083, 20.29},
     0.025},
    {"gold",
     9.03,
     {0.760, 0.024, 0.010, 0.071, 0.601, 4.384},
     {0.053, 0.241, 0.345, 0.870, 2.494, 2.214},
     {0, 0.415, 0.830, 2.969, 4.304, 13.32},
     0.02},
    {"copper",
     10.83,
     {0.575, 0.061, 0.104, 0.723, 0.638},
     {0.030, 0.378, 1.056, 3.213, 4.305},
     {0, 0.291, 2.957, 5.300, 11.18},
     0.01},
    {"aluminium",
     14.98,
     {0.523, 0.227, 0.050, 0.166, 0.030},
     {0.047, 0.333, 0.312, 1.351, 3.382},
     {0, 0.162, 1.544, 1.808, 3.473},
     0.01},
    {"chromium",
     10.75,
     {0.168, 0.151, 0.150, 1.149, 0.825},
     {0.047, 3.175, 1.305, 2.676, 1.335},
     {0, 0.121, 0.543, 1.970, 8.775},
     0.07},
    {"nickel",
     15.92,
     {0.096, 0.100, 0.135, 0.106, 0.729},
     {0.048, 4.511, 1.334, 2.178, 6.292},
     {0, 0.174, 0.582, 1.597, 6.089},
     0.06},
    {"titanium",
     7.29,
     {0.148, 0.899, 0.393, 0.187, 0.001},
     {0.082, 2.276, 2.518, 1.663, 1.762},
     {0, 0.777, 1.545, 2.509, 19.43},
     0.04},
};

TEST(Metals, SymbolsNameThem) {
    const std::pair<const char*, const char*> symbols[] = {
        {"Au", "gold"},     {"Ag", "silver"}, {"Cu", "copper"},   {"Al", "aluminium"},
        {"Cr", "chromium"}, {"Ni", "nickel"}, {"Ti", "titanium"}, {"Fe", "iron"}};
    for (const auto& [symbol, name] : symbols) EXPECT_EQ(findMetal(symbol).name, name);
    EXPECT_THROW(findMetal("A"), UsageError);
    EXPECT_THROW(findMetal(""), UsageError);
    const auto bySymbol = open("ggx:alpha=.2,metal=Au"), byName = open("ggx:alpha=.2,metal=gold");
    EXPECT_EQ(bySymbol->name(), byName->name());
}

TEST(Metals, RowsAscendAndAreSmooth) {
    EXPECT_EQ(metals().size(), 8u);
    for (const Metal& metal : metals()) {
        EXPECT_FALSE(metal.source.empty());
        for (std::size_t i = 0; i < metal.rows.size(); ++i) {
            const MetalRow& row = metal.rows[i];
            EXPECT_GT(row.n, 0) << metal.name;
            EXPECT_GT(row.k, 0) << metal.name;
            if (i == 0) continue;
            const MetalRow& before = metal.rows[i - 1];
            EXPECT_GT(row.nanometres, before.nanometres) << metal.name;
            // A misplaced digit of the larger of n and k would be a jump.
            const double ratio = std::hypot(row.n, row.k) / std::hypot(before.n, before.k);
            EXPECT_LT(std::abs(std::log(ratio)), 0.4) << metal.name << " " << row.nanometres;
        }
    }
}

TEST(Metals, ReflectancesAgreeWithTheLorentzDrudeFormula) {
    for (const LorentzDrude& formula : formulas)
        for (double nm = 800; nm <= 1900; nm += 50)
            EXPECT_NEAR(tabulatedReflectance(findMetal(formula.metal), nm), formula.reflectance(nm),
                        formula.agreement)
                << formula.metal << " " << nm;
    // Aluminium's parameters were fitted to this table.
    for (double nm = 250; nm <= 750; nm += 25)
        EXPECT_NEAR(tabulatedReflectance(findMetal("aluminium"), nm), formulas[3].reflectance(nm),
                    0.01);
}

TEST(Metals, IronAgreesWithOtherFilms) {
    // n and k of Querry 1985 (CRDC-CR-85034).
    const double rows[][3] = {{600, 2.328, 3.259},  {800, 2.649, 3.693},  {1000, 2.868, 4.192},
                              {1200, 3.022, 4.699}, {1500, 3.229, 5.522}, {1800, 3.382, 6.342}};
    for (const auto& [nm, n, k] : rows)
        EXPECT_NEAR(tabulatedReflectance(findMetal("iron"), nm), normalReflectance({n, k}), 0.05)
            << nm;
}

/// Linear Rec. 709 under D65 of a spectrum at 380, 385, … 780 nm, by the sums of CIE 15:2004 and
/// the matrix of IEC 61966-2-1.
std::vector<double> rgbOf(const std::function<double(double)>& spectrum) {
    double x = 0, y = 0, z = 0, white = 0;
    for (std::size_t i = 0; i < cie1931.size(); ++i) {
        const CieRow& row = cie1931[i];
        const double light = row.d65 * spectrum(cieFirst + cieStep * static_cast<double>(i));
        x += light * row.x, y += light * row.y, z += light * row.z;
        white += row.d65 * row.y;
    }
    x /= white, y /= white, z /= white;
    return {3.2406 * x - 1.5372 * y - 0.4986 * z, -0.9689 * x + 1.8758 * y + 0.0415 * z,
            0.0557 * x - 0.2040 * y + 1.0570 * z};
}

TEST(Metals, ColoursAreThosePublished) {
    // Reflectances at normal incidence of Akenine-Moller et al., Real-Time Rendering (4th edition,
    // 2018), table 9.2, of films of other laboratories for some.
    const std::pair<const char*, std::vector<double>> published[] = {
        {"gold", {1.022, 0.782, 0.344}},     {"silver", {0.972, 0.960, 0.915}},
        {"copper", {0.955, 0.638, 0.538}},   {"aluminium", {0.913, 0.922, 0.924}},
        {"chromium", {0.549, 0.556, 0.554}}, {"nickel", {0.660, 0.609, 0.526}},
        {"titanium", {0.542, 0.497, 0.449}}, {"iron", {0.562, 0.565, 0.578}}};
    for (const auto& [name, colour] : published) {
        const std::vector<double> rgb = rgbOf(
            [&metal = findMetal(name)](double nm) { return tabulatedReflectance(metal, nm); });
        for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(rgb[c], colour[c], 0.1) << name << c;
    }
}

TEST(MetalSpec, WithoutWavelengthsIsTheColourByTheCieSums) {
    const Direction wi = directionFromAngles(0.9, 0.2), wo = directionFromAngles(0.7, 3.0);
    const double cosine =
        std::cos(std::acos(wi.x * wo.x + wi.y * wo.y + wi.z * wo.z) / 2);  // of the half difference
    for (const char* model : {"ggx:alpha=0.3", "beckmann:alpha=0.3", "gtr:alpha=0.3,gamma=1.5"}) {
        const auto brdf = open(std::string(model) + ",metal=copper");
        EXPECT_EQ(brdf->channels().kind, Channels::Kind::rgb);
        const double facets = evaluate(*open(std::string(model) + ",F0=1"), wi, wo)[0];
        const std::vector<double> expected = rgbOf([&](double nm) {
            const MetalRow row = indexAt(findMetal("copper"), nm);
            return facets * conductorReflectance(cosine, row.n, row.k);
        });
        const std::vector<double> f = evaluate(*brdf, wi, wo);
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(f[c], expected[c], 2e-3 * facets) << model << c;
        EXPECT_GT(f[0], 1.2 * f[2]) << model;
        // The name opens it again.
        EXPECT_EQ(evaluate(*open(brdf->name()), wi, wo), f);
    }
}

TEST(MetalSpec, AtWavelengthsIsTheModelWithTheTabulatedIndex) {
    const Direction wi = directionFromAngles(0.9, 0.2), wo = directionFromAngles(0.7, 3.0);
    const auto brdf = open("cook-torrance:m=0.2,metal=gold,nm=450/548.6/700");
    EXPECT_EQ(brdf->channels().wavelengths, (std::vector<double>{450, 548.6, 700}));
    const std::vector<double> f = evaluate(*brdf, wi, wo);
    EXPECT_EQ(f[1],
              evaluate(*open("cook-torrance:m=0.2,fresnel=conductor,ior=0.43,k=2.455"), wi, wo)[0]);
    EXPECT_EQ(open("ggx:alpha=.2,metal=gold,nm=400:700:100")->channels().count(), 4u);
    // Between the rows at 431 and 451 nm, linear.
    const MetalRow between = indexAt(findMetal("iron"), 441);
    EXPECT_NEAR(between.n, (2.48 + 2.59) / 2, 1e-12);
    EXPECT_NEAR(between.k, (2.71 + 2.77) / 2, 1e-12);
}

TEST(MetalSpec, WrongOnesNameWhatWouldBeRight) {
    const auto refused = [](const std::string& spec, const std::string& part) {
        try {
            open(spec);
            ADD_FAILURE() << spec;
        } catch (const UsageError& error) {
            EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
        }
    };
    refused("ggx:alpha=.2,metal=gild", "gold");
    refused("ward:ax=.2,metal=gold", "cook-torrance");
    refused("ggx:alpha=.2,metal=gold,k=2", "in place of k");
    refused("ggx:alpha=.2,metal=gold,F0=.2", "in place of F0");
    refused("ggx:alpha=.2,metal=gold,fresnel=schlick", "fresnel");
    refused("ggx:alpha=.2,metal=gold,nm=100", "187.9");
    refused("ggx:alpha=.2,metal=gold,nm=2000", "1937");
    refused("ggx:alpha=.2,metal=gold,nm=red", "450/550/650");
    refused("ggx:alpha=.2,metal=gold,nm=700/400", "ascend");
    refused("ggx:alpha=.2,metal=gold,nm=400:700:0", "wavelength");
    refused("ggx:alpha=.2,metal=gold,metal=iron", "twice");
    refused("ggx:alpha=.2,metal=gold,ks=.1/.2/.3", "single values");
    refused("ggx:alpha=.2,metal=", "known");
}

}  // namespace
}  // namespace hshfit::brdfs
