// The page of a comparison: its numbers against formulas, its files, and what it does where they
// cannot be written.

#include <hshfit/error.h>
#include <hshfit/files/checksum.h>
#include <hshfit/pages/internal/comparison_files.h>
#include <hshfit/pages/page_figures.h>

#include "lib/coefficient_files/coefficient_samples.h"
#include "lib/formula_brdf.h"
#include "places.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <regex>
#include <set>
#include <sstream>

#include <sys/stat.h>

using namespace hshfit;
using samples::contentOf;
using samples::Folder;
using test::FormulaBrdf;
using Json = nlohmann::json;

namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// The reference: a reciprocal lobe about the normal on a diffuse ground.
double lobe(const Direction& wi, const Direction& wo) {
    const double x = wi.x + wo.x, y = wi.y + wo.y, z = wi.z + wo.z;
    return 0.1 + std::pow(std::max(0.0, z / std::sqrt(x * x + y * y + z * z)), 20);
}

FormulaBrdf reference() {
    return FormulaBrdf(lobe, {}, {.isotropic = true, .mirrorSymmetric = true});
}
FormulaBrdf scaled(double factor, Laws laws = {.isotropic = true, .mirrorSymmetric = true}) {
    return FormulaBrdf(
        [factor](const Direction& wi, const Direction& wo) { return factor * lobe(wi, wo); }, {},
        laws);
}

/// Few directions and pixels: what is tested is not the accuracy of metrics.
ComparisonOptions small() {
    return {.outgoing = OutgoingSet::elevations(2), .sphere = {.size = 32, .samples = 1}};
}

std::set<std::string> entries(const std::string& folder) {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        names.insert(entry.path().filename());
    }
    return names;
}

TEST(Pages, OptionsOfCommandsKeepTheirHyphens) {
    EXPECT_EQ(commandMarkup("hshfit project 'a<b' --form basis -o x--y.json --force"),
              "hshfit project &apos;a&lt;b&apos; <span class=\"option\">--form</span> basis -o "
              "x--y.json <span class=\"option\">--force</span>");
}

TEST(Comparison, CurvesAndMapsAreTheFormulas) {
    const Comparison c = makeComparison(reference(), scaled(1.5), small());
    ASSERT_EQ(c.polar.size(), 4u);
    ASSERT_EQ(c.half.size(), 5u);
    ASSERT_EQ(c.residuals.size(), 1u);
    const double slices[] = {10, 30, 50, 70};
    for (std::size_t s = 0; s < 4; ++s) {
        const ComparisonCurve& curve = c.polar[s];
        EXPECT_EQ(curve.slice, slices[s]);
        bool mirror = false;
        for (std::size_t i = 0; i < curve.angles.size(); ++i) {
            // The half vector lies halfway in the plane, wo at -theta_o.
            const double half = radians((curve.angles[i] - curve.slice) / 2);
            ASSERT_NEAR(curve.reference[0][i], 0.1 + std::pow(std::cos(half), 20), 1e-12);
            ASSERT_NEAR(curve.approximation[0][i], 1.5 * curve.reference[0][i], 1e-12);
            mirror = mirror || curve.angles[i] == curve.slice;
        }
        EXPECT_TRUE(mirror) << "the mirror direction is drawn";
    }
    for (const ComparisonCurve& curve : c.half) {
        for (std::size_t i = 0; i < curve.angles.size(); ++i) {
            const double cosine = std::cos(radians(curve.angles[i]));
            ASSERT_NEAR(curve.reference[0][i], 0.1 + std::pow(cosine, 20), 1e-9);
        }
    }
    for (const double ratio : c.residuals[0].logRatio) ASSERT_NEAR(ratio, std::log10(1.5), 1e-9);
    EXPECT_NEAR(residualShares(c).median, std::log10(1.5), 1e-9);
    EXPECT_EQ(residualShares(c).withinTenth, 0);
    EXPECT_EQ(residualShares(c).withinTwofold, 1);
    for (std::size_t i = 0; i < c.albedo[0].angles.size(); ++i) {
        ASSERT_NEAR(c.albedo[0].approximation[0][i], 1.5 * c.albedo[0].reference[0][i], 1e-9);
    }
}

TEST(Comparison, EqualBrdfsDoNotDiffer) {
    const Comparison c = makeComparison(reference(), reference(), small());
    const Json json = Json::parse(comparisonJson(c));
    EXPECT_EQ(json["spheres"]["difference_mean_square"], 0);
    EXPECT_GT(json["spheres"]["reference_mean_square"], 0);
    EXPECT_EQ(json["spheres"]["amplification"], 1);
    EXPECT_EQ(json["residual"]["median_ratio"], 1);
    EXPECT_EQ(json["residual"]["within_10_percent"], 1);
}

TEST(Comparison, AnisotropyAddsASecondAzimuth) {
    const auto g = scaled(1.0, {.mirrorSymmetric = true});
    const Comparison c = makeComparison(reference(), g, {.outgoing = OutgoingSet::parabolic(4, 4)});
    ASSERT_EQ(c.residuals.size(), 2u);
    EXPECT_EQ(c.residuals[1].azimuth, 90);
    EXPECT_EQ(c.polar.size(), 8u);
    std::vector<std::string> files;
    for (const auto& figure : figuresOf(c)) files.push_back(figure.file);
    EXPECT_EQ(files, (std::vector<std::string>{"polar-0.svg", "half-0.svg", "residual-0.svg",
                                               "polar-90.svg", "half-90.svg", "residual-90.svg"}));
}

TEST(Comparison, OneDirectionIsDrawnAlone) {
    ComparisonOptions options = small();
    options.outgoing = OutgoingSet::direction(radians(52.3), radians(40));
    const Comparison c = makeComparison(reference(), scaled(1), options);
    ASSERT_EQ(c.polar.size(), 1u);
    EXPECT_EQ(c.polar[0].slice, 52.3);
    EXPECT_EQ(c.polar[0].azimuth, 40);
    const auto& angles = c.polar[0].angles;
    EXPECT_EQ(std::count(angles.begin(), angles.end(), 52.3), 1);
    EXPECT_TRUE(std::is_sorted(angles.begin(), angles.end()));
}

TEST(Comparison, ChannelsHaveToAgreeUnlessGrey) {
    const auto f = [](const Direction&, const Direction&) { return 0.1; };
    const FormulaBrdf two(f, {}, {.isotropic = true}, Channels::spectral({500, 600})),
        others(f, {}, {.isotropic = true}, Channels::spectral({500, 601}));
    EXPECT_THROW(makeComparison(two, others, small()), UsageError);
    const Comparison c = makeComparison(reference(), two, small());
    EXPECT_EQ(c.drawn, (std::vector<std::size_t>{0, 1}));
    // Grey holds for both wavelengths; the second of the other is half of the first.
    EXPECT_EQ(c.half[0].reference[0], c.half[0].reference[1]);
    EXPECT_EQ(c.half[0].approximation[0][3], 2 * c.half[0].approximation[1][3]);
}

class ComparisonFiles : public testing::Test {
protected:
    void SetUp() override {
        if (!hshfit::test::hasGnuplot()) GTEST_SKIP() << hshfit::test::noGnuplot;
    }
    const Folder folder;
};

TEST_F(ComparisonFiles, ThePageHoldsEveryFigureAndNamesEveryFile) {
    const auto names = writeComparison(reference(), scaled(1.2), small(), folder / "a");
    EXPECT_EQ(std::set(names.begin(), names.end()), entries(folder / "a")) << "and nothing else";
    const std::string page = contentOf(folder / "a/comparison.html");
    for (const auto& name : names) {
        EXPECT_GT(contentOf(folder / "a/" + name).size(), 500u) << name;
        if (name == "comparison.html") continue;
        EXPECT_NE(page.find("href=\"" + name + "\""), std::string::npos) << name;
    }
    EXPECT_EQ(page.find("{{"), std::string::npos) << "a field was not filled in";
    const auto count = [&](const std::string& pattern) {
        const std::regex figure(pattern);
        return std::distance(std::sregex_iterator(page.begin(), page.end(), figure), {});
    };
    // For narrow screens: two columns of polar plots, three of half angles, map and albedos.
    EXPECT_EQ(count("<svg class=\"whole\" role=\"img\""), 3);
    EXPECT_EQ(count("<svg class=\"part\""), 2 + 3 + 2);
    for (const int figure : {1, 2, 3}) {
        const std::string group = "f" + std::to_string(figure) + "-whole";
        EXPECT_EQ(count("<g id=\"" + group + "\" class=\"columns\">"), 1);
        EXPECT_EQ(count("<use href=\"#" + group + "\"/>"), figure == 2 ? 3 : 2);
    }
    EXPECT_NE(page.find(base64(contentOf(folder / "a/spheres.png"))), std::string::npos);
    // Nothing is fetched.
    EXPECT_FALSE(std::regex_search(page, std::regex(R"re((src|href)\s*=\s*["'](https?:|//))re")));
    for (const auto& metric : metricCatalog()) {
        EXPECT_NE(page.find(">" + std::string(metric.name) + "</th>"), std::string::npos);
    }
}

TEST_F(ComparisonFiles, TheSameBytesWhateverTheThreads) {
    for (const int threads : {1, 4}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        writeComparison(reference(), scaled(1.2), small(), folder / std::to_string(threads));
    }
    for (const auto& name : entries(folder / "1")) {
        EXPECT_TRUE(contentOf(folder / "1/" + name) == contentOf(folder / "4/" + name)) << name;
    }
}

TEST_F(ComparisonFiles, TheScriptStandsAlone) {
    writeComparison(reference(), scaled(1.2), small(), folder / "a");
    const std::string svg = contentOf(folder / "a/polar-0.svg");
    std::filesystem::remove(folder / "a/polar-0.svg");
    ASSERT_EQ(std::system(("cd '" + (folder / "a") + "' && gnuplot comparison.gp").c_str()), 0);
    EXPECT_TRUE(contentOf(folder / "a/polar-0.svg") == svg);
}

TEST_F(ComparisonFiles, ZeroNegativeAndNotFiniteValuesAreDrawn) {
    const Laws laws{.isotropic = true};
    const FormulaBrdf zero([](const Direction&, const Direction&) { return 0.0; }, {}, laws);
    const FormulaBrdf negative([](const Direction&, const Direction&) { return -0.1; }, {}, laws);
    const FormulaBrdf broken(
        [](const Direction& wi, const Direction&) {
            return wi.z < 0.5 ? none : wi.z < 0.6 ? HUGE_VAL : 1e-305;
        },
        {}, laws);
    const FormulaBrdf unmeasured(lobe, [](const Direction&, const Direction&) { return false; });
    const FormulaBrdf good = reference();
    const std::pair<const Brdf*, const Brdf*> pairs[] = {
        {&zero, &good},     {&good, &zero},       {&good, &negative},
        {&broken, &broken}, {&unmeasured, &good}, {&negative, &broken}};
    for (const auto& [f, g] : pairs) {
        const auto names = writeComparison(*f, *g, small(), folder / "a");
        EXPECT_EQ(entries(folder / "a").size(), names.size());
    }
    const Comparison c = makeComparison(unmeasured, zero, small());
    EXPECT_EQ(residualShares(c).cells, 0u);
    EXPECT_TRUE(Json::parse(comparisonJson(c))["residual"]["median_ratio"].is_null());
    EXPECT_EQ(residualShares(makeComparison(zero, reference(), small())).noRatio, 90u * 90);
}

// f is 1, and 0 where theta_i is between 30 and 50 degrees: every point of the curve is on the ring
// of 1, which is the outermost one, and none in the centre.
TEST_F(ComparisonFiles, ZerosLeaveGapsInPolarPlots) {
    const FormulaBrdf holes(
        [](const Direction& wi, const Direction&) {
            const double theta = degrees(polarAngle(wi));
            return theta > 30 && theta < 50 ? 0.0 : 1.0;
        },
        {}, {.isotropic = true});
    writeComparison(holes, holes, small(), folder / "a");
    const std::string svg = contentOf(folder / "a/polar-0.svg");
    // The reference has the broad lines. Panels are 550 wide and 300 high, the first centre is at
    // (275, 288.39), the radius 253 / 1.12 (comparison.gp).
    static const std::regex curve(
        "stroke-width=\"5.00\"[^>]*>\\s*<path stroke='(?!rgb\\(200)[^>]*d='([^']*)'");
    static const std::regex point(R"(([\d.]+),([\d.]+))");
    std::size_t points = 0;
    for (std::sregex_iterator i(svg.begin(), svg.end(), curve), end; i != end; ++i) {
        const std::string path = (*i)[1];
        for (std::sregex_iterator p(path.begin(), path.end(), point); p != end; ++p, ++points) {
            const double x = std::stod((*p)[1]), y = std::stod((*p)[2]);
            const double right = x - (x < 550 ? 275 : 825);
            const double up = 288.39 + 300 * std::floor(y / 300.0) - y;
            ASSERT_NEAR(std::hypot(right, up), 253 / 1.12, 1) << x << ' ' << y;
        }
    }
    EXPECT_GT(points, 8u * 2 * 60);
}

TEST(Comparison, NamesOnThePageHaveFourDigits) {
    const FormulaBrdf a = scaled(1), b = scaled(2);
    Comparison c = makeComparison(a, b, small());
    c.reference.name = "folder/some.binary";
    c.approximation.name = "ggx:alpha=0.23367945978884277,F0=0.5,ks=1e-05";
    c.metrics.front().value.reset();
    c.metrics.front().reason = "lambert:kd=0.12345678901234567 grows";
    const std::string page = comparisonPage(c, {}, "", "");
    EXPECT_EQ(page.find("0.23367945978884277"), page.npos);
    EXPECT_NE(page.find("<code>ggx:alpha=0.2337,F0=0.5,ks=1e-05</code>"), page.npos);
    EXPECT_NE(page.find("<code>folder/some.binary</code>"), page.npos);
    EXPECT_NE(page.find("lambert:kd=0.1235 grows"), page.npos);
}

TEST_F(ComparisonFiles, NamesAreText) {
    class Named : public FormulaBrdf {
    public:
        using FormulaBrdf::FormulaBrdf;
        std::string name() const override { return "<script>'`touch pwned`\n{{x}}\"&"; }
    };
    writeComparison(Named(lobe), scaled(1.2), small(), folder / "a");
    const std::string page = contentOf(folder / "a/comparison.html");
    EXPECT_EQ(page.find("<script"), std::string::npos);
    EXPECT_NE(page.find("&lt;script&gt;"), std::string::npos);
    EXPECT_FALSE(std::filesystem::exists(folder / "a/pwned"));
}

TEST(ComparisonFailures, ImpossibleFoldersAreRefused) {
    const Folder folder;
    samples::put(folder / "file", "x");
    for (const std::string name : {"file", "none/a", "file/a"}) {
        EXPECT_THROW(writeComparison(reference(), scaled(1), small(), folder / name), OutputError);
    }
    EXPECT_EQ(entries(folder.path()), std::set<std::string>{"file"});
}

TEST(ComparisonFailures, WorkThatFailsLeavesNoFolder) {
    const Folder folder;
    const auto f = [](const Direction&, const Direction&) { return 0.1; };
    const FormulaBrdf two(f, {}, {.isotropic = true}, Channels::spectral({500, 600})),
        others(f, {}, {.isotropic = true}, Channels::spectral({500, 601}));
    EXPECT_THROW(writeComparison(two, others, small(), folder / "a"), UsageError);
    EXPECT_TRUE(entries(folder.path()).empty());
}

TEST(ComparisonFailures, WithoutGnuplotTheRestIsComplete) {
    const Folder folder;
    const std::string before = std::getenv("PATH");
    std::filesystem::create_directory(folder / "bin");
    ::setenv("PATH", (folder / "bin").c_str(), 1);
    EXPECT_THROW(writeComparison(reference(), scaled(1), small(), folder / "a"), OutputError);
    ::setenv("PATH", before.c_str(), 1);
    EXPECT_EQ(entries(folder / "a"),
              (std::set<std::string>{"comparison.json", "polar.csv", "half.csv", "residual.csv",
                                     "albedo.csv", "spheres.png", "spheres.exr", "comparison.gp",
                                     "comparison.html"}));
    EXPECT_NE(contentOf(folder / "a/comparison.html").find("No figures"), std::string::npos);
}

TEST(PageFigures, Base64AgreesWithRfc4648) {
    // The vectors of RFC 4648, section 10.
    const std::pair<const char*, const char*> vectors[] = {{"", ""},
                                                           {"f", "Zg=="},
                                                           {"fo", "Zm8="},
                                                           {"foo", "Zm9v"},
                                                           {"foob", "Zm9vYg=="},
                                                           {"fooba", "Zm9vYmE="},
                                                           {"foobar", "Zm9vYmFy"}};
    for (const auto& [plain, encoded] : vectors) EXPECT_EQ(base64(plain), encoded);
    EXPECT_EQ(base64("\xfb\xff"), "+/8=");
}

}  // namespace
